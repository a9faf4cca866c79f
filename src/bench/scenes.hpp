#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "run/run.hpp"

namespace talus::bench {

/// The standard scenes, by name:
///   slab        ten layers of debris on a plane of raster terrain, sliding towards two houses
///   column      a block of debris that collapses on flat ground beside a house; no higher than 24 layers
///   sham_tseng  600 m3 on the scar of the built-in scene, with its terrain, houses and flow path
[[nodiscard]] const std::vector<std::string>& scene_names();

/// The minimum and maximum number of particles of a scene.
inline constexpr int min_particles = 500, max_particles = 4000000;

/// Initial data of a measurement: the same for every method and number of threads.
struct Start : run::RunStart {
    std::string scene;
};

/// A scene with about `particles` particles. Debris is not relaxed, which would take minutes for a million particles,
/// but starts under its own weight, and moves down the slope. `builtin_scene`: the scene file that
/// unpack_builtin_scene() has written; only sham_tseng reads it. Errors: no such scene; the built-in scene cannot be
/// read.
[[nodiscard]] Result<Start> make_start(std::string_view scene, int particles,
                                       const std::filesystem::path& builtin_scene);

}  // namespace talus::bench
