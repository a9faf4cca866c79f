#pragma once

#include "sim/physics/contact.hpp"
#include "sim/physics/resistance.hpp"
#include "sim/physics/viscosity.hpp"
#include "sim/stages/pairs.hpp"
#include "sim/stages/particle.hpp"

/// The stages that treat each particle by itself, and viscosity.
namespace talus::sim::stages {

/// The velocity after drag by speed, with the thickness of the flow before the step. `in_column`: particles in the
/// column of the flow.
template <class At>
TALUS_INLINE Vec3<typename At::Real> slowed_velocity(const At& at, const typename At::Real& in_column) {
    using Real = typename At::Real;
    const Vec3<Real> velocity = at.velocity(), p = at.position();
    const terrain::GroundSample<Real> below = at.ground().terrain.sample(p.x, p.y);
    const Real distance = (p.z - below.height) * below.normal.z;
    const Real thickness = flow_thickness(at.model(), below, in_column);
    return slowed_by_drag(at.model(), ground_resistance(at.model(), p), below, distance, thickness, velocity,
                          Real(at.step().time_step));
}

/// Solid fraction and pore pressure after the step, from the thickness of the flow and the speed before it.
template <class At>
TALUS_INLINE Soil<typename At::Real> evolved_soil(const At& at, const typename At::Real& in_column) {
    using Real = typename At::Real;
    const Vec3<Real> velocity = at.velocity(), p = at.position();
    const terrain::GroundSample<Real> below = at.ground().terrain.sample(p.x, p.y);
    const Real thickness = flow_thickness(at.model(), below, in_column);
    const Real speed = length(velocity - below.normal * dot(velocity, below.normal));
    Soil<Real> before = at.soil();
    Real water(-1);
    if (at.step().water_rises) {
        const RisingWater<Real> rising = at.water();
        water = rising.ratio;
        const Real risen = select(before.thickness > Real(0), before.pressure_ratio + rising.rise, water);
        before.pressure_ratio = select(water < Real(0), before.pressure_ratio, risen);
    }
    return evolve(at.model().evolving_pressure, before, Real(at.model().gravity) * below.normal.z, thickness, speed,
                  Real(at.step().time_step), water);
}

/// Resistance, where it varies between particles.
template <class At>
TALUS_INLINE void resist(const At& at) {
    using Real = typename At::Real;
    const Real share = at.share_of_grains();
    const Vec3<Real> p = at.position(), velocity = at.velocity();
    const GroundResistance<Real> ground = ground_resistance(at.model(), p);
    // Multipliers are still those of the last step.
    const Real friction =
        moving_friction(at.model(), at.ground().terrain, ground.friction_coefficient, p, velocity,
                        at.multiplier() * Real(at.step().pressure_scale), share, Real(at.step().time_step));
    Resistance<Real> result;
    if (at.model().inertial_friction.on) {
        result.ground_shear = shear_beside_ground(at.model(), ground.friction_coefficient);
    }
    result.effective_share = share;
    result.friction = friction * share;
    result.strength = ground.cohesion * Real(at.step().strength_per_pascal);
    at.set_resistance(result);
}

/// Contact with ground and buildings, and the basal part of eq. (4).
template <class At>
TALUS_INLINE void contacts(const At& at) {
    using Real = typename At::Real;
    const Vec3<Real> displacement = at.corrected();
    const GroundPlane<Real> plane = at.plane();
    const Real multiplier = at.multiplier();
    ContactMemory<Real> contact = at.contact();
    const Real distance = plane.distance + dot(displacement, plane.normal);
    auto friction = Real(at.model().friction_coefficient), strength = Real(0);
    if (at.step().resists_by_particle) {
        friction = at.ground_friction();
        strength = at.ground_strength() * basal_share(at.model(), distance);
    }
    const Vec3<Real> after =
        displacement + resolve_face(at.model(), distance, plane.normal, displacement,
                                    boundary_push(plane.slope, multiplier), friction, strength, contact);
    at.set_contact(contact);
    at.set_moved(select(at.moves(), at.after_walls(after, multiplier), displacement));
}

/// Moves overlapping particles apart without changing their velocity: debris that is too dense (with stresses, its
/// shift is already computed), and debris too close to ground or walls.
template <class At>
TALUS_INLINE void resolve_penetration(const At& at) {
    using Real = typename At::Real;
    const Real max_shift(at.step().max_shift);
    Vec3<Real> shift = at.overlap_shift(at.contact_place(), max_shift);
    if (at.step().keeps_stress) shift += at.shift();
    const Real size = length(shift);
    shift = shift * select(size > max_shift, max_shift / size, Real(1));
    at.set_shift(select(at.moves(), shift, Vec3<Real>{}));
}

/// Eq. (5) as XSPH smoothing; the sum weights both particles of a pair equally, so momentum is conserved.
template <class At, class Smoothing>
TALUS_INLINE void apply_viscosity(const At& at, const PairKernel<Smoothing>& kernel) {
    using Real = typename At::Real;
    const MotionOf<Real> own = at.motion();
    Vec3<Real> change{};
    at.for_each_neighbour([&](const auto& neighbour) TALUS_INLINE_LAMBDA {
        const MotionOf<Real> other = neighbour.motion();
        const Real weight = kernel.value(kernel.scale.quotient(length(own.position - other.position)));
        change += (other.velocity - own.velocity) * weight;
    });
    const Real smoothing = Real(at.step().viscous_smoothing) * at.mobile();
    Vec3<Real> after = own.velocity + change * smoothing;
    if (at.model().viscosity_on_ground) {
        const Vec3<Real>& p = own.position;
        const terrain::GroundSample<Real> below = at.ground().terrain.sample(p.x, p.y);
        after = slowed_by_ground(at.model(), below, (p.z - below.height) * below.normal.z, after, smoothing);
    }
    at.set_velocity(after);
}

/// Debris that has hardly moved for the rest duration sleeps: it keeps its position and pressure until something moves
/// beside it. Debris against walls stays awake, since the forces on them are measured; so does debris whose pore
/// pressure still changes or in which water rises, since it may be creeping towards failure.
template <class At>
TALUS_INLINE void update_sleep(const At& at) {
    using Real = typename At::Real;
    const Vec3<Real> velocity = at.velocity();
    const Real square = dot(velocity, velocity), mobile = at.mobile();
    // Conditions are combined as numbers: see opaque().
    const Real slow = opaque(select(square < Real(at.step().sleep_square), Real(1), Real(0))) * mobile;
    const Real still = select(slow > Real(0), at.still_time() + Real(at.step().time_step), Real(0));
    at.set_still_time(still);
    auto sleeps = still > Real(at.step().rest_duration);
    if (at.model().evolving_pressure.on && any(sleeps)) {
        sleeps = both(sleeps, in_balance(at.model().evolving_pressure, at.soil()));
    }
    if (at.step().water_rises && any(sleeps)) sleeps = both(sleeps, at.water().ratio < Real(0));
    if (any(sleeps)) at.put_to_sleep(sleeps);
    const auto wakes = square * mobile > Real(at.step().wake_square);
    if (any(wakes)) at.wake_neighbours(wakes);
}

}  // namespace talus::sim::stages
