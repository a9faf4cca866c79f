#pragma once

#include <cmath>

#include "core/geometry.hpp"
#include "sim/physics/boundary.hpp"
#include "sim/physics/kernel.hpp"

namespace talus::sim {

/// The density constraint G of a particle, eq. (1), linearised at the positions that the step predicts: G(u) = start -
/// divergence(u) + boundary_change(u) for displacements u since the step's start.
///
/// Solved at the level of velocities: debris that starts a step denser than at rest must not get denser in it, and
/// existing compression is spread afterwards without becoming velocity (the split impulses of Catto 2005). Pushing it
/// apart through the multiplier would feed energy into every slow wave of a multiplier that persists between steps.
template <class Real>
struct DensityConstraint {
    Real start{};            ///< G at the step's start, with the surface's share
    Real surface_share{};    ///< density that a particle at the free surface lacks
    Real gradient_square{};  ///< see gradient_square()
    Real pair_square{};      ///< sum |V grad W|^2, softened, 1/m2
};

/// How fast the multiplier changes the constraint: -d G / d lambda, softened, 1/m2.
template <class Real, class Sums, class Share>
TALUS_DEVICE Real gradient_square(const Sums& sums, const Share& boundary, Real softness) {
    const Vec3<Real> pushed = sums.gradient + boundary.gradient * Real(boundary_mirror_share);
    return sums.square + softness + dot(pushed, pushed);
}

/// The compression that a step starts with, without the surface's share. Its iterations do not undo it.
template <class Real>
TALUS_DEVICE Real compression_before(const DensityConstraint<Real>& constraint) {
    return larger(Real(0), constraint.start - constraint.surface_share);
}

/// `boundary` has the `density` and `gradient` of a Boundary; `density`, `square`, `gradient` and `divergence` as the
/// pair sums give them at the predicted positions; `softness` in 1/m2.
///
/// At a free surface a particle lacks neighbours on one side. Left alone, it would bear no pressure before the debris
/// below had packed closer; so, as with the ghost air of Schechter & Bridson (2012), the lattice is assumed to
/// continue beyond the surface: as a half-space, at the distance given by the gradient of the density.
template <class Real, class Sums, class Share, class AnyModel>
TALUS_DEVICE DensityConstraint<Real> linearise_density(const AnyModel& model, const Sums& sums, const Share& boundary,
                                                       const Vec3<Real>& displacement, Real softness) {
    DensityConstraint<Real> result;
    result.surface_share = model.boundary.density_at_slope(length(sums.gradient + boundary.gradient));
    result.start = sums.density + boundary.density + result.surface_share - 1 + sums.divergence -
                   dot(boundary.gradient, displacement);
    result.pair_square = sums.square + softness;
    result.gradient_square = gradient_square(sums, boundary, softness);
    return result;
}

/// Eq. (2) for the linearised constraint, accumulated and unilateral: debris resists compression only. `violation` is
/// the G to undo.
template <class Real>
TALUS_DEVICE Real next_multiplier(Real before, Real violation, Real gradient_square, Real under_relaxation) {
    const Real after = smaller(Real(0), before - under_relaxation * violation / gradient_square);
    return select(gradient_square > Real(0), after, before);
}

/// The share of slight compression that a step spreads: more would keep debris at rest in motion.
inline double spreading_share(double time_step) {
    constexpr double kept_per_second = 1.5e-6;  // 0.8 in 1/60 s
    return 1 - std::pow(kept_per_second, time_step);
}

/// The part of a violation that a step spreads: a share of slight compression, and all beyond it.
template <class Real>
TALUS_DEVICE Real spread_in_step(Real compression, Real share) {
    constexpr double slight = 0.01;
    const Real beyond = larger(Real(0), compression - Real(slight));
    return beyond + (compression - beyond) * share;
}

/// The factor on every correction of the Jacobi iteration: `relaxation` is relative to the eigenvalue at which
/// simultaneous corrections of neighbours overshoot, so it is stable below 2 whatever the kernel.
inline double jacobi_factor(double relaxation, const Kernel& kernel) {
    return relaxation / kernel.max_eigenvalue;
}

}  // namespace talus::sim
