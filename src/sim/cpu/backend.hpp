#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sim/cpu/cell_sort.hpp"
#include "sim/cpu/columns.hpp"
#include "sim/cpu/neighbours.hpp"
#include "sim/cpu/stages.hpp"
#include "sim/cpu/work.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "sim/step_constants.hpp"

namespace talus::sim::cpu {

/// Minimum number of particles per task.
inline constexpr std::size_t particle_grain = 256, block_grain = particle_grain / block_size;

/// Blocks [first, last).
struct Blocks {
    std::size_t first, last;
};

/// The stages of a step on all cores. Holds data of a single step only; allocates nothing after construction, except
/// when debris gets denser than ever before, and for the columns of speed-dependent drag when that first acts. Every
/// stage works on blocks of particles; those that evaluate formulas are compiled per instruction set (stages.hpp).
///
/// The iterations correct displacements of the step, not predicted positions: a velocity is then a small number divided
/// by dt, not the difference of two large ones.
class Backend {
  public:
    Backend(const Model& model, std::size_t capacity);

    /// Before the stages of a step, when its length is known.
    void begin_step(const Model& model, const State& state);
    void release_held(const Model& model, State& state);
    void apply_drag(const Model& model, const Ground& ground, State& state);
    void predict_positions(const Model& model, const Ground& ground, State& state);
    void sort_particles(const Model& model, State& state);
    void find_neighbours(const Model& model, State& state);
    void prepare_particles(const Model& model, const Ground& ground, State& state);
    void warm_start(const Model& model, const Ground& ground, State& state);
    void solve_density(const Model& model, const Ground& ground, State& state);
    void solve_contacts(const Model& model, const Ground& ground, State& state);
    void measure_compression(const Model& model, State& state) const;
    void resolve_penetration(const Model& model, const Ground& ground, State& state);
    void enforce_boundaries(const Model& model, const Ground& ground, State& state);
    void update_velocities(const Model& model, const Ground& ground, State& state);
    void measure_impacts(const Model& model, const Ground& ground, State& state) const;
    void apply_viscosity(const Model& model, const Ground& ground, State& state);
    void update_sleep(const Model& model, const Ground& ground, State& state);
    void remove_outflow(const Model& model, const Ground& ground, State& state);

    /// The lists of the last step, in the order in which it left the particles (before any was removed).
    [[nodiscard]] const NeighbourLists& neighbours() const { return neighbours_; }
    /// The instruction set that the stages run on.
    [[nodiscard]] std::string_view instruction_set() const { return particle_stages_.instruction_set; }

  private:
    void run(StageFunction stage, const Model& model, const Ground& ground, State& state, Blocks blocks);
    void run(StageFunction stage, const Model& model, const Ground& ground, State& state);  ///< on all awake particles
    void count_columns(const Model& model, const Ground& ground, const State& state);
    void reorder(State& state, std::span<const std::uint32_t> order);

    StepConstants constants_;
    ParticleStages particle_stages_;
    StressStages stress_stages_;
    PairStages pair_stages_;
    Columns columns_;
    CellSort cell_sort_;
    CellGrid grid_;
    std::span<const std::uint32_t> by_cell_;  // the result of sort_particles()
    NeighbourSearch search_;
    NeighbourLists neighbours_;
    Work work_;
    State reordered_;  // arrays to gather into
    std::vector<std::uint8_t> gone_;
    std::vector<std::uint32_t> new_index_;  // of the particles that stay
};

}  // namespace talus::sim::cpu
