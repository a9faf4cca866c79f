#pragma once

#include <string>
#include <string_view>

namespace talus {

/// The text with control characters, and characters that change the direction of writing, as escapes such as \u202E:
/// a name must neither look like another one nor control a terminal. Line breaks and tabs stay. In JSON the result has
/// the same meaning; with `backslash` = "\\\\" its strings show the escapes when they are read.
[[nodiscard]] std::string visible(std::string_view text, std::string_view backslash = "\\");

}  // namespace talus
