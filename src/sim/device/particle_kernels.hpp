#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "sim/device/atomics.hpp"
#include "sim/device/one_particle.hpp"
#include "sim/device/views.hpp"
#include "sim/particle_density.hpp"
#include "sim/physics/columns.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/net.hpp"
#include "sim/physics/resistance.hpp"
#include "sim/stages/motion.hpp"

/// The stages that treat each particle by itself, and viscosity: one functor per kernel, called with the particle.
/// Bodies that the processor's lanes have too are in sim/stages.
namespace talus::sim::device {

/// Starts the releases whose time has come.
struct ReleaseHeld {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.held[i] != 0 && d.time >= start_time_of(d.model, d.state.id[i])) d.state.held[i] = 0;
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

/// Pore pressure where it evolves, and drag by speed.
struct Drag {
    Data d;
    ColumnBox box{};
    bool slows = true;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (!d.state.moves(i)) return;
        const OneParticle at{d, i};
        const LocalPoint p = d.state.position[i];
        float counted = 0;
        for_each_column(p.x, p.y, box.inverse_width, [&](std::int64_t column, std::int64_t row, float share) {
            const std::uint32_t* const units = box.at(column, row);
            if (units != nullptr) counted += share * static_cast<float>(*units) * (1 / units_per_particle);
        });
        const float in_column = counted / open_share(d.model, d.ground, p, at.rank());
        if (d.model.evolving_pressure.on) at.set_soil(stages::evolved_soil(at, in_column));
        if (slows) at.set_velocity(stages::slowed_velocity(at, in_column));
    }
};

struct ApplyGravity {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) d.state.velocity[i].z -= d.step.fall;
    }
};

/// Initialises what the step knows of all particles in their new order, sleeping ones included.
struct Begin {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const LocalPoint p = d.state.position[i];
        const Vec3<float> displacement = d.state.moves(i) ? d.state.velocity[i] * d.step.time_step : Vec3<float>{};
        d.work.place[i] = row_of(p + displacement);
        d.work.moved[i] = row_of(displacement);
        d.work.corrected[i] = displacement;
        d.work.velocity_before[i] = d.state.velocity[i];
        d.work.contact[i] = {};
        if (!d.ground.solids.empty()) d.work.walls[i] = {};
    }
};

/// Resistance of every particle, where it varies between them.
struct Resist {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const { stages::resist(OneParticle{d, i}); }
};

struct Contacts {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) stages::contacts(OneParticle{d, i});
    }
};

struct ResolvePenetration {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) {
            stages::resolve_penetration(OneParticle{d, i});
        } else {
            d.work.shift[i] = {};
        }
    }
};

/// The end of the step, which is above ground and outside of buildings, and the velocity.
struct Finish {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) {
            const auto [end, displacement] =
                end_of_step(d.model, d.ground, Vec3<float>(d.state.position[i]), d.work.moved[i].vector(),
                            Vec3<float>(d.work.shift[i]), grain_rank(d.state.id[i]));
            d.work.moved[i] = row_of(displacement);
            // Impacts are where contact was, before the shift.
            d.work.corrected[i] = d.state.position[i] + displacement;
            d.state.velocity[i] = displacement * d.step.inverse_time_step;
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
        const WallContacts& walls = d.work.walls[i];
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
        const WallContacts& walls = d.work.walls[i];
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

template <class Smoothing>
struct ApplyViscosity {
    Data d;
    stages::PairKernel<Smoothing> kernel;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) stages::apply_viscosity(OneParticle{d, i}, kernel);
    }
};

struct UpdateSleep {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) {
            stages::update_sleep(OneParticle{d, i});
        } else {
            d.state.still_time[i] = 0;
        }
    }
};

/// Notes in `index` which particles stay on the terrain.
struct MarkInside {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const LocalPoint p = d.state.position[i];
        d.work.index[i] = i >= d.awake || d.ground.terrain.covers(p.x, p.y) ? 1 : 0;
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
