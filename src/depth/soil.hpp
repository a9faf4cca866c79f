#pragma once

#include <cmath>

#include "core/number.hpp"
#include "sim/physics/pore_pressure.hpp"

/// What the depth-averaged model asks of soil whose pore pressure evolves, besides its law.
namespace talus::depth {

inline constexpr float thinnest_soil = 0.01F;  ///< m: thinner debris changes as if it were that thick

/// lambda of water at rest.
template <class Real>
[[nodiscard]] Real hydrostatic_ratio(const sim::EvolvingPressure& soil, const Real& fraction) {
    const Real fluid(soil.fluid_density);
    return fluid / (fluid + Real(soil.grain_density - soil.fluid_density) * fraction);
}

/// tan psi for an effective stress, Pa, and a rate of shear, 1/s (George & Iverson 2014, eqs. 2.14 and 2.15).
template <class Real>
[[nodiscard]] Real dilatancy_of(const sim::EvolvingPressure& soil, const Real& fraction, const Real& stress,
                                const Real& rate) {
    using std::sqrt;
    const Real inertial = Real(soil.grain_density * sim::grain_of_inertia * sim::grain_of_inertia) * rate * rate;
    const Real number = Real(soil.viscosity) * rate / (inertial + larger(Real(1), stress));
    return fraction - Real(soil.critical_solid_fraction) / (Real(1) + sqrt(number));
}

}  // namespace talus::depth
