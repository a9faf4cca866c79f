#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "params/fields.hpp"

namespace talus::scene {

/// A scene's values and the place where each was given, for messages after parsing.
struct ParsedScene {
    std::filesystem::path file;
    params::SceneSpec spec;
    std::map<std::string, std::string> places;  ///< "release[0].file" or "release[0]" -> "scene.toml:12" or "--set ..."

    /// "scene.toml:12: release[0].file"; for a key that was not given, the line of its section or the scene file.
    [[nodiscard]] std::string at(const std::string& key_path) const;
};

/// As parse_scene, with the places. An override may also be "variant=NAME": all that a `[[variant]]` sets.
[[nodiscard]] Result<ParsedScene> parse_scene_with_places(const std::filesystem::path& file,
                                                          const std::vector<std::string>& overrides);

/// Checks the rules between keys; those that depend on the particle spacing, m, where it is not 0.
[[nodiscard]] Status check_rules(const ParsedScene& scene, double particle_spacing);

/// Checks the rules, makes paths absolute and expands `${NAME}` in them.
[[nodiscard]] Status finish_scene(ParsedScene& scene);

/// "|layername=scar" where the name of a vector file gave the layer and no key did; otherwise nothing.
[[nodiscard]] std::string layer_behind(const ParsedScene& scene, const params::Section& section, std::size_t index,
                                       const params::Parameter& parameter);

/// Without line breaks and control characters, which would garble a terminal, and cut after `longest` bytes.
[[nodiscard]] std::string one_line(std::string_view text, std::size_t longest = 400);

}  // namespace talus::scene
