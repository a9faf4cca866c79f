#pragma once

#include "core/number.hpp"

/// Debris that has left the ground, on one number or on many lanes; docs/depth-averaged.md has the equations.
namespace talus::depth {

template <class Real>
struct Flight {
    Real height;  ///< vertical, above the ground, m; 0: debris is on it
    Real climb;   ///< vertical velocity less that of a point that follows the ground below, m/s
};

/// After a step in the air. `upward`: vertical velocity before it; `follows`: that of a point on the ground below.
template <class Real>
TALUS_INLINE Flight<Real> fly(const Real& height, const Real& upward, const Real& follows, const Real& gravity,
                              const Real& time_step) {
    const Real climb = upward - gravity * time_step - follows;
    return {height + time_step * (climb + Real(0.5F) * gravity * time_step), climb};
}

/// Twice the energy over mass that debris has more than at rest on the ground below, m2/s2. `follows`: as in fly().
template <class Real>
TALUS_INLINE Real flight_square(const Real& u, const Real& v, const Real& follows, const Flight<Real>& flight,
                                const Real& gravity) {
    const Real upward = follows + flight.climb;
    return u * u + v * v + upward * upward + Real(2) * gravity * flight.height;
}

}  // namespace talus::depth
