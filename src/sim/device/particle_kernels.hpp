#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "sim/device/atomics.hpp"
#include "sim/device/smoothing.hpp"
#include "sim/device/views.hpp"
#include "sim/particle_density.hpp"
#include "sim/physics/columns.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/net.hpp"
#include "sim/physics/resistance.hpp"
#include "sim/physics/viscosity.hpp"

/// The stages that treat each particle by itself, and viscosity: one functor per kernel, called with the particle.
namespace talus::sim::device {

/// Starts the releases whose time has come.
struct ReleaseHeld {
    Data d;
    double time{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.held[i] != 0 && time >= start_time_of(d.model, d.state.id[i])) d.state.held[i] = 0;
    }
};

/// A box of columns (sim/physics/columns.hpp), an entry per column.
struct ColumnBox {
    std::uint32_t* units;
    double inverse_width;  ///< 1/m
    std::int64_t first_column, first_row, columns, rows;

    /// The entry of a column; nowhere outside the box.
    [[nodiscard]] TALUS_DEVICE std::uint32_t* at(std::int64_t column, std::int64_t row) const {
        const std::int64_t c = column - first_column, r = row - first_row;
        return c >= 0 && r >= 0 && c < columns && r < rows ? units + r * columns + c : nullptr;
    }
};

struct ClearColumns {
    ColumnBox box;

    TALUS_DEVICE void operator()(std::uint32_t k) const { box.units[k] = 0; }
};

struct CountColumns {
    Data d;
    ColumnBox box{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const LocalPoint p = d.state.position[i];
        for_each_column(p.x, p.y, box.inverse_width, [&](std::int64_t column, std::int64_t row, float share) {
            std::uint32_t* const at = box.at(column, row);
            if (at != nullptr) add_atomically(*at, column_units(share));
        });
    }
};

/// Drag by speed, with the thickness of the flow before the step.
struct Drag {
    Data d;
    ColumnBox box{};
    float time_step{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (!d.state.moves(i)) return;
        const LocalPoint p = d.state.position[i];
        float counted = 0;
        for_each_column(p.x, p.y, box.inverse_width, [&](std::int64_t column, std::int64_t row, float share) {
            const std::uint32_t* const at = box.at(column, row);
            if (at != nullptr) counted += share * static_cast<float>(*at) * (1 / units_per_particle);
        });
        const float particles = counted / open_share(d.model, d.ground, p, grain_rank(d.state.id[i]));
        const terrain::GroundSample<float> below = d.ground.terrain.sample(p.x, p.y);
        const float distance = (p.z - below.height) * below.normal.z;
        const float thickness = flow_thickness(d.model, below, particles);
        d.state.velocity[i] = slowed_by_drag(d.model, ground_resistance(d.model, p), below, distance, thickness,
                                             d.state.velocity[i], time_step);
    }
};

struct ApplyGravity {
    Data d;
    float fall{};  ///< m/s

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) d.state.velocity[i].z -= fall;
    }
};

/// Initialises what the step knows of all particles in their new order, sleeping ones included.
struct Begin {
    Data d;
    float time_step{};
    bool walls{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const LocalPoint p = d.state.position[i];
        const Vec3<float> displacement = d.state.moves(i) ? d.state.velocity[i] * time_step : Vec3<float>{};
        d.work.place[i] = row_of(p + displacement);
        d.work.moved[i] = row_of(displacement);
        d.work.corrected[i] = displacement;
        d.work.velocity_before[i] = d.state.velocity[i];
        d.work.contact[i] = {};
        if (walls) d.work.walls[i] = {};
    }
};

/// Resistance of every particle, where it varies between them.
struct Resist {
    Data d;
    float strength{}, pressure_scale{}, time_step{};
    double time{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const auto share = static_cast<float>(effective_share(d.model, d.state.entry_of_id, d.state.id[i], time));
        const LocalPoint p = d.state.position[i], velocity = d.state.velocity[i];
        const GroundResistance<float> ground = ground_resistance(d.model, p);
        Resistance result;
        result.friction = moving_friction(d.model, d.ground.terrain, ground.friction_coefficient, p, velocity,
                                          d.state.multiplier[i] * pressure_scale, share, time_step);
        if (d.model.inertial_friction.on) {
            result.ground_shear = shear_beside_ground(d.model, ground.friction_coefficient);
        }
        result.effective_share = share;
        result.friction *= share;
        result.strength = ground.cohesion * strength;
        d.work.resistance[i] = result;
    }
};

/// The share of ground and walls in a particle's density.
struct BoundaryShare {
    float density{};
    Vec3<float> gradient;
};

