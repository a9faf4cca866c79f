#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/lanes.hpp"
#include "sim/cpu/neighbours.hpp"
#include "sim/model.hpp"
#include "sim/physics/contact.hpp"
#include "sim/state.hpp"

namespace talus::cpu {

/// What a step knows about its particles and forgets at its end, by the same index as State. Arrays of Oct are those
/// that neighbours read.
struct Work {
    explicit Work(std::size_t capacity);

    std::vector<float> column_particles;  ///< before the step, in the column of the flow; with drag by speed only
    std::vector<float> mobile;            ///< 1, or 0 for debris that is held
    VectorArray predicted;                ///< x*: before the step, for finding neighbours; after it, where it ends
    std::vector<Oct> motion;              ///< x*, nothing; x* - x so far, the last change of lambda. At last x and v
    std::vector<Oct> stress;              ///< xx, xy, xz, yy; yz, zz, nothing, pressure: what is applied to neighbours.
                                          ///< With pair friction, at first: x
    VectorArray corrected;                ///< the displacement that contacts have yet to agree to
    VectorArray shift;                    ///< undoes overlaps, becomes no velocity

    // The ground, taken to be plane within the step, and the share of ground and walls in the density.
    std::vector<float> ground_distance;  ///< m, of a particle that is not displaced; NaN where unknown
    std::vector<float> ground_slope;
    VectorArray ground_normal;
    VectorArray boundary_gradient;

    // The density constraint of a particle (see DensityConstraint).
    std::vector<float> constraint_start, surface_share, gradient_square, pair_square;
    std::vector<float> compression;            ///< max(0, G)
    std::vector<float> tolerated_compression;  ///< of what the step started with; pair friction only

    // How a particle is held, where that is not the same for all (see resists_by_particle).
    std::vector<float> ground_friction;  ///< coefficient, lowered by pore pressure
    std::vector<float> ground_strength;  ///< m, where it touches (see Grip)
    std::vector<float> effective_share;  ///< 1 - r_u
    std::vector<float> ground_shear;     ///< see shear_beside_ground; with inertial friction only

    // Contact with the ground in this step (see ContactMemory).
    std::vector<float> contact_normal;
    VectorArray contact_friction;

    /// The walls beside a particle; few have any.
    struct Walls {
        std::array<BoundaryFace<float>, face_count - 1> faces;  ///< distances as ground_distance
        std::array<ContactMemory<float>, face_count - 1> contacts;
    };
    std::vector<std::uint8_t> has_walls;
    std::vector<Walls> walls;
};

/// What a stage works on.
struct StageData {
    const Model& model;
    State& state;
    Work& work;
    NeighbourLists& neighbours;
};

// For the few particles near buildings, one at a time.

/// Samples ground and walls of particle `i` at `p`, `displacement` from where it started the step.
/// Returns their share of the density; the rest is in `work`.
float sample_walls(const Model& model, const State& state, Work& work, std::size_t i, const Vec3<float>& p,
                   const Vec3<float>& displacement);
/// Resolves the contacts with the walls; returns the new displacement.
Vec3<float> resolve_wall_contacts(const Model& model, Work& work, std::size_t i, float multiplier,
                                  Vec3<float> displacement);
/// undo_overlap() of particle `i`.
Vec3<float> undo_overlap_near_walls(const Model& model, const State& state, std::size_t i, const Vec3<float>& p,
                                    float most);
/// Where the particle ends its step, swept; keeps what puts it back above ground from speeding it up.
void enforce_particle(const Model& model, const State& state, Work& work, std::size_t i);

}  // namespace talus::cpu
