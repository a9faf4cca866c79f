#pragma once

#include <array>

#include "core/geometry.hpp"
#include "sim/physics/boundary.hpp"
#include "sim/physics/friction.hpp"
#include "sim/physics/resistance.hpp"

namespace talus::sim {

/// Corrections so far in this step from a particle's contact with ground or a wall.
template <class Real>
struct ContactMemory {
    Real normal{};          ///< accumulated correction along the normal, m, >= 0
    Vec3<Real> friction{};  ///< accumulated friction correction, m
};

/// Hard contact and Coulomb friction with one face.
///
/// Normal: the accumulated correction that keeps the particle at its touching distance, reduced again when the particle
/// would hover or move away. It may only stop motion into the face: an overlap present at the step's start, or caused
/// by a bend in the ground, must not become velocity (undo_overlap() removes it). Friction: limited by the whole normal
/// correction of the step, hard contact and `density_push` (the correction by the face's share of the density
/// constraint) together, plus `strength`, m, which needs no normal correction. Returns the change of displacement;
/// updates `memory`.
template <class Real>
TALUS_DEVICE Vec3<Real> resolve_contact(Real overlap, const Vec3<Real>& normal, const Vec3<Real>& displacement,
                                        Real density_push, Real friction_coefficient, Real strength,
                                        ContactMemory<Real>& memory) {
    const Real push = smaller(overlap, -dot(displacement, normal));
    const Real accumulated = larger(Real(0), memory.normal + push);
    Vec3<Real> change = normal * (accumulated - memory.normal);
    memory.normal = accumulated;
    const Vec3<Real> moved = displacement + change;
    const Vec3<Real> tangential = moved - normal * dot(moved, normal);
    change +=
        friction_change(tangential, friction_coefficient * (accumulated + density_push) + strength, memory.friction);
    return change;
}

/// Contacts of a particle with the faces around it.
template <class Real>
using ContactMemories = std::array<ContactMemory<Real>, face_count>;

/// Resolves the contact with a face, plane and at `distance` from the displaced particle. Returns the change of
/// displacement; updates `memory`.
template <class Real, class AnyModel>
TALUS_DEVICE Vec3<Real> resolve_face(const AnyModel& model, Real distance, const Vec3<Real>& normal,
                                     const Vec3<Real>& displacement, Real density_push, Real friction_coefficient,
                                     Real strength, ContactMemory<Real>& memory) {
    return resolve_contact(Real(model.contact_distance()) - distance, normal, displacement, density_push,
                           friction_coefficient, strength, memory);
}

/// The walls beside a particle, which are plane within its step, and its contacts with them; a face without a building
/// is none. Distances are those of a particle that is not displaced.
struct WallContacts {
    std::array<BoundaryFace<float>, face_count - 1> faces;
    std::array<ContactMemory<float>, face_count - 1> contacts;
};

/// Resolves the contacts of a particle with walls one after another; returns its new displacement. `multiplier` is that
/// of its density constraint, `share` that of the normal stress which its grains bear.
template <class AnyModel>
TALUS_DEVICE Vec3<float> resolve_walls(const AnyModel& model, WallContacts& walls, float multiplier, float share,
                                       Vec3<float> displacement) {
    const float friction = static_cast<float>(model.building_friction_coefficient) * share;
    for (std::size_t f = 0; f < walls.faces.size(); ++f) {
        const BoundaryFace<float>& wall = walls.faces[f];
        if (wall.building < 0) break;
        displacement += resolve_face(model, wall.distance + dot(displacement, wall.normal), wall.normal, displacement,
                                     boundary_push(wall.slope, multiplier), friction, 0.0f, walls.contacts[f]);
    }
    return displacement;
}

/// The speed of a particle that a step has displaced, m/s, as it would be without the correction `push`, m, along the
/// normal of a wall: that of what hits the wall. The wall's friction is not taken out.
template <class Real>
TALUS_DEVICE Real speed_without_push(const Vec3<Real>& displacement, const Vec3<Real>& normal, Real push,
                                     double time_step) {
    return length(displacement - normal * push) * static_cast<Real>(1 / time_step);
}

/// Resistance of ground and walls to a particle.
template <class Real>
struct Grip {
    Real ground_friction{}, wall_friction{};  ///< coefficients
    Real ground_strength{};                   ///< m, of a particle in contact: see strength_per_pascal()
};

template <class Real, class AnyModel>
TALUS_DEVICE Grip<Real> uniform_grip(const AnyModel& model) {
    return {Real(model.friction_coefficient), Real(model.building_friction_coefficient), Real(0)};
}

/// Resolves the contacts with ground and walls of a particle displaced by `displacement`; `boundary` was sampled at the
/// displacement `sampled_at` and is taken to be plane. `multiplier` is that of its density constraint. Returns the new
/// displacement.
template <class Real, class AnyModel>
TALUS_DEVICE Vec3<Real> resolve_contacts(const AnyModel& model, const Boundary<Real>& boundary,
                                         const Vec3<Real>& sampled_at, Vec3<Real> displacement, Real multiplier,
                                         const Grip<Real>& grip, ContactMemories<Real>& memories) {
    for (std::size_t f = 0; f < face_count; ++f) {
        const BoundaryFace<Real>& face = boundary.faces[f];
        if (f > 0 && face.building < 0) break;
        const Real distance = face.distance + dot(displacement - sampled_at, face.normal);
        const Real strength = f > 0 ? Real(0) : grip.ground_strength * basal_share(model, distance);
        displacement += resolve_face(model, distance, face.normal, displacement, boundary_push(face.slope, multiplier),
                                     f > 0 ? grip.wall_friction : grip.ground_friction, strength, memories[f]);
    }
    return displacement;
}

/// Adds to `shift` what brings a particle that overlaps walls back to touching them, at most `max_shift` metres for
/// each. Returns the nearest.
template <class Real, class AnyModel, class AnyGround>
TALUS_DEVICE terrain::SolidSample<Real> undo_wall_overlap(const AnyModel& model, const AnyGround& ground,
                                                          const Vec3<Real>& p, Real max_shift, float grain_rank,
                                                          Vec3<Real>& shift) {
    const Real touching = Real(model.contact_distance());
    const auto undo = [&](const terrain::SolidSample<Real>& wall) {
        const Real overlap = touching - wall.distance;
        if (wall.building < 0 || overlap <= 0) return;
        shift += wall.normal * (overlap < max_shift ? overlap : max_shift);
    };
    const terrain::SolidSample<Real> nearest = ground.solids.nearest(p, grain_rank);
    constexpr double beyond_rounding = 1e-3;  // m
    if (nearest.building < 0 || nearest.distance > touching + Real(beyond_rounding)) return nearest;
    undo(nearest);
    undo(ground.solids.second_nearest(p, nearest, grain_rank));  // which is no nearer
    return nearest;
}

/// The shift that brings a particle overlapping ground or a wall back to touching it, at most `max_shift` metres.
template <class Real, class AnyModel, class AnyGround>
TALUS_DEVICE Vec3<Real> undo_overlap(const AnyModel& model, const AnyGround& ground, const Vec3<Real>& p,
                                     Real max_shift, float grain_rank = terrain::largest_grain) {
    const terrain::GroundSample<Real> below = ground.terrain.sample(p.x, p.y);
    const Real overlap = Real(model.contact_distance()) - (p.z - below.height) * below.normal.z;
    Vec3<Real> shift{};
    if (overlap > 0) shift += below.normal * (overlap < max_shift ? overlap : max_shift);
    if (!ground.solids.empty()) undo_wall_overlap(model, ground, p, max_shift, grain_rank, shift);
    return shift;
}

/// Whether a position is free: not below ground, not inside a building, or a net that stops the grain.
template <class Real, class AnyGround>
TALUS_DEVICE bool is_free(const AnyGround& ground, const Vec3<Real>& p, float grain_rank = terrain::largest_grain) {
    if (p.z < ground.terrain.sample(p.x, p.y).height) return false;
    return ground.solids.empty() || !ground.solids.inside(p, grain_rank);
}

/// Into how many parts a sweep divides a displacement: each is at most `longest`.
template <class Real>
TALUS_DEVICE int sweep_parts(Real distance, Real longest) {
    return distance > longest ? static_cast<int>(distance / longest) + 1 : 1;
}

/// The position at which a particle may end its step: `start + displacement` if the path is free, otherwise a place in
/// front of the obstacle. Swept in parts of at most a quarter spacing, so it is safe at any speed and time step.
/// `start` must be free; so is the result.
template <class Real, class AnyModel, class AnyGround>
TALUS_DEVICE Vec3<Real> free_end(const AnyModel& model, const AnyGround& ground, const Vec3<Real>& start,
                                 const Vec3<Real>& displacement, float grain_rank = terrain::largest_grain) {
    const Vec3<Real> end = start + displacement;
    const Real max_part = Real(model.particle_spacing / 4);
    const Real distance = length(displacement);
    const int parts = sweep_parts(distance, max_part);
    Real clear = 0;  // share of the path known to be free
    Real blocked = -1;
    for (int part = 1; part <= parts; ++part) {
        const Real share = Real(part) / Real(parts);
        if (!is_free(ground, part == parts ? end : start + displacement * share, grain_rank)) {
            blocked = share;
            break;
        }
        clear = share;
    }
    if (blocked < 0) return end;
    if (parts == 1) {
        // A small step that ends below ground: lifted along the normal, so that it loses no tangential motion.
        const terrain::GroundSample<Real> below = ground.terrain.sample(end.x, end.y);
        const Real depth = (below.height - end.z) * below.normal.z;
        Vec3<Real> lifted = end + below.normal * (depth > 0 ? depth : Real(0));
        const Real height = ground.terrain.sample(lifted.x, lifted.y).height;
        if (lifted.z < height && height - lifted.z < max_part) lifted.z = height;
        if (is_free(ground, lifted, grain_rank)) return lifted;
    }
    Vec3<Real> reached = start + displacement * clear;
    for (int bisection = 0; bisection < 12; ++bisection) {
        const Real middle = (clear + blocked) / 2;
        const Vec3<Real> p = start + displacement * middle;
        if (is_free(ground, p, grain_rank)) {
            clear = middle;
            reached = p;
        } else {
            blocked = middle;
        }
    }
    return clear > 0 ? reached : start;
}

/// Where a particle is after its step, and the displacement that becomes velocity.
template <class Real>
struct StepEnd {
    Vec3<Real> position, displacement;
};

/// The end of a step of `displacement` and of a `shift` that becomes no velocity, both swept (see free_end). Lifting a
/// particle back above ground does not speed it up.
template <class Real, class AnyModel, class AnyGround>
TALUS_DEVICE StepEnd<Real> end_of_step(const AnyModel& model, const AnyGround& ground, const Vec3<Real>& start,
                                       const Vec3<Real>& displacement, const Vec3<Real>& shift, float grain_rank) {
    using std::sqrt;
    const Vec3<Real> wanted = start + displacement;
    const Vec3<Real> end = free_end(model, ground, start, displacement, grain_rank);
    const Vec3<Real> shifted = free_end(model, ground, end, shift, grain_rank);
    if (end.x == wanted.x && end.y == wanted.y && end.z == wanted.z) return {shifted, displacement};
    const Vec3<Real> reached = end - start;
    const Real before = dot(displacement, displacement), after = dot(reached, reached);
    return {shifted, after > before ? reached * sqrt(before / after) : reached};
}

}  // namespace talus::sim
