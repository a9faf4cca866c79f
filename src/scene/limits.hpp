#pragma once

#include "scene/load.hpp"

namespace talus::scene {

/// Whether a run of the loaded scene has a size that makes sense: thickness of its releases, particle spacing and
/// number of particles, cells of the maps, rows of front.csv, pieces of walls, memory. Errors name the key to change,
/// its value and what is allowed.
[[nodiscard]] Status check_limits(const ParsedScene& parsed, const Scene& scene);

/// Whether the run over time, if asked for, has a number of frames that makes sense. `cell`: m, of the maps;
/// `particles`: of the run, 0 for the depth-averaged model. Part of check_limits() and check_depth_averaged().
[[nodiscard]] Status check_series(const ParsedScene& parsed, const Scene& scene, double cell, double particles);

/// Measured with a million particles (docs/performance.md).
inline constexpr double bytes_per_particle = 1500;

/// Of a run with so many particles, bytes, beside what the program needs anyway.
[[nodiscard]] double memory_needed(const Scene& scene, double particles);

}  // namespace talus::scene
