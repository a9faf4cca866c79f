#pragma once

#include "core/result.hpp"
#include "run/run_scene.hpp"

namespace talus::run {

/// Whether debris of the depth-averaged model has friction inside, as particles have it.
enum class Inside { frictionless, as_particles };

/// Runs a scene with the depth-averaged model, as run_scene() does where the scene asks for it. Buildings and barriers
/// stand on the cells whose centres they cover or whose line they cross.
[[nodiscard]] Result<RunResult> run_depth_averaged(const scene::Scene& scene, const RunOptions& options,
                                                   Inside inside = Inside::frictionless);

}  // namespace talus::run
