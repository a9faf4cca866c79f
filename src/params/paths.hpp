#pragma once

#include <cstddef>
#include <string>
#include <variant>

#include "params/fields.hpp"

namespace talus::params {

/// Calls f(section, index, parameter, path) for every path that a scene gives.
template <class F>
void for_each_path(const SceneSpec& spec, const F& f) {
    for (const Section& section : scene_sections()) {
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            for (const Parameter& parameter : section.parameters) {
                if (parameter.kind != ParameterKind::path) continue;
                const ParameterValue value = parameter.get(spec, index);
                const auto* path = std::get_if<std::string>(&value);
                if (path != nullptr && !path->empty()) f(section, index, parameter, *path);
            }
        }
    }
}

/// Puts f(path) in place of every path that a scene gives.
template <class F>
void replace_paths(SceneSpec& spec, const F& f) {
    for_each_path(spec, [&](const Section&, std::size_t index, const Parameter& parameter, const std::string& path) {
        parameter.set(spec, index, f(path));
    });
}

}  // namespace talus::params
