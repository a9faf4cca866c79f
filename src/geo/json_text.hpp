#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace talus::geo {

/// Nested brackets, at most: deeper JSON is refused before it is parsed.
inline constexpr int deepest_json = 64;

/// JSON from a file or a request, in which no object has a key twice: otherwise the last one would win in silence.
/// Errors are the end of a sentence: "is not valid JSON, at byte 12".
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text);

}  // namespace talus::geo
