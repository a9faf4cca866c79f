#pragma once

#include <optional>

#include "params/fields.hpp"

/// Smoothing more than the whole velocity difference in one step would drive neighbours apart.
namespace talus::scene {

/// The highest material.viscosity that the solver can apply: in its fixed step, or in an adaptive one, which viscosity
/// shortens.
[[nodiscard]] double highest_viscosity(const params::SolverSpec& solver);

/// Whether viscosity, or kinematic viscosity where that is given, is above that.
[[nodiscard]] std::optional<params::Violation> too_viscous(const params::MaterialSpec& material,
                                                           const params::SolverSpec& solver, double particle_spacing);

}  // namespace talus::scene
