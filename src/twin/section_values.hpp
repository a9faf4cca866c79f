#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "params/fields.hpp"
#include "params/spec.hpp"

/// The keys of a section that people change while a run goes on, in JSON: keys, ranges and rules of the scene file.
namespace talus::twin {

[[nodiscard]] std::vector<std::string> live_keys(const char* section);

[[nodiscard]] nlohmann::json live_values(const Section& section, const SceneSpec& spec);
[[nodiscard]] Status read_live_values(const nlohmann::json& object, const Section& section, SceneSpec& spec);
[[nodiscard]] Status check_live_rules(const Section& section, const SceneSpec& spec, double particle_spacing);

/// The values of those keys; null: not given.
template <class Spec>
[[nodiscard]] nlohmann::json values_json(const Spec& entry) {
    const auto& [section, place] = section_of<Spec>;
    SceneSpec spec;
    spec.*place = {entry};
    return live_values(*find_section(section), spec);
}

/// Takes what the object gives; a null takes a value away that may be left out, a value takes away its alternatives.
/// Errors name key, value and what is allowed.
template <class Spec>
[[nodiscard]] Status read_values(const nlohmann::json& object, Spec& entry) {
    const auto& [section, place] = section_of<Spec>;
    SceneSpec spec;
    spec.*place = {entry};
    Status read = read_live_values(object, *find_section(section), spec);
    if (read) entry = (spec.*place).front();
    return read;
}

/// The rules of the section, in a scene with this solver and particles of this spacing, m.
template <class Spec>
[[nodiscard]] Status check_rules(const Spec& entry, const SolverSpec& solver, double particle_spacing) {
    const auto& [section, place] = section_of<Spec>;
    SceneSpec spec;
    spec.solver = solver;
    spec.*place = {entry};
    return check_live_rules(*find_section(section), spec, particle_spacing);
}

}  // namespace talus::twin
