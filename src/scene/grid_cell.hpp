#pragma once

#include <string_view>

#include "core/result.hpp"
#include "scene/parse.hpp"
#include "scene/scene.hpp"

/// A scene for the depth-averaged model.
namespace talus::scene {

/// The cell of its grid, m: a whole fraction of the terrain's where the scene does not give it.
[[nodiscard]] double grid_cell(const Scene& scene);

/// Whether a key ("solver.kernel") means something to particles only: the depth-averaged model has no use for it.
[[nodiscard]] bool for_particles_only(std::string_view key);

/// Refuses what this model does not have, and notes given keys that mean nothing to it. The scene is loaded.
[[nodiscard]] Status check_depth_averaged(const ParsedScene& parsed, Scene& scene);

}  // namespace talus::scene
