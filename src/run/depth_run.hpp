#pragma once

#include "core/result.hpp"
#include "run/run_scene.hpp"

namespace talus::run {

/// Runs a scene with the depth-averaged model, as run_scene() does where the scene asks for it. Buildings and barriers
/// stand on the cells whose centres they cover or whose line they cross.
[[nodiscard]] Result<RunResult> run_depth_averaged(const scene::Scene& scene, const RunOptions& options);

}  // namespace talus::run
