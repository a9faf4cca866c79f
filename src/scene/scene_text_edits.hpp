#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <toml++/toml.h>

#include "core/result.hpp"

/// Other values in the text of a scene. For bundles.
namespace talus::scene {

/// Where each value of a file stands in the text.
[[nodiscard]] std::map<std::string, toml::source_position> places_of(const toml::table& root);

/// The text with another string in place of the one that begins there. Error: it is no string in quotes.
[[nodiscard]] Status replace_string(std::string& text, const toml::source_position& place, const std::string& by);

/// The whole file, without a byte order mark: columns are counted without it.
[[nodiscard]] Result<std::string> text_of(const std::filesystem::path& file);

}  // namespace talus::scene