/// Samples ground and walls of particle `i` at `p`, displaced by `displacement` from where the step started; keeps them
/// in the work arrays.
TALUS_DEVICE inline BoundaryShare sample_boundary_of(const Data& d, std::uint32_t i, const Vec3<float>& p,
                                                     const Vec3<float>& displacement) {
    const auto keep = [&](float distance, float slope, const Vec3<float>& normal, const Vec3<float>& gradient) {
        d.work.plane[i] = {distance - dot(displacement, normal), slope, normal};
        d.work.boundary_gradient[i] = gradient;
    };
    if (d.ground.solids.empty() || !d.ground.solids.near(p.x, p.y)) {
        const GroundFace<float> base = sample_ground(d.model, d.ground.terrain, p);
        keep(base.distance, base.slope, base.normal, base.normal * base.slope);
        if (!d.ground.solids.empty()) {
            for (BoundaryFace<float>& face : d.work.walls[i].faces) face.building = -1;
        }
        return {base.density, base.normal * base.slope};
    }
    const Boundary<float> boundary = sample_boundary(d.model, d.ground, p, grain_rank(d.state.id[i]));
    const BoundaryFace<float>& base = boundary.faces[0];
    keep(base.distance, base.slope, base.normal, boundary.gradient);
    Walls& walls = d.work.walls[i];
    for (std::size_t f = 0; f < walls.faces.size(); ++f) {
        walls.faces[f] = boundary.faces[f + 1];
        walls.faces[f].distance -= dot(displacement, walls.faces[f].normal);
    }
    return {boundary.density, boundary.gradient};
}

/// Contact with ground and buildings, and the basal part of eq. (4).
struct Contacts {
    Data d;
    bool by_particle{}, place_follows{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (!d.state.moves(i)) return;
        const float multiplier = d.state.multiplier[i];
        Vec3<float> after = d.work.corrected[i];
        const GroundPlane plane = d.work.plane[i];
        const float distance = plane.distance + dot(after, plane.normal);
        auto friction = static_cast<float>(d.model.friction_coefficient);
        float strength = 0, effective = 1;
        if (by_particle) {
            const Resistance resistance = d.work.resistance[i];
            friction = resistance.friction;
            strength = resistance.strength * basal_share(d.model, distance);
            effective = resistance.effective_share;
        }
        after += resolve_face(d.model, distance, plane.normal, after, boundary_push(plane.slope, multiplier), friction,
                              strength, d.work.contact[i]);
        if (!d.ground.solids.empty()) after = resolve_walls(i, multiplier, effective, after);
        d.work.moved[i] = row_of(after);
        if (place_follows) d.work.place[i] = row_of(d.state.position[i] + after);
    }

    TALUS_DEVICE Vec3<float> resolve_walls(std::uint32_t i, float multiplier, float effective,
                                           Vec3<float> moved) const {
        Walls& walls = d.work.walls[i];
        const float friction = static_cast<float>(d.model.building_friction_coefficient) * effective;
        for (std::size_t f = 0; f < walls.faces.size() && walls.faces[f].building >= 0; ++f) {
            const BoundaryFace<float>& wall = walls.faces[f];
            moved += resolve_face(d.model, wall.distance + dot(moved, wall.normal), wall.normal, moved,
                                  boundary_push(wall.slope, multiplier), friction, 0.0f, walls.contacts[f]);
        }
        return moved;
    }
};

/// Moves overlapping particles apart without changing their velocity. `spread`: the shift out of debris that is too
/// dense is already computed.
struct UndoOverlaps {
    Data d;
    bool spread{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (!d.state.moves(i)) {
            d.work.shift[i] = {};
            return;
        }
        const auto max_shift = static_cast<float>(d.model.particle_spacing / 4);
        const Vec3<float> p = d.state.position[i] + d.work.moved[i].vector();
        Vec3<float> shift = undo_overlap(d.model, d.ground, p, max_shift, grain_rank(d.state.id[i]));
        if (spread) shift += d.work.shift[i];
        const float size = length(shift);
        d.work.shift[i] = size > max_shift ? shift * (max_shift / size) : shift;
    }
};

/// The end of the step, which is above ground and outside of buildings, and the velocity.
struct Finish {
    Data d;
    float inverse_time_step{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) {
            const auto [end, displacement] =
                end_of_step(d.model, d.ground, Vec3<float>(d.state.position[i]), d.work.moved[i].vector(),
                            Vec3<float>(d.work.shift[i]), grain_rank(d.state.id[i]));
            d.work.moved[i] = row_of(displacement);
            // Impacts are where contact was, before the shift.
            d.work.corrected[i] = d.state.position[i] + displacement;
            d.state.velocity[i] = displacement * inverse_time_step;
            d.state.position[i] = end;
        } else {
            d.work.corrected[i] = d.state.position[i];
        }
        d.work.velocity_before[i] = d.state.velocity[i];
    }
};

/// The square of a particle's speed.
struct SpeedSquare {
    Data d;

