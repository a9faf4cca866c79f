#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sim/cpu/backend.hpp"
#include "sim/model.hpp"
#include "sim/stage_times.hpp"
#include "sim/state.hpp"

namespace talus {

/// A model, its state and the backend that moves it.
class Simulation {
  public:
    Simulation(Model model, State state);

    /// Takes one step. Returns why it cannot be trusted, if it cannot; the state is then as that step left it.
    std::optional<std::string> advance();

    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const State& state() const { return state_; }
    [[nodiscard]] StageTimes& stage_times() { return times_; }
    [[nodiscard]] const cpu::Backend& backend() const { return backend_; }

  private:
    Model model_;
    State state_;
    cpu::Backend backend_;
    StageTimes times_;
    double highest_energy_head_ = 0;
};

/// Hash of time, ids, positions and velocities in id order: equal for equal results, whatever the threads.
[[nodiscard]] std::uint64_t hash_state(const State& state);

/// Sum of m v^2 / 2 over the particles, J.
[[nodiscard]] double kinetic_energy(const Model& model, const State& state);
/// Sum of m g z over the particles, J, z above the frame's origin.
[[nodiscard]] double potential_energy(const Model& model, const State& state);

}  // namespace talus
