#pragma once

#include <cmath>

#include "core/number.hpp"
#include "params/material_spec.hpp"

/// Friction of samosAT on the ground, for dry snow: Sampl & Granig 2009, "Avalanche simulation with SAMOS-AT"
/// (International Snow Science Workshop, Davos), in the form and with the constants of AvaFrame (com1DFA, theoryCom1DFA
/// "SamosAT friction model" and `SamosATfric` of DFAfunctionsCython.pyx):
///
///     tau = tau_0 + mu (1 + R_s0 / (R_s0 + R_s)) sigma + rho v^2 / (ln(h / R) / kappa + B)^2,  R_s = rho v^2 / sigma
///
/// It replaces that of SAMOS (Sampl & Zwinger 2004), whose drag did not depend on the thickness h. tau_0 is cohesion.
/// com1DFA adds 0.001 Pa to sigma in R_s, takes the speed from before the step and lets friction slow debris without
/// ever stopping it; here friction stops it, and holds what it can hold.
namespace talus::sim {

struct Samosat {
    bool on = false;
    double fluidization = 0;  ///< R_s0
    double karman = 1;        ///< kappa
    double roughness = 1;     ///< R, m
    double offset = 1;        ///< B
};

[[nodiscard]] inline Samosat samosat_of(const params::MaterialSpec& material) {
    if (!material.samosat) return {};
    return {true, material.samosat_fluidization, material.samosat_karman, material.samosat_roughness,
            material.samosat_offset};
}

/// Natural logarithm of a number from 1 to 1e7, to 1e-3; to 1e-5 up to 1e4. Square roots alone, which every instruction
/// set rounds in the same way: ln x = 16 ln s with s = x^(1/16), and ln s = 2 artanh((s - 1) / (s + 1)).
template <class Real>
TALUS_INLINE Real natural_log(Real x) {
    using std::sqrt;
    const Real s = sqrt(sqrt(sqrt(sqrt(x)))), t = (s - Real(1)) / (s + Real(1)), q = t * t;
    const Real series = Real(1) + q * (Real(1.0 / 3) + q * (Real(1.0 / 5) + q * (Real(1.0 / 7) + q * Real(1.0 / 9))));
    return Real(32) * t * series;
}

/// The stress of the drag over rho v^2, by the thickness of the flow, m. Flow thinner than the roughness is taken as
/// thick as that, as com1DFA does.
template <class Real>
TALUS_INLINE Real wall_drag(const Samosat& samosat, Real thickness) {
    const Real above = larger(Real(1), thickness * Real(1 / samosat.roughness));
    const Real ratio = natural_log(above) * Real(1 / samosat.karman) + Real(samosat.offset);
    return Real(1) / (ratio * ratio);
}

/// What slow debris has more of friction, over friction: R_s0 / (R_s0 + R_s), 1 at rest. `stress`: normal to the
/// ground, over density, m2/s2.
template <class Real>
TALUS_INLINE Real slow_share(Real fluidization, Real stress, Real square_speed) {
    const Real scale = fluidization * larger(Real(0), stress);
    return scale / larger(scale + square_speed, Real(1e-20));
}

}  // namespace talus::sim
