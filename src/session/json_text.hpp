#pragma once

#include <cstddef>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace talus::session {

/// Parses a received text. Errors: not JSON (with the place), nested too deeply, a key given twice, not UTF-8, more
/// than `most_values` (geo::json_values).
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text,
                                                std::size_t most_values = std::numeric_limits<std::size_t>::max());

/// An object as a body. Errors: as parse_json(); no object, another key than these.
[[nodiscard]] Result<nlohmann::json> read_object(std::string_view text, std::initializer_list<std::string_view> keys,
                                                 std::size_t most_values = std::numeric_limits<std::size_t>::max());

/// Always valid UTF-8; numbers that are not finite become null. Characters that a reader cannot see, or that change the
/// direction of writing, are shown as escapes.
[[nodiscard]] std::string to_text(const nlohmann::json& content);

/// The text at a key; empty where there is none.
[[nodiscard]] std::string text_at(const nlohmann::json& object, const char* key);

/// A name given by a user, cleaned up: valid UTF-8 without control characters, without blanks at the ends, at most
/// `longest` code points.
[[nodiscard]] std::string tidy_name(std::string_view name, std::size_t longest);

}  // namespace talus::session
