#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/geometry.hpp"
#include "sim/model.hpp"
#include "sim/physics/boundary_table.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/density.hpp"
#include "sim/stages/particle.hpp"
#include "sim/state.hpp"
#include "sim/step_constants.hpp"
#include "terrain/ground_cover.hpp"
#include "terrain/height_field.hpp"
#include "terrain/solid_walls.hpp"

/// Model, ground and state as the laws read them on a card: numbers and pointers, no containers.
namespace talus::sim::device {

/// A release as the laws need it; see ReleaseGroup.
struct ReleaseView {
    double start_time = 0;
    std::uint32_t first_particle = 0, last_particle = 0;
    std::optional<double> pore_pressure_ratio, solid_fraction;
};

/// See Model.
struct ModelView : ModelValues {
    std::span<const ReleaseView> releases;
    terrain::CoverField cover;
    BoundaryNodes boundary;
};

/// See Ground.
struct GroundView {
    terrain::HeightField terrain;
    terrain::SolidWalls solids;
};

/// See State: the arrays of it, an element per particle.
struct ParticleArrays {
#define TALUS_MEMBER(array, element, name) element* name;
    TALUS_PARTICLE_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
    std::span<const float> density_of_id;
    std::span<const Entry> entry_of_id;
    std::span<Soil<float>> soil_of_id;
    std::span<const Water> water_of_release;

    /// Whether a step moves it.
    [[nodiscard]] TALUS_DEVICE bool moves(std::uint32_t i) const {
        return held[i] == 0 && asleep[i] == 0;
    }
};

/// Four numbers that neighbours read at once.
struct alignas(16) Row {
    float x, y, z, w;

    [[nodiscard]] TALUS_DEVICE Vec3<float> vector() const { return {x, y, z}; }
};
[[nodiscard]] TALUS_DEVICE inline Row row_of(const Vec3<float>& v, float w = 0) {
    return {v.x, v.y, v.z, w};
}

/// The change to apply of a particle's stress, pressure included.
struct alignas(16) StressRow {
    float xx, xy, xz, yy, yz, zz, unused, pressure;

    [[nodiscard]] TALUS_DEVICE stages::StressChange<float> stress() const { return {xx, xy, xz, yy, yz, zz, pressure}; }
};

using Resistance = stages::Resistance<float>;
using GroundPlane = stages::GroundPlane<float>;

// clang-format off
/// What a step knows about its particles and forgets at its end: X(element, name, when). Those that only some runs need
/// are allocated where `when` is true.
#define TALUS_DEVICE_ARRAYS(X)                                                                                         \
    X(Row, place, true)                     /* where gradients are taken: predicted; with pair friction, displaced */  \
    X(Row, moved, true)                     /* displacement in the step so far; change of lambda to apply */           \
    X(StressRow, change, needs.stress)                                                                                 \
    X(LocalPoint, corrected, true)          /* the displacement that contacts have yet to agree to */                  \
    X(LocalPoint, shift, true)              /* undoes overlaps, becomes no velocity */                                 \
    X(LocalPoint, velocity_before, true)    /* viscosity */                                                            \
    X(GroundPlane, plane, true)                                                                                        \
    X(LocalPoint, boundary_gradient, true)                                                                             \
    X(DensityConstraint<float>, constraint, true)                                                                      \
    X(float, compression, true)             /* max(0, G) */                                                            \
    X(float, tolerated_compression, true)   /* of what the step started with */                                        \
    X(Resistance, resistance, needs.resistance)                                                                        \
    X(ContactMemory<float>, contact, true)  /* with the ground */                                                      \
    X(WallContacts, walls, needs.walls)                                                                                \
    X(std::uint32_t, neighbour_count, true)                                                                            \
    X(std::uint64_t, key, true)             /* of the cell, and whether asleep */                                      \
    X(std::uint64_t, key_swap, true)                                                                                   \
    X(std::uint32_t, order, true)                                                                                      \
    X(std::uint32_t, order_swap, true)                                                                                 \
    X(std::uint32_t, index, true)           /* sums over particles, with one entry more at the end */
// clang-format on

struct WorkArrays {
#define TALUS_MEMBER(element, name, when) element* name;
    TALUS_DEVICE_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
};

/// Particles whose neighbour lists are side by side: those that the card works on together.
inline constexpr std::uint32_t list_width = 32;

/// The neighbours of every awake particle: entry k of particle i is at start[i / list_width] + k * list_width + i %
/// list_width.
struct NeighbourView {
    const std::uint32_t *start, *count, *neighbour;

    template <class F>
    TALUS_DEVICE void for_each(std::uint32_t i, const F& f) const {
        const std::uint32_t* entry = neighbour + start[i / list_width] + i % list_width;
        for (std::uint32_t k = count[i]; k > 0; --k, entry += list_width) f(*entry);
    }
};

/// Everything that a kernel reads and writes.
struct Data {
    ModelView model;
    GroundView ground;
    ParticleArrays state;
    WorkArrays work;
    NeighbourView neighbours;
    StepConstants step;
    double time{};                   ///< s, when the step started
    std::uint32_t count{}, awake{};  ///< particles, and those of them that a step moves, which come first
};

}  // namespace talus::sim::device
