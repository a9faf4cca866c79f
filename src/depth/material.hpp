#pragma once

#include "depth/solver.hpp"
#include "params/spec.hpp"

namespace talus::depth {

/// What the scene's material means here: internal friction, viscosity inside and the mu(I) law have no place in it.
[[nodiscard]] Material material_of(const params::MaterialSpec& material);

}  // namespace talus::depth
