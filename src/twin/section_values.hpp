#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "params/fields.hpp"
#include "params/spec.hpp"

/// The live parameters of a section, in JSON: keys, ranges and rules of the field table.
namespace talus::twin {

[[nodiscard]] std::vector<std::string> live_keys(const char* section);

[[nodiscard]] nlohmann::json live_values(const params::Section& section, const params::SceneSpec& spec,
                                         std::size_t index = 0);
[[nodiscard]] nlohmann::json live_list(const params::Section& section, const params::SceneSpec& spec);
[[nodiscard]] Status read_live_values(const nlohmann::json& object, const params::Section& section,
                                      params::SceneSpec& spec, std::size_t index = 0);
/// Adds the entries of a list to the section: all keys are known, required ones are present, every rule is satisfied.
/// Errors begin with "key[index]".
[[nodiscard]] Status read_live_list(const nlohmann::json& list, const char* key, const params::Section& section,
                                    params::SceneSpec& spec, double particle_spacing);
[[nodiscard]] Status check_live_rules(const params::Section& section, const params::SceneSpec& spec,
                                      double particle_spacing);

/// Checks that a new entry has its required keys, and exactly one live key of alternatives.
[[nodiscard]] Status check_complete(const nlohmann::json& object, const char* section, const char* what);

/// Whether there is such a key, and it is not null.
[[nodiscard]] bool gives(const nlohmann::json& object, const std::string& key);

/// A scene with only this entry in its section.
template <class Spec>
[[nodiscard]] params::SceneSpec scene_with(const Spec& entry) {
    params::SceneSpec spec;
    auto& place = spec.*params::section_of<Spec>.second;
    if constexpr (requires { place.push_back(entry); }) {
        place.push_back(entry);
    } else {
        static_cast<Spec&>(place) = entry;
    }
    return spec;
}

/// The values of those keys; null: not given.
template <class Spec>
[[nodiscard]] nlohmann::json values_json(const Spec& entry) {
    return live_values(params::live_section(params::section_of<Spec>.first), scene_with(entry));
}
template <class Spec>
[[nodiscard]] nlohmann::json list_json(const std::vector<Spec>& entries) {
    params::SceneSpec spec;
    spec.*params::section_of<Spec>.second = entries;
    return live_list(params::live_section(params::section_of<Spec>.first), spec);
}

/// Applies the values of the object; null removes an optional value, and a value removes its alternatives. Errors name
/// key, value and what is allowed.
template <class Spec>
[[nodiscard]] Status read_values(const nlohmann::json& object, Spec& entry) {
    params::SceneSpec spec = scene_with(entry);
    Status read = read_live_values(object, params::live_section(params::section_of<Spec>.first), spec);
    if (!read) return read;
    auto& place = spec.*params::section_of<Spec>.second;
    if constexpr (requires { place.front(); }) {
        entry = place.front();
    } else {
        entry = place;
    }
    return read;
}

/// The rules of the section, in a scene with this solver, particles of this spacing, m, and this material.
template <class Spec>
[[nodiscard]] Status check_rules(const Spec& entry, const params::SolverSpec& solver, double particle_spacing,
                                 const params::MaterialSpec& material = {}) {
    params::SceneSpec spec = scene_with(entry);
    spec.solver = solver;
    spec.material = material;
    return check_live_rules(params::live_section(params::section_of<Spec>.first), spec, particle_spacing);
}

}  // namespace talus::twin
