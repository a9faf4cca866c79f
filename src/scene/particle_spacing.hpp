#pragma once

#include <optional>

#include "scene/parse.hpp"
#include "scene/scene.hpp"

namespace talus::scene {

/// Chosen by the scene's solver section, m.
[[nodiscard]] double particle_spacing(const Scene& scene);

/// The key that decides it: "solver.target_layers".
[[nodiscard]] const char* spacing_key(const params::SolverSpec& solver);

/// The release, or inflow across a line, with the smallest mean thickness; none where debris comes in over areas alone.
[[nodiscard]] std::optional<ThinnestSource> thinnest_source(const Scene& scene);

/// The spacing of so many layers, m, to four digits: exactly as printed.
[[nodiscard]] double spacing_of_layers(double thickness, double layers);

/// The most layers that solver.particle_limit allows.
[[nodiscard]] double most_layers(const Scene& scene, double thickness);

/// Finds the thickness that solver.target_layers counts, where it is given. Releases and inflows must be loaded.
/// Errors: no thickness is known; more particles than solver.particle_limit.
[[nodiscard]] Status settle_layers(const ParsedScene& parsed, Scene& scene);

}  // namespace talus::scene
