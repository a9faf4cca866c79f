#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "core/result.hpp"
#include "sim/cpu/backend.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/sources/entrainment.hpp"
#include "sim/sources/inflow.hpp"
#include "sim/stage_times.hpp"
#include "sim/state.hpp"
#include "sim/step_watcher.hpp"

namespace talus::sim {

/// A model, its ground and state, its inflows, and the backend that advances it.
class Simulation {
  public:
    /// Memory for all particles of `inflow` is allocated at once.
    Simulation(Model model, Ground ground, State state, InflowFeeder inflow = {});

    /// Takes one step, calling `watcher` if there is one. Returns why the step cannot be trusted, if it cannot; the
    /// state is then that after the step.
    Status advance(StepWatcher* watcher = nullptr);

    /// Adds the particles of inflows that are due. A step begins with it.
    void inject_inflow(StepWatcher* watcher = nullptr);

    /// Lets a user's `edit` change model, ground and state between two steps; nothing else changes a model in a run. It
    /// must not change terrain, particle spacing, kernel or time. The contacts of the last step are dropped.
    void change(const std::function<void(Model&, Ground&, State&)>& edit);

    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const Ground& ground() const { return ground_; }
    [[nodiscard]] const State& state() const { return state_; }
    [[nodiscard]] const InflowFeeder& inflow() const { return inflow_; }
    [[nodiscard]] const StageTimes& stage_times() const { return times_; }
    [[nodiscard]] const cpu::Backend& backend() const { return *backend_; }

  private:
    struct OwnStages;

    void follow_change();
    void measure_energy_and_speed();
    void make_room(std::uint32_t count);
    [[nodiscard]] Status entrain_bed();

    Model model_;  // const except to change()
    Ground ground_;
    State state_;
    InflowFeeder inflow_;
    std::uint32_t expected_ = 0;           // total number of particles from inflows
    std::uint32_t capacity_ = 0;           // particles that the backend has memory for
    std::optional<cpu::Backend> backend_;  // replaced when there are more
    Entrainment entrainment_;
    StageTimes times_;
    double highest_energy_head_;
};

/// Hash of time, ids, positions and velocities in id order: equal for equal results, whatever the number of threads.
[[nodiscard]] std::uint64_t hash_state(const State& state);

/// Sum of m v^2 / 2 over the particles, J.
[[nodiscard]] double kinetic_energy(const Model& model, const State& state);
/// Sum of m g z over the particles, J, z above the frame's origin.
[[nodiscard]] double potential_energy(const Model& model, const State& state);

}  // namespace talus::sim
