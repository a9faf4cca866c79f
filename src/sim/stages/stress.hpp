#pragma once

#include "sim/physics/density.hpp"
#include "sim/physics/resistance.hpp"
#include "sim/physics/stress.hpp"
#include "sim/stages/pairs.hpp"
#include "sim/stages/particle.hpp"

/// The default method: density and internal friction as a stress per particle that persists between steps.
namespace talus::sim::stages {

template <class Real>
TALUS_INLINE StressChange<Real> stress_change(const Real& p, const Deviator<Real>& s) {
    return {p + s.xx, s.xy, s.xz, p + s.yy, s.yz, p - s.xx - s.yy, p};
}

/// This step starts from the multipliers and stresses of the last one: debris at rest needs the same ones again. They
/// are pressures times dt^2, so they scale with the step. Held debris keeps its values for its start and presses on
/// nothing.
template <class At>
TALUS_INLINE void warm_start(const At& at) {
    using Real = typename At::Real;
    const Real scale(at.step().warm_start_scale);
    const Real multiplier = at.multiplier() * scale;
    const Deviator<Real> stress = at.stress() * scale;
    at.set_multiplier(multiplier);
    at.set_stress(stress);
    const Real presses = at.released();
    at.set_stress_change(stress_change(multiplier * presses, stress * presses));
}

/// Density constraints and pair gradients at the predicted positions; warm start.
template <class At, class Smoothing>
TALUS_INLINE void linearise(const At& at, const PairKernel<Smoothing>& kernel) {
    using Real = typename At::Real;
    const Displaced<Real> own = at.displaced();
    PairSums<Real> sums;
    at.for_each_neighbour([&](const auto& neighbour) TALUS_INLINE_LAMBDA {
        const Displaced<Real> other = neighbour.displaced();
        const Vec3<Real> gradient = sums.add(kernel, own.place - other.place, neighbour);
        neighbour.keep_gradient(gradient);
        sums.divergence += dot(other.moved - own.moved, gradient);
    });
    sums.finish(kernel);
    const BoundaryShare<Real> boundary = at.sample_boundary(own.place, own.moved);
    at.set_constraint(linearise_density(at.model(), sums, boundary, own.moved, Real(at.step().softness)));
    warm_start(at);
}

/// Eqs. (1) and (2), and the stress that resists the shear of this step.
template <class At>
TALUS_INLINE void solve_stress(const At& at) {
    using Real = typename At::Real;
    const StepConstants& step = at.step();
    const InertialFriction& inertial = at.model().inertial_friction;
    const Real factor(step.jacobi_factor);
    const Vec3<Real> moved = at.moved();
    DisplacementGradient<Real> deformation;
    at.for_each_gradient([&](const auto& neighbour, const Vec3<Real>& gradient)
                             TALUS_INLINE_LAMBDA { deformation.add(neighbour.moved() - moved, gradient); });
    const DensityConstraint<Real> constraint = at.constraint();
    const Real density = constraint.start - deformation.divergence() + boundary_change(at.boundary_gradient(), moved);
    const Real before = at.multiplier();
    const Real after =
        next_multiplier(before, density - larger(Real(0), constraint.start), constraint.gradient_square, factor);
    const Deviator<Real> stress_before = at.stress();
    if (inertial.on) {
        const GroundPlane<Real> plane = at.plane();
        add_ground_shear(deformation, moved, plane.normal, plane.slope, at.ground_shear());
    }
    const Deviator<Real> shear = deformation.shear();
    auto friction = Real(at.model().internal_friction_coefficient), pressure = -after;
    if (step.resists_by_particle) pressure = pressure * at.effective_share();
    if (inertial.on) {
        friction = inertial_friction(friction, Real(inertial.rise), Real(inertial.half), Real(step.inertial_grain_size),
                                     shear, pressure);
    }
    const Real limit = step.cohesive ? strength_limit_square(friction, pressure, Real(step.internal_strength))
                                     : friction_limit_square(friction, pressure);
    const Deviator<Real> stress = next_stress(stress_before, shear, limit, constraint.pair_square, factor);
    const auto moves = at.moves();
    const Real mobile = at.mobile();
    at.set_multiplier(select(moves, after, before));
    at.set_stress({select(moves, stress.xx, stress_before.xx), select(moves, stress.yy, stress_before.yy),
                   select(moves, stress.xy, stress_before.xy), select(moves, stress.xz, stress_before.xz),
                   select(moves, stress.yz, stress_before.yz)});
    at.set_compression(larger(Real(0), density - constraint.surface_share) * mobile);
    at.set_stress_change(stress_change((after - before) * mobile, (stress - stress_before) * mobile));
}

/// u_i += sum_j [(d lambda_i + d lambda_j) I + ds_i + ds_j] V grad W, equal and opposite for the two particles of a
/// pair.
template <class At>
TALUS_INLINE void apply_stress(const At& at) {
    using Real = typename At::Real;
    const StressChange<Real> own = at.stress_change();
    Vec3<Real> correction{};
    at.for_each_gradient([&](const auto& neighbour, const Vec3<Real>& gradient) TALUS_INLINE_LAMBDA {
        const StressChange<Real> other = neighbour.stress_change();
        const Real xy = own.xy + other.xy, xz = own.xz + other.xz, yz = own.yz + other.yz;
        correction += Vec3<Real>{dot(Vec3<Real>{own.xx + other.xx, xy, xz}, gradient),
                                 dot(Vec3<Real>{xy, own.yy + other.yy, yz}, gradient),
                                 dot(Vec3<Real>{xz, yz, own.zz + other.zz}, gradient)};
    });
    correction += boundary_correction(at.boundary_gradient(), own.pressure);
    at.set_corrected(at.moved() + correction * at.mobile());
}

/// Density above that at rest, as a multiplier.
template <class At>
TALUS_INLINE void find_spread(const At& at) {
    using Real = typename At::Real;
    const Real excess = spread_in_step(at.compression(), Real(at.step().spreading_share));
    at.set_change(next_multiplier(Real(0), excess, at.gradient_square(), Real(at.step().jacobi_factor)));
}

/// The shift that reduces it.
template <class At>
TALUS_INLINE void spread(const At& at) {
    using Real = typename At::Real;
    const Real own = at.change();
    Vec3<Real> shift = boundary_correction(at.boundary_gradient(), own);
    at.for_each_gradient([&](const auto& neighbour, const Vec3<Real>& gradient)
                             TALUS_INLINE_LAMBDA { shift += gradient * (own + neighbour.change()); });
    at.set_shift(shift);
}

}  // namespace talus::sim::stages
