#pragma once

#include <filesystem>

#include "bench/calibration.hpp"
#include "core/result.hpp"

namespace talus::bench {

/// A command from the scene's files to its products: medians over the repeats.
struct CommandToMap {
    double seconds = 0;        ///< of wall time without the steps: scene read, ground and debris made, results gathered
                               ///< at the end, files written
    double relative_rate = 0;  ///< such commands per 10^9 calibration units, without the steps
    double steps_rate = 0;     ///< cell updates per calibration unit, measurements of the steps included
};

/// The whole built-in scene (scene::unpack_builtin_scene) with the depth-averaged model on cells of 2.5 m, on one
/// thread. Errors: the scene cannot be read, a step cannot be trusted, a file cannot be written.
[[nodiscard]] Result<CommandToMap> measure_command_to_map(const std::filesystem::path& builtin_scene, int repeats,
                                                          Calibration& calibration);

}  // namespace talus::bench
