#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/physics/stress.hpp"
#include "sim/rising_water.hpp"

/// Resistance other than Coulomb friction and viscosity: speed-dependent drag, cohesion, pore pressure, zones.
namespace talus::sim {

/// Whether there is speed-dependent drag.
inline bool slows_by_speed(const Model& model) {
    return model.laws.slow_by_speed() || model.cover.drags();
}

/// Whether there is pore pressure anywhere.
inline bool has_pore_pressure(const Model& model) {
    bool any = model.pore_pressure_ratio > 0 || has_rising_water(model);
    for (const ReleaseGroup& release : model.releases) any = any || release.pore_pressure_ratio.value_or(0) > 0;
    return any;
}

/// Whether resistance is more than the model's three friction coefficients, and must be evaluated for every particle.
inline bool resists_by_particle(const Model& model) {
    return !model.cover.empty() || model.cohesion > 0 || has_pore_pressure(model) || model.inertial_friction.on ||
           model.laws.have_moving_friction() || model.evolving_pressure.on;
}

/// When the release that a particle belongs to starts, s; 0: it came in another way.
template <class AnyModel>
TALUS_DEVICE double start_time_of(const AnyModel& model, std::uint32_t id) {
    for (const auto& release : model.releases) {
        if (id >= release.first_particle && id < release.last_particle) return release.start_time;
    }
    return 0;
}

/// The share of the normal stress that the grains of a particle bear, 1 - r_u(t) (Hutchinson 1986, "A
/// sliding-consolidation model for flow slides", whose excess pressure falls as the first mode of consolidation does,
/// exponentially), from when it starts to move, comes in or is entrained. `id`: of the particle; `entry_of_id`: see
/// State.
template <class AnyModel, class Entries>
TALUS_DEVICE double effective_share(const AnyModel& model, const Entries& entry_of_id, std::size_t id, double time) {
    double ratio = model.pore_pressure_ratio, since = time;
    if (id < entry_of_id.size()) {
        const double own = entry_of_id[id].pore_pressure_ratio;
        ratio = own >= 0 ? own : ratio;
        since = std::max(0.0, time - static_cast<double>(entry_of_id[id].time));
    }
    for (const auto& release : model.releases) {
        if (id < release.first_particle || id >= release.last_particle) continue;
        ratio = release.pore_pressure_ratio.value_or(ratio);
        since = std::max(0.0, time - release.start_time);
    }
    if (model.pore_pressure_decay_time > 0) ratio *= exponential(-since / model.pore_pressure_decay_time);
    return 1 - ratio;
}

/// The state of a particle's soil as its debris starts.
template <class AnyModel, class Entries>
TALUS_DEVICE Soil<float> first_soil_of(const AnyModel& model, const Entries& entry_of_id, std::size_t id) {
    const EvolvingPressure& law = model.evolving_pressure;
    double fraction = law.solid_fraction, ratio = model.pore_pressure_ratio > 0 ? model.pore_pressure_ratio : -1;
    if (id < entry_of_id.size()) {
        if (entry_of_id[id].solid_fraction > 0) fraction = entry_of_id[id].solid_fraction;
        if (entry_of_id[id].pore_pressure_ratio >= 0) ratio = entry_of_id[id].pore_pressure_ratio;
    }
    for (const auto& release : model.releases) {
        if (id < release.first_particle || id >= release.last_particle) continue;
        fraction = release.solid_fraction.value_or(fraction);
        ratio = release.pore_pressure_ratio.value_or(ratio);
    }
    return starting_soil(law, fraction, ratio);
}

/// The state of a particle's soil: that of its debris before a step has computed it. `thickness` is 0 until then.
template <class AnyModel, class Soils, class Entries>
TALUS_DEVICE Soil<float> soil_of(const AnyModel& model, const Soils& soil_of_id, const Entries& entry_of_id,
                                 std::size_t id) {
    if (id < soil_of_id.size() && soil_of_id[id].thickness > 0) return soil_of_id[id];
    return first_soil_of(model, entry_of_id, id);
}

/// What multiplies friction of dry debris: the share of the normal stress that the grains bear, or with evolving pore
/// pressure that and the angle of dilatancy. Where water rises in a release it gives the share until the debris fails;
/// from then on the pressure decays as that of debris that starts does.
template <class AnyModel, class AnyState>
TALUS_DEVICE double share_of_grains(const AnyModel& model, const AnyState& state, std::size_t id, double time) {
    if (!model.evolving_pressure.on) {
        const Water water = water_of(model, state.water_of_release, id);
        if (!(water.ratio >= 0)) return effective_share(model, state.entry_of_id, id, time);
        const double since = water.failed != 0 ? larger(0.0, time - water.failed_at) : 0, ratio = water.ratio;
        const double decay = model.pore_pressure_decay_time;
        return 1 - (decay > 0 ? ratio * exponential(-since / decay) : ratio);
    }
    return friction_share(soil_of(model, state.soil_of_id, state.entry_of_id, id), model.internal_friction_coefficient);
}

/// Resistance of the ground below a particle.
template <class Real>
struct GroundResistance {
    Real friction_coefficient{};        ///< of dry debris
    Real cohesion{};                    ///< Pa
    Real inverse_turbulent_friction{};  ///< 1 / xi, s2/m
    Real stem_drag{};                   ///< deceleration over v^2, 1/m
    Real laminar_viscosity{};           ///< m2/s
};

template <class Real, class AnyModel>
TALUS_DEVICE GroundResistance<Real> ground_resistance(const AnyModel& model, const Vec3<Real>& p) {
    GroundResistance<Real> result{Real(model.friction_coefficient), Real(model.cohesion),
                                  Real(model.laws.turbulent_friction > 0 ? 1 / model.laws.turbulent_friction : 0),
                                  Real(0), Real(model.laws.laminar_viscosity)};
    if (model.cover.empty()) return result;
    const auto cell = model.cover.at(p.x, p.y);
    const auto known = [](const Real& here, const Real& elsewhere) { return select(here == here, here, elsewhere); };
    return {known(Real(cell.x), result.friction_coefficient), known(Real(cell.z), result.cohesion),
            known(Real(cell.y), result.inverse_turbulent_friction), Real(cell.w),
            model.cover.has_viscosities() ? known(model.cover.viscosity_at(p.x, p.y), result.laminar_viscosity)
                                          : result.laminar_viscosity};
}

/// Friction on ground of any roughness for debris with the mu(I) law: at most the strength of the debris itself,
/// sheared between the ground, at rest, and the centre of a particle. Otherwise the lowest particles would stick to
/// rough ground, and the flow would start half a spacing too high. `speed`: along the ground, m/s; `pressure`: of the
/// grains, over density, m2/s2.
template <class Real, class AnyModel>
TALUS_DEVICE Real friction_beside_ground(const AnyModel& model, Real friction, Real speed, Real distance,
                                         Real pressure) {
    const InertialFriction& inertial = model.inertial_friction;
    if (!inertial.on) return friction;
    Deviator<Real> shear;
    shear.xz = speed / (larger(distance, Real(model.contact_distance() / 2)) * Real(2));
    return smaller(
        friction, inertial_friction(Real(model.internal_friction_coefficient), Real(inertial.rise), Real(inertial.half),
                                    Real(inertial.grain_size), shear, larger(Real(0), pressure)));
}

/// Friction on the ground below a particle where it depends on the motion: the coefficient of the ground's laws, at
/// most the strength of debris with the mu(I) law. `velocity`: after the step's gravity; `pressure`: at the particle,
/// over density, m2/s2; `share`: of it, borne by the grains.
///
/// The laws' stress is that on the ground: the pressure at the particle and the weight below it. Debris a few particles
/// thick bears no pressure most of the time, so that it is at least the weight of the particle.
template <class Real, class AnyModel, class AnyTerrain>
TALUS_DEVICE Real moving_friction(const AnyModel& model, const AnyTerrain& terrain, Real friction, const Vec3<Real>& p,
                                  const Vec3<Real>& velocity, Real pressure, Real share, Real time_step) {
    if (!model.inertial_friction.on && !model.laws.have_moving_friction()) return friction;
    const terrain::GroundSample<Real> below = terrain.sample(p.x, p.y);
    const auto speed_along = [&](const Vec3<Real>& v) { return length(v - below.normal * dot(v, below.normal)); };
    const Real speed = speed_along(velocity), distance = (p.z - below.height) * below.normal.z;
    if (model.laws.have_moving_friction()) {
        const Real gravity(model.gravity), weight = gravity * below.normal.z;
        const Real stress = larger(pressure + weight * distance, weight * Real(model.particle_spacing));
        const Real before = speed_along({velocity.x, velocity.y, velocity.z + gravity * time_step});
        friction = model.laws.template moving_friction<Real>().at(friction, stress, before * before);
    }
    return friction_beside_ground(model, friction, speed, distance, pressure * share);
}

/// The factor on a particle's displacement by which the ground shears debris with the mu(I) law: zero if the ground is
/// smoother than the debris. On rougher ground uniform shear continues below the surface, moving backwards: the factor
/// lets the lowest layer of a rest lattice see its full shear, as a layer inside does.
template <class Real, class AnyModel>
TALUS_DEVICE Real shear_beside_ground(const AnyModel& model, Real friction) {
    const double touching = model.contact_distance(), slope = model.boundary.at(touching).slope;
    return select(friction > Real(model.internal_friction_coefficient),
                  Real(model.kernel.gradient_moment / (-2 * touching * slope)), Real(0));
}

/// The ground's part of the gradient of a displacement `moved` beside it (see shear_beside_ground). `slope`: of the
/// ground's share of the density.
template <class Real>
TALUS_DEVICE void add_ground_shear(DisplacementGradient<Real>& deformation, const Vec3<Real>& moved,
                                   const Vec3<Real>& normal, Real slope, Real ground_shear) {
    const Vec3<Real> along = moved - normal * dot(moved, normal);
    deformation.add(along * (Real(0) - ground_shear), normal * slope);
}

/// A shear strength, Pa, as a correction, m, of a particle that stands for a spacing squared of the ground.
TALUS_DEVICE inline double strength_per_pascal(const ModelValues& model, double time_step) {
    return time_step * time_step / (model.rest_density * model.particle_spacing);
}

/// The shear strength that cohesion gives debris inside, in the units of lambda. The iteration makes pressure, and
/// friction with it, as large as needed to carry the weight through the sums over neighbours; cohesion is given, and is
/// raised by the shortfall of these sums.
TALUS_DEVICE inline double internal_strength(const ModelValues& model, double time_step) {
    return model.cohesion * time_step * time_step / (model.rest_density * model.kernel.gradient_moment);
}

/// The share of a particle in the layer that touches the ground: 1 where it touches, 0 a spacing higher.
template <class Real, class AnyModel>
TALUS_DEVICE Real basal_share(const AnyModel& model, Real distance) {
    const Real above = (distance - Real(model.contact_distance())) * Real(1 / model.particle_spacing);
    return larger(Real(0), smaller(Real(1), Real(1) - above));
}

/// Width of the columns in which the thickness of the flow is counted, m: each holds several particles of a layer, and
/// is still narrow beside the flow.
TALUS_DEVICE inline double column_width(const ModelValues& model) {
    return 2 * model.particle_spacing;
}

/// The share of the columns around a particle that is not cut off by walls. Distribution to columns and interpolation
/// between them weight the surroundings with a cubic B-spline, two column widths to either side; a wall cuts off the
/// part beyond it.
template <class Real, class AnyModel, class AnyGround>
TALUS_DEVICE Real open_share(const AnyModel& model, const AnyGround& ground, const Vec3<Real>& p, float grain_rank) {
    if (ground.solids.empty()) return 1;
    const auto beyond = [&](const terrain::SolidSample<Real>& wall) {
        if (wall.building < 0 || wall.normal.z > Real(0.5)) return Real(0);
        const Real s = std::clamp(wall.distance / Real(column_width(model)), Real(0), Real(2)), rest = Real(2) - s;
        return s < Real(1) ? Real(0.5) - s * (Real(2.0 / 3) - s * s * (Real(1.0 / 3) - s / 8))
                           : rest * rest * rest * rest / 24;
    };
    const terrain::SolidSample<Real> nearest = ground.solids.nearest(p, grain_rank);
    if (nearest.building < 0) return 1;
    return (1 - beyond(nearest)) * (1 - beyond(ground.solids.second_nearest(p, nearest, grain_rank)));
}

/// The number of particles in a column as an average over the area, from the number at the place of one of them. That
/// includes the particle itself, (2/3)^2 in the mean over places in a column. In dense, regular debris the sum is the
/// average. In thin debris, scattered at random, it is too large by just that. So the particle counts in full only
/// where the others fill two layers, and less in proportion below (docs/convergence.md has why two).
template <class Real>
TALUS_DEVICE Real counted_by_area(const Real& at_particle) {
    constexpr double own = 4.0 / 9, two_layers = 8;
    const Real others = larger(Real(0), at_particle - Real(own));
    return others + Real(own) * smaller(Real(1), others * Real(1 / (two_layers - own)));
}

/// Thickness of the flow at right angles to the ground, m, for a number of particles in the column at a particle's
/// place. It is the depth of depth-averaged laws, volume over area. Pressure would also give it, but debris only a few
/// particles thick bears none most of the time. A single particle counts as a quarter of its width.
template <class Real, class AnyModel>
TALUS_DEVICE Real flow_thickness(const AnyModel& model, const terrain::GroundSample<Real>& below, Real particles) {
    const double width = column_width(model);
    return larger(Real(model.particle_spacing / 4),
                  counted_by_area(particles) * Real(model.particle_volume() / (width * width)) * below.normal.z);
}

/// What a step of dv/dt = -(a v + b v^2) takes from a speed v, over what it leaves. `linear` = a dt, `square` = b v dt.
/// The solution is v exp(-x) / (1 + b v (1 - exp(-x)) / a) with x = a dt: it never reverses the motion. The exponential
/// is 1 / (1 + x + x^2/2 + x^3/6 + x^4/24), within 2e-4 up to x = 0.5, and goes to zero where drag is stiff.
template <class Real>
TALUS_DEVICE Real drag_loss(const Real& linear, const Real& square) {
    const Real x = smaller(linear, Real(1e6));  // the fourth power is finite in single precision
    const Real mean = Real(1) + x * (Real(0.5) + x * (Real(1.0 / 6) + x * Real(1.0 / 24)));
    return x * mean + square * mean;
}

/// A velocity after a step of drag by speed, tangential to the ground:
///
/// - Voellmy (1955), "Ueber die Zerstoerungskraft von Lawinen": the shear stress rho g v^2 / xi on the ground below
///   flow of thickness h, distributed over its full depth, as a deceleration g v^2 / (xi h). The law applies to
///   the whole column; applied to the lowest layer alone, debris would shear off above it wherever internal friction
///   is less than the slope. Debris more than a spacing above the flow's thickness is airborne and not affected. xi may
///   depend on the thickness (see turbulence_at).
/// - A law in place of xi: Voellmy's with the xi of the thickness (see wall_drag).
/// - Laminar flow over ground that holds it: the stress 3 rho nu v / h below a parabolic profile (Nusselt 1916, "Die
///   Oberflaechenkondensation des Wasserdampfes"), distributed in the same way, as 3 nu v / h^2. It is the viscous
///   term K eta v / (8 rho h^2) of the quadratic rheology (O'Brien, Julien & Fullerton 1993, "Two-dimensional water
///   flood and mudflow simulation", their resistance parameter K of a smooth wide channel: 24).
/// - Stems as cylinders across the flow (Petryk & Bosmajian 1975, "Analysis of flow through vegetation", eq. 4): a
///   deceleration C_D n D / 2 v^2 for n stems of diameter D per area.
///
/// See drag_loss() for the step in time. `thickness`: of the flow, at right angles to the ground (see flow_thickness).
template <class Real, class AnyModel>
TALUS_DEVICE Vec3<Real> slowed_by_drag(const AnyModel& model, const GroundResistance<Real>& ground,
                                       const terrain::GroundSample<Real>& below, Real distance, Real thickness,
                                       const Vec3<Real>& velocity, Real time_step) {
    const Real turbulence = model.laws.have_wall_drag()
                                ? wall_drag(model.laws, thickness) * Real(1 / model.gravity)
                                : ground.inverse_turbulent_friction * turbulence_at(model.laws, thickness);
    const auto in_flow = distance <= thickness + Real(model.particle_spacing);
    const Real turbulent = select(in_flow, turbulence * Real(model.gravity) / thickness, Real(0));
    const Real laminar = select(in_flow, Real(3) * ground.laminar_viscosity / (thickness * thickness), Real(0));
    const Vec3<Real> along = velocity - below.normal * dot(velocity, below.normal);
    const Real loss = drag_loss(laminar * time_step, (turbulent + ground.stem_drag) * length(along) * time_step);
    return velocity - along * (loss / (Real(1) + loss));
}

}  // namespace talus::sim
