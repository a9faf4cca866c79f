#pragma once

#include <cstdint>
#include <vector>

#include "sim/cpu/cell_sort.hpp"
#include "sim/cpu/neighbours.hpp"
#include "sim/cpu/pair_sums.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::cpu {

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
    void enforce_boundaries(const Model& model, State& state);
    void update_velocities(const Model& model, State& state);
    void apply_viscosity(const Model& model, State& state);
    void remove_left(const Model& model, State& state);

    /// The lists of the last step, by the order it left the particles in (before any left the terrain).
    [[nodiscard]] const NeighbourLists& neighbours() const { return neighbours_; }
    /// The instruction set that the sums over neighbours run on.
    [[nodiscard]] std::string_view instruction_set() const { return sums_.instruction_set; }

  private:
    template <InternalFriction friction>
    void update_multipliers(const Model& model, State& state);
    void pack(const VectorArray& from, std::size_t count, Packed& to) const;
    void apply_stress_changes(const State& state);
    void apply_pair_corrections(const Model& model, const State& state);
    void measure_compression(State& state);
    void measure_start(const Model& model, const State& state);
    void reorder(State& state, std::span<const std::uint32_t> order);

    PairSums sums_;
    PairScale scale_;
    CellSort cell_sort_;
    CellGrid grid_;
    NeighbourLists neighbours_;

    VectorArray displacement_, displacement_next_;  // x* - x
    VectorArray predicted_;                         // x*
    std::vector<float> multiplier_change_;          // of lambda in this iteration
    Packed packed_points_, packed_vectors_;         // what the sums of a pass read of neighbours
    DeviatorArray stress_start_, stress_change_;    // at the step's start; in this iteration
    std::vector<float> compression_;                // max(0, G)
    std::vector<float> tolerated_compression_;      // of what the step started with
    VectorArray ground_gradient_, building_gradient_;
    std::vector<float> ground_contact_, building_contact_;  // accumulated normal corrections of hard contacts, m
    VectorArray ground_friction_, building_friction_;       // accumulated friction corrections, m
    std::vector<std::int32_t> building_;                    // touched in this step, or -1
    std::vector<std::uint8_t> gone_;
    VectorArray vector_scratch_;
    std::vector<float> float_scratch_;
    std::vector<std::uint32_t> id_scratch_;
    std::vector<std::uint8_t> byte_scratch_;
};

/// The step to take next: `time_step` of the scene, or the largest dt_max / 2^k in which the fastest particle, falling
/// freely, moves at most half a spacing.
[[nodiscard]] double choose_time_step(const Model& model, const State& state);

}  // namespace talus::cpu