    TALUS_DEVICE float operator()(std::uint32_t i) const { return dot(d.state.velocity[i], d.state.velocity[i]); }
};

/// The correction of a step by the wall `f` of a particle, m along its normal; not above 0: none.
TALUS_DEVICE inline float push_of_wall(const Data& d, std::uint32_t i, std::size_t f) {
    const BoundaryFace<float>& wall = d.work.walls[i].faces[f];
    return d.work.walls[i].contacts[f].normal + boundary_push(wall.slope, d.state.multiplier[i]);
}

/// Counts the walls that a particle presses on.
struct CountImpacts {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        std::uint32_t count = 0;
        const Walls& walls = d.work.walls[i];
        for (std::size_t f = 0; f < walls.faces.size() && walls.faces[f].building >= 0; ++f) {
            if (push_of_wall(d, i, f) > 0) ++count;
        }
        d.work.index[i] = count;
    }
};

/// Writes them, each at its place in the order of the particles.
struct WriteImpacts {
    Data d;
    double time_step{};
    BuildingContact* to{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        std::uint32_t at = d.work.index[i];
        const Walls& walls = d.work.walls[i];
        const double mass = density_of(d.model, d.state, i) * d.model.particle_volume();
        for (std::size_t f = 0; f < walls.faces.size() && walls.faces[f].building >= 0; ++f) {
            const float push = push_of_wall(d, i, f);
            if (push <= 0) continue;
            const auto impulse = static_cast<float>(mass * static_cast<double>(push) / time_step);
            const BoundaryFace<float>& wall = walls.faces[f];
            const Vec3<float> displacement = d.work.moved[i].vector(), end = d.work.corrected[i];
            to[at++] = {i, wall.building, impulse, end - wall.normal * (wall.distance + dot(displacement, wall.normal)),
                        speed_without_push(displacement, wall.normal, push, time_step)};
        }
    }
};

/// Eq. (5) as XSPH smoothing; the sum weights both particles of a pair equally, so momentum is conserved.
template <class Smoothing>
struct ApplyViscosity {
    Data d;
    PairKernel<Smoothing> pair;
    float smoothing{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (!d.state.moves(i)) return;
        const Vec3<float> p = d.state.position[i], own = d.work.velocity_before[i];
        Vec3<float> change;
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            const float weight = pair.value(length(p - d.state.position[j]));
            change += (d.work.velocity_before[j] - own) * weight;
        });
        Vec3<float> after = own + change * smoothing;
        if (d.model.viscosity_on_ground) {
            const terrain::GroundSample<float> below = d.ground.terrain.sample(p.x, p.y);
            after = slowed_by_ground(d.model, below, (p.z - below.height) * below.normal.z, after, smoothing);
        }
        d.state.velocity[i] = after;
    }
};

/// Puts debris to sleep that has hardly moved, wakes debris beside moving debris; see cpu/particle_stages.cpp.
struct UpdateSleep {
    Data d;
    float time_step{}, rest_duration{}, sleep_square{}, wake_square{};
    std::uint32_t awake{};
    bool any_asleep{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const bool moves = d.state.moves(i);
        const float square = dot(d.state.velocity[i], d.state.velocity[i]);
        const float still = moves && square < sleep_square ? d.state.still_time[i] + time_step : 0;
        d.state.still_time[i] = still;
        const bool at_wall = !d.ground.solids.empty() && d.work.walls[i].faces[0].building >= 0;
        if (moves && still > rest_duration && !at_wall) {
            d.state.asleep[i] = 1;
            d.state.still_time[i] = 0;
            d.state.velocity[i] = {};
        }
        if (!any_asleep || !moves || square <= wake_square) return;
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            if (j >= awake) store_shared(d.state.asleep[j], std::uint8_t{0});
        });
    }
};

/// Notes in `index` which particles stay on the terrain.
struct MarkInside {
    Data d;
    std::uint32_t awake{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const LocalPoint p = d.state.position[i];
        d.work.index[i] = i >= awake || d.ground.terrain.covers(p.x, p.y) ? 1 : 0;
    }
};

/// The particles of impacts, where those that leave are left out as `index` says.
struct RenumberImpacts {
    static constexpr std::uint32_t gone = 0xffffffff;
    Data d;
    BuildingContact* impacts{};

    TALUS_DEVICE void operator()(std::uint32_t k) const {
        const std::uint32_t i = impacts[k].particle, at = d.work.index[i];
        impacts[k].particle = d.work.index[i + 1] > at ? at : gone;
    }
};

/// Lists the marked ones in their order.
struct ListMarked {
    Data d;
    std::uint32_t count{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const std::uint32_t at = d.work.index[i];
        if (d.work.index[i + 1] > at) d.work.order[at] = i;
    }
};

}  // namespace talus::sim::device
