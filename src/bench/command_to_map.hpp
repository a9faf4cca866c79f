#pragma once

#include <filesystem>

#include "bench/calibration.hpp"
#include "core/result.hpp"

namespace talus::bench {

/// What a user waits for besides the model: scene read, ground and debris made, results measured, files written.
struct CommandToMap {
    double seconds = 0;        ///< of wall time; the median over the repeats
    double relative_rate = 0;  ///< of all this, per 10^9 calibration units
};

/// The whole built-in scene (scene::unpack_builtin_scene) with the depth-averaged model on cells of 2.5 m, on one
/// thread, without the time of its steps. Errors: the scene cannot be read, a step cannot be trusted, a file not be
/// written.
[[nodiscard]] Result<CommandToMap> measure_command_to_map(const std::filesystem::path& builtin_scene, int repeats,
                                                          Calibration& calibration);

}  // namespace talus::bench
