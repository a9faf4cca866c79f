#pragma once

#include <cmath>

#include "core/number.hpp"
#include "params/spec.hpp"

/// Pore pressure and solid fraction that evolve together (Iverson & George 2014, "A depth-averaged debris-flow model
/// that includes the effects of evolving dilatancy", part I; George & Iverson 2014, part II, eqs. 2.1 to 2.16). See
/// docs/pore-pressure.md.
namespace talus::sim {

/// The soil of a scene; see MaterialSpec.
struct EvolvingPressure {
    bool on = false;
    double permeability = 0;                      ///< m2, at `solid_fraction`
    double solid_fraction = 0;                    ///< at the start
    double critical_solid_fraction = 0;           ///< of slow shear
    double viscosity = 0;                         ///< Pa s, of the pore fluid
    double fluid_density = 0, grain_density = 0;  ///< kg/m3
    double compressibility = 0;                   ///< a
};

inline constexpr double reference_stress = 1000;       ///< Pa, sigma_0 of the compressibility (II)
inline constexpr double grain_of_inertia = 0.001;      ///< m, delta of N (II)
inline constexpr double permeability_fall = 0.04;      ///< in solid fraction, over which permeability falls to 1/e (II)
inline constexpr double loosest = 0.3, densest = 0.8;  ///< solid fractions

[[nodiscard]] inline EvolvingPressure evolving_pressure_of(const params::MaterialSpec& material) {
    if (material.pore_pressure != params::PorePressure::dilatancy) return {};
    return {true,
            material.permeability.value_or(0),
            material.solid_fraction.value_or(0),
            material.critical_solid_fraction.value_or(0),
            material.pore_fluid_viscosity,
            material.pore_fluid_density,
            material.grain_density,
            material.compressibility};
}

/// The state of a particle's soil.
template <class Real>
struct Soil {
    Real solid_fraction{};
    Real pressure_ratio{};  ///< lambda, pore pressure at the bed over the total normal stress, 0 to 1
    Real thickness{};       ///< m, of the flow in the last step; 0: no step yet
    Real dilatancy{};       ///< tan psi, above 0 where shear dilates
};

/// `ratio` negative: hydrostatic.
[[nodiscard]] TALUS_DEVICE inline Soil<float> starting_soil(const EvolvingPressure& soil, double fraction,
                                                            double ratio) {
    const double bulk = soil.grain_density * fraction + soil.fluid_density * (1 - fraction);
    return {static_cast<float>(fraction), static_cast<float>(ratio >= 0 ? ratio : soil.fluid_density / bulk), 0, 0};
}

inline constexpr double balanced = 0.01;  ///< of lambda, from hydrostatic: friction then hardly changes any more

/// Whether the pore pressure is that of water at rest.
template <class Real>
[[nodiscard]] TALUS_DEVICE auto in_balance(const EvolvingPressure& law, const Soil<Real>& soil) {
    const Real fluid(law.fluid_density);
    const Real density = fluid + Real(law.grain_density - law.fluid_density) * soil.solid_fraction;
    const Real excess = soil.pressure_ratio - fluid / density;
    return excess * excess < Real(balanced * balanced);
}

/// What multiplies the friction of dry debris: (1 - lambda) tan(phi + psi) / tan phi.
template <class Real>
[[nodiscard]] TALUS_DEVICE double friction_share(const Soil<Real>& soil, double friction) {
    const double share = 1 - static_cast<double>(soil.pressure_ratio), psi = static_cast<double>(soil.dilatancy);
    if (!(friction > 0)) return share;
    const double angle = (friction + psi) / larger(0.1, 1 - friction * psi);
    return share * larger(0.0, angle) / friction;
}

/// exp(x) for |x| up to 20, to 2e-4 at most and to 1e-6 for |x| below 8, with the same bits on every instruction set:
/// the series of exp(x / 32), squared five times.
template <class Real>
TALUS_DEVICE Real exponential(const Real& x) {
    const Real y = larger(Real(-20), smaller(Real(20), x)) * Real(1.0 / 32);
    Real e = Real(1) +
             y * (Real(1) + y * (Real(0.5) + y * (Real(1.0 / 6) +
                                                  y * (Real(1.0 / 24) + y * (Real(1.0 / 120) + y * Real(1.0 / 720))))));
    for (int square = 0; square < 5; ++square) e = e * e;
    return e;
}

/// The soil after a step of flow of a thickness, m, and a speed along the ground, m/s. `gravity`: normal to it, m/s2.
///
/// `water`: lambda of the water around it, which it drains to; negative: hydrostatic.
///
/// Where the flow stretches, p - X L is kept (II, eq. 2.11). Then s = effective stress + sigma_0 follows ds/dt = s (r -
/// A s) with A and r constant, whose solution is exact, positive and bounded at any step. The angle of dilatancy is
/// that at the end of the step: s falls where it grows, so that there is one root, between any s and what the step
/// makes of it. Change of volume is neglected: solid fraction changes, thickness does not.
template <class Real>
TALUS_DEVICE Soil<Real> evolve(const EvolvingPressure& law, const Soil<Real>& before, const Real& gravity,
                               const Real& thickness, const Real& speed, const Real& time_step,
                               const Real& water = Real(-1)) {
    using std::sqrt;
    const Real h = thickness, m = before.solid_fraction, dt = time_step, one(1), base(reference_stress);
    const Real fluid(law.fluid_density), excess_density = Real(law.grain_density - law.fluid_density) * m;
    const Real density = fluid + excess_density;
    const Real load = density * gravity * h;
    const Real part = (fluid + Real(3) * density) / (Real(4) * density);
    const Real stretch = select(before.thickness > Real(0), before.thickness / h, one);
    const Real ratio = larger(Real(0), smaller(one, part + (before.pressure_ratio - part) * stretch));

    const Real k = Real(law.permeability) * exponential((Real(law.solid_fraction) - m) * Real(1 / permeability_fall));
    const Real drain = k / (h * Real(law.viscosity));  // m / (Pa s) of D, half of it
    const Real s0 = (one - ratio) * load + base;
    const Real submerged = select(water < Real(0), excess_density * gravity * h, (one - water) * load);
    const Real rate = (speed + speed) / h, a(law.compressibility);
    const Real fall =
        Real(3) * m * drain / (a * h) + drain * gravity * fluid * excess_density / (Real(2) * density * s0);
    const Real by_shear = Real(1.5) * m * rate / a;
    const Real viscous = Real(law.viscosity) * rate;
    const Real inertial = Real(law.grain_density * grain_of_inertia * grain_of_inertia) * rate * rate;
    const Real of_viscous = sqrt(viscous);
    const auto dilatancy_at = [&](const Real& s) {
        const Real of_stress = sqrt(inertial + larger(one, s - base));
        return m - Real(law.critical_solid_fraction) * of_stress / (of_stress + of_viscous);
    };
    const Real to_hydrostatic = fall * (submerged + base), falls = fall * s0 * dt;
    const auto after = [&](const Real& s) {
        const Real x = (to_hydrostatic + by_shear * dilatancy_at(s)) * dt, e = exponential(Real(0) - x);
        // (1 - e) / x: from its series where x is small, otherwise with numerator and denominator times x.
        const auto is_small = x * x < Real(0.01);
        const Real mean = select(is_small, one - x * (Real(0.5) - x * (Real(1.0 / 6) - x * Real(1.0 / 24))), one - e);
        const Real times = select(is_small, one, x);
        return larger(base, smaller(load + base, s0 * times / (e * times + falls * mean)));
    };
    // The root of after(s) = s: regula falsi with the weights of Illinois.
    Real low = s0, high = after(low), at_low = high - low, at_high = after(high) - high;
    Real s = high;
    for (int round = 0; round < 3; ++round) {
        const Real span = at_low - at_high;
        const auto apart = span * span > Real(0);
        s = low + (high - low) * select(apart, at_low / select(apart, span, one), one);
        if (round == 2) break;
        const Real at_s = after(s) - s;
        const auto same = at_s * at_low > Real(0);
        at_high = select(same, at_high * Real(0.5), at_s);
        high = select(same, high, s);
        at_low = select(same, at_s, at_low * Real(0.5));
        low = select(same, s, low);
    }
    s = larger(base, smaller(load + base, s));

    // Grains settle as the fluid drains: dm/dt = -m D / h, with the mean pressure of the step.
    const Real stiff = larger(Real(0), fall * s * dt), now = submerged + base - s, then = submerged + base - s0;
    const Real mean_excess = now + (then - now) / (Real(2) + stiff);
    const Real settled = m + Real(2) * m * drain / h * mean_excess * dt;
    return {larger(Real(loosest), smaller(Real(densest), settled)),
            larger(Real(0), smaller(one, one - (s - base) / load)), h, dilatancy_at(s)};
}

}  // namespace talus::sim
