#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace talus::serve {

/// How deep arrays and objects of a received text may be nested.
inline constexpr int deepest_json = 32;

/// Parses a received text. Errors: not JSON (with the place), nested too deeply, not UTF-8.
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text);

/// As UTF-8, whatever the strings hold; numbers that are not finite become null.
[[nodiscard]] std::string to_text(const nlohmann::json& content);

/// A name as a person gave it: valid UTF-8 without control characters, without blanks at the ends, at most
/// `longest` code points.
[[nodiscard]] std::string tidy_name(std::string_view name, std::size_t longest);

}  // namespace talus::serve
