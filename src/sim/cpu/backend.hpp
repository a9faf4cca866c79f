#pragma once

#include <cstdint>
#include <vector>

#include "sim/cpu/cell_sort.hpp"
#include "sim/cpu/neighbours.hpp"
#include "sim/cpu/pair_sums.hpp"
#include "sim/model.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/density.hpp"
#include "sim/state.hpp"

namespace talus::cpu {

/// How many particles a task takes at least.
inline constexpr std::size_t particle_grain = 256;

/// The stages of a step on all cores. Holds what lives within a step only; allocates nothing after construction, except
/// when debris gets denser than ever before.
///
/// Displacements of the step, not predicted positions, are what the iterations correct: a velocity is then a small
/// number divided by dt, and not the difference of two large ones.
class Backend {
  public:
    Backend(const Model& model, std::size_t capacity);

    void predict_positions(const Model& model, State& state);
    void find_neighbours(const Model& model, State& state);
    void warm_start(const Model& model, State& state);
    void solve_density(const Model& model, State& state);
    void solve_contacts(const Model& model, State& state);
    void undo_overlaps(const Model& model, State& state);
    void enforce_boundaries(const Model& model, State& state);
    void update_velocities(const Model& model, State& state);
    void apply_viscosity(const Model& model, State& state);
    void remove_left(const Model& model, State& state);

    /// The lists of the last step, by the order it left the particles in (before any left the terrain).
    [[nodiscard]] const NeighbourLists& neighbours() const { return neighbours_; }
    /// The instruction set that the sums over neighbours run on.
    [[nodiscard]] std::string_view instruction_set() const { return sums_.instruction_set; }

  private:
    static bool keeps_stress(const Model& model);
    void pack(const VectorArray& from, std::size_t count, Packed& to) const;
    void measure_compression(State& state);
    void reorder(State& state, std::span<const std::uint32_t> order);

    // A stress per particle that persists between steps (stress_method.cpp).
    void warm_start_stress(const Model& model, State& state);
    void solve_stress(const Model& model, State& state);
    void pack_stress(std::size_t i, float pressure, const Deviator<float>& stress);
    void apply_stress(const State& state);
    void linearise(const Model& model, const State& state);
    void spread(const Model& model, const State& state);

    // Friction per pair, as published (pair_method.cpp).
    void start_pairs(const Model& model, State& state);
    void solve_pairs(const Model& model, State& state);
    void update_pair_multipliers(const Model& model, State& state);
    void apply_pairs(const Model& model, const State& state);

    PairSums sums_;
    PairScale scale_;
    CellSort cell_sort_;
    CellGrid grid_;
    NeighbourLists neighbours_;

    VectorArray displacement_;                          // x* - x
    VectorArray sampled_at_;                            // the displacement at which boundary_ was sampled
    std::vector<Boundary<float>> boundary_;             // ground and walls, taken to be plane within the step
    VectorArray shift_;                                 // undoes overlaps, becomes no velocity
    VectorArray predicted_;                             // x*
    std::vector<float> multiplier_change_;              // of lambda in this iteration
    std::vector<DensityConstraint<float>> constraint_;  // linearised at the predicted positions
    Packed packed_points_, packed_vectors_, packed_rows_, packed_rest_;  // what the sums of a pass read of neighbours
    std::vector<float> compression_;                                     // max(0, G)
    std::vector<float> tolerated_compression_;                           // of what the step started with
    std::vector<ContactMemories<float>> contacts_;                       // of this step
    std::vector<std::uint8_t> gone_;
    VectorArray vector_scratch_;
    std::vector<float> float_scratch_;
    std::vector<std::uint32_t> id_scratch_;
    std::vector<std::uint8_t> byte_scratch_;
};

/// The step to take next: `time_step` of the scene, or the largest dt_max / 2^k in which the fastest particle, falling
/// freely, moves at most `displacement_limit` of a spacing; shorter while the debris is compressed, down to an eighth.
[[nodiscard]] double choose_time_step(const Model& model, const State& state);

}  // namespace talus::cpu
