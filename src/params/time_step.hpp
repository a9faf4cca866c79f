#pragma once

#include <algorithm>
#include <cmath>

#include "params/spec.hpp"

namespace talus::params {

/// Upper bound of the adaptive time step, s: as given, or a share of the time scale sqrt(particle_spacing / g), so that
/// finer particles take shorter steps. `particle_spacing` in m; 0 while unknown.
[[nodiscard]] inline double largest_time_step(const SolverSpec& solver, double particle_spacing) {
    constexpr double gravity = 9.80665, share = 1.0 / 6, least = 1.0 / 60, most = 1.0 / 30;
    return solver.largest_time_step.value_or(std::clamp(share * std::sqrt(particle_spacing / gravity), least, most));
}

}  // namespace talus::params
