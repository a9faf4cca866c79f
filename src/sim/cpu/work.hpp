#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/cpu/neighbours.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/physics/contact.hpp"
#include "sim/state.hpp"
#include "sim/step_constants.hpp"
#include "simd/lanes.hpp"

namespace talus::sim::cpu {

/// Rows of eight numbers in a cache line, which neighbours read at once. A type for each meaning.
struct DisplacedRow : simd::Oct {};  ///< predicted position x, y, z, 0; displacement x, y, z, change of lambda to apply
struct StressRow : simd::Oct {};     ///< change to apply of the stress tensor: xx, xy, xz, yy; yz, zz, 0, pressure
struct MotionRow : simd::Oct {};     ///< as in State: position x, y, z, 0; velocity x, y, z, 0

// clang-format off
/// What a step knows about its particles and forgets at its end, by the same index as State: X(array, name).
#define TALUS_WORK_ARRAYS(X)                                                                                           \
    X(std::vector<float>, column_particles)  /* in the column of the flow, before the step; with drag by speed only */ \
    X(std::vector<float>, mobile)            /* 1, or 0 for debris that is held or asleep */                           \
    X(VectorArray, predicted)                /* where gravity alone leads, before the particles are sorted */          \
    X(std::vector<DisplacedRow>, displaced)  /* by what the iterations have corrected so far */                        \
    X(std::vector<StressRow>, stress)        /* with internal friction as a stress only */                             \
    X(std::vector<MotionRow>, motion)                                                                                  \
    X(VectorArray, corrected)                /* the displacement that contacts have yet to agree to */                 \
    X(VectorArray, shift)                    /* undoes overlaps, becomes no velocity */                                \
    X(VectorArray, end)                      /* position at the end of the step */                                     \
    /* The ground, taken to be plane within the step, and the share of ground and walls in the density. */             \
    X(std::vector<float>, ground_distance)   /* m, of a particle that is not displaced */                              \
    X(std::vector<float>, ground_slope)                                                                                \
    X(VectorArray, ground_normal)                                                                                      \
    X(VectorArray, boundary_gradient)                                                                                  \
    /* The density constraint of a particle (see DensityConstraint). */                                                \
    X(std::vector<float>, constraint_start)                                                                            \
    X(std::vector<float>, surface_share)                                                                               \
    X(std::vector<float>, gradient_square)                                                                             \
    X(std::vector<float>, pair_square)                                                                                 \
    X(std::vector<float>, compression)           /* max(0, G) */                                                       \
    X(std::vector<float>, tolerated_compression) /* that the step started with */                                     \
    /* How a particle is held, where that is not the same for all (see resists_by_particle). */                        \
    X(std::vector<float>, ground_friction)   /* coefficient, lowered by pore pressure */                               \
    X(std::vector<float>, ground_strength)   /* m, where it touches (see Grip) */                                      \
    X(std::vector<float>, effective_share)   /* 1 - r_u */                                                             \
    X(std::vector<float>, ground_shear)      /* see shear_beside_ground; with inertial friction only */                \
    /* Contact with the ground in this step (see ContactMemory). */                                                    \
    X(std::vector<float>, contact_normal)                                                                              \
    X(VectorArray, contact_friction)                                                                                   \
    /* The walls beside a particle; few have any. */                                                                   \
    X(VectorArray, wall_place)               /* where walls were sampled, or the step ends without a shift */          \
    X(std::vector<float>, wall_distance)     /* m: nothing is nearer to that place */                                  \
    X(std::vector<std::uint8_t>, has_walls)                                                                            \
    X(std::vector<WallContacts>, walls)
// clang-format on

struct Work {
    explicit Work(std::size_t capacity);

#define TALUS_MEMBER(array, name) array name;
    TALUS_WORK_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
};

/// What a stage works on.
struct StageData {
    const StepConstants& step;
    const Model& model;
    const Ground& ground;
    State& state;
    Work& work;
    NeighbourLists& neighbours;
};

// For the few particles near buildings, one at a time.

/// Samples the walls of particle `i`, beside the ground `base`, at `p`, which is `displacement` from its position at
/// the step's start. Returns the share of ground and walls in the density; the rest is in `work`.
float sample_walls(const Model& model, const Ground& ground, const State& state, Work& work, std::size_t i,
                   const GroundFace<float>& base, const Vec3<float>& p, const Vec3<float>& displacement);
/// Resolves the contacts with the walls; returns the new displacement.
Vec3<float> resolve_wall_contacts(const Model& model, const StepConstants& step, Work& work, std::size_t i,
                                  float multiplier, const Vec3<float>& displacement);
/// undo_overlap() of particle `i`, from the shift `above_ground` that the ground alone asks for; its distance from the
/// walls is in `work`.
Vec3<float> undo_overlap_near_walls(const Model& model, const Ground& ground, const State& state, Work& work,
                                    std::size_t i, const Vec3<float>& p, float max_shift,
                                    const Vec3<float>& above_ground);
/// Whether walls are certainly farther from the particle's end of the step than its sweep goes from there.
bool sweeps_clear_of_walls(const Model& model, const State& state, const Work& work, std::size_t i);
/// The particle's position at the end of the step, found by a sweep; lifting it back above ground must not speed it up.
void enforce_particle(const Model& model, const Ground& ground, const State& state, Work& work, std::size_t i);

}  // namespace talus::sim::cpu
