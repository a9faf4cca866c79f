#pragma once

#include <cmath>

#include "core/number.hpp"
#include "params/material_spec.hpp"
#include "sim/physics/samosat.hpp"

/// Resistance of the ground by the speed and thickness of the flow. Both models, the relaxation of releases and the
/// forecast of a run's end know the laws by what is declared here only.
namespace talus::sim {

/// Friction that depends on the speed, in the numbers of a stage.
template <class Real>
struct MovingFriction {
    Real fluidization{};  ///< R_s0 of samosAT; 0: friction is the same at every speed

    [[nodiscard]] TALUS_INLINE auto on() const { return fluidization > Real(0); }
    /// The coefficient of debris at rest.
    [[nodiscard]] TALUS_INLINE Real at_rest(const Real& coefficient) const {
        return select(on(), Real(2) * coefficient, coefficient);
    }
    /// That of moving debris. `stress`: normal to the ground, over density, m2/s2.
    [[nodiscard]] TALUS_INLINE Real at(const Real& coefficient, const Real& stress, const Real& square_speed) const {
        return coefficient * (Real(1) + slow_share(fluidization, stress, square_speed));
    }
};

struct GroundLaws {
    double turbulent_friction = 0;   ///< xi, m/s2; 0: none
    double turbulent_thickness = 0;  ///< m, normal to the ground, at which xi applies as given; 0: at any thickness
    double laminar_viscosity = 0;    ///< kinematic, m2/s, of laminar flow over ground that holds it; 0: none
    Samosat samosat;

    /// Whether faster debris is slowed more.
    [[nodiscard]] bool slow_by_speed() const { return turbulent_friction > 0 || laminar_viscosity > 0 || samosat.on; }
    /// Whether drag is that of wall_drag(), in place of xi.
    [[nodiscard]] TALUS_DEVICE bool have_wall_drag() const { return samosat.on; }
    /// Whether Coulomb friction is that of moving_friction().
    [[nodiscard]] TALUS_DEVICE bool have_moving_friction() const { return samosat.on; }
    template <class Real>
    [[nodiscard]] TALUS_INLINE MovingFriction<Real> moving_friction() const {
        return {Real(samosat.fluidization)};
    }
};

[[nodiscard]] inline GroundLaws ground_laws_of(const params::MaterialSpec& material) {
    return {material.turbulent_friction.value_or(0), material.turbulent_friction_thickness.value_or(0),
            params::laminar_viscosity_of(material), samosat_of(material)};
}

/// The stress of the drag over rho v^2, by the thickness of the flow, m.
template <class Real>
TALUS_INLINE Real wall_drag(const GroundLaws& laws, const Real& thickness) {
    return wall_drag(laws.samosat, thickness);
}

/// Cube root of a positive number, to 1e-4 between exp(-6) and exp(6). Square roots alone, which every instruction set
/// rounds in the same way: 1/3 = 1/4 + 1/16 + 1/64 + ..., and the rest is near 1.
template <class Real>
TALUS_DEVICE Real rough_cube_root(Real x) {
    using std::sqrt;
    const Real a = sqrt(sqrt(x)), b = sqrt(sqrt(a)), c = sqrt(sqrt(b)), rest = c - Real(1);
    return a * b * c * (Real(1) + rest * (Real(1.0 / 3) - rest * Real(1.0 / 9)));
}

/// 1 / xi relative to the given value: Manning's law (1891), v = h^(2/3) S^(1/2) / n, is Voellmy's with xi = h^(1/3) /
/// n^2.
template <class Real>
TALUS_INLINE Real turbulence_at(const GroundLaws& laws, Real thickness) {
    if (!(laws.turbulent_thickness > 0)) return 1;
    return rough_cube_root(Real(laws.turbulent_thickness) / thickness);
}

}  // namespace talus::sim
