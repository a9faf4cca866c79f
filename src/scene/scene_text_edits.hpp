#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <toml++/toml.h>

#include "core/result.hpp"
#include "params/fields.hpp"

/// The paths of a scene, and other ones in their place in its text. For bundles.
namespace talus::scene {

/// Where each value of a file stands in the text.
[[nodiscard]] std::map<std::string, toml::source_position> places_of(const toml::table& root);

/// The text with another string in place of the one that begins there. Error: it is no string in quotes.
[[nodiscard]] Status replace_string(std::string& text, const toml::source_position& place, const std::string& by);

/// The whole file, without a byte order mark: columns are counted without it.
[[nodiscard]] Result<std::string> text_of(const std::filesystem::path& file);

/// Calls f(key path, section, key, value) for every path that is given.
template <class F>
void for_each_path(const params::SceneSpec& spec, const F& f) {
    for (const params::Section& section : params::scene_sections()) {
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            for (const params::Parameter& parameter : section.parameters) {
                if (parameter.kind != params::ParameterKind::path) continue;
                const params::ParameterValue value = parameter.get(spec, index);
                const auto* text = std::get_if<std::string>(&value);
                if (text && !text->empty()) f(key_path(section, index, parameter), section.name, parameter.key, *text);
            }
        }
    }
}

}  // namespace talus::scene
