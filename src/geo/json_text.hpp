#pragma once

#include <cstddef>
#include <limits>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace talus::geo {

/// Nested brackets, at most: deeper JSON is refused before it is parsed.
inline constexpr int deepest_json = 64;

/// About how many values a text holds: its commas and opening brackets. Parsed, one of three bytes ("{},") takes
/// a hundred.
[[nodiscard]] std::size_t json_values(std::string_view text);

/// JSON from a file or a request, in which no object has a key twice: otherwise the last one would win in silence.
/// `most_values`: of json_values(), for long texts that may come from anybody. Errors are the end of a sentence:
/// "is not valid JSON, at byte 12".
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text,
                                                std::size_t most_values = std::numeric_limits<std::size_t>::max());

}  // namespace talus::geo
