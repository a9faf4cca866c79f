#pragma once

#include <string>

#include "core/result.hpp"
#include "scene/parse.hpp"
#include "scene/scene.hpp"

/// A scene for the depth-averaged model.
namespace talus::scene {

/// The cell of its grid, m: a whole fraction of the terrain's where the scene does not give it.
[[nodiscard]] double grid_cell(const Scene& scene);

/// Refuses what this model does not have, and too many cells. `otherwise`: what can be done but to remove it, "use
/// solver.model = "particles"".
[[nodiscard]] Status refuse_for_depth_averaged(const ParsedScene& parsed, const Scene& scene,
                                               const std::string& otherwise);

/// The same, and notes given keys that mean nothing to this model. The scene is loaded.
[[nodiscard]] Status check_depth_averaged(const ParsedScene& parsed, Scene& scene);

}  // namespace talus::scene
