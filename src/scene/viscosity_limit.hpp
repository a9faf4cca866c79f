#pragma once

#include <optional>

#include "params/fields.hpp"

/// Smoothing more than the whole velocity difference in one step would drive neighbours apart.
namespace talus::scene {

/// The highest material.viscosity that the solver's longest step allows.
[[nodiscard]] double highest_viscosity(const params::SolverSpec& solver);

/// Whether viscosity, or kinematic viscosity where that is given, is above what the step allows.
[[nodiscard]] std::optional<params::Violation> too_viscous(const params::MaterialSpec& material,
                                                           const params::SolverSpec& solver, double particle_spacing);

}  // namespace talus::scene
