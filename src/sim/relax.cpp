#include "sim/relax.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "sim/change.hpp"
#include "sim/cpu/backend.hpp"
#include "sim/step.hpp"

namespace talus::sim {
namespace {

/// Takes steps without inertia until `done`: velocities are reset after each.
template <class Done>
void relax_quasi_static(const Model& model, const Ground& ground, State& state, int max_rounds, Done done) {
    cpu::Backend backend(model, state.count);
    StageTimes times;
    for (int round = 0; round < max_rounds; ++round) {
        step(backend, model, ground, state, times);
        for (auto* component : {&state.velocity.x, &state.velocity.y, &state.velocity.z}) {
            std::fill(component->begin(), component->end(), 0.0f);
        }
        forget_soil(model, state);
        if (done(state)) break;
    }
}

/// Checks at every tenth step whether pressures have stopped growing.
class LoadWatch {
  public:
    bool operator()(const State& state) {
        if (++round_ % interval != 0) return false;
        const double load = std::accumulate(state.multiplier.begin(), state.multiplier.begin() + state.count, 0.0);
        const double before = std::exchange(load_, load);
        return std::abs(load - before) < carried * std::abs(load);
    }

  private:
    static constexpr int interval = 10;
    static constexpr double carried = 0.01;
    int round_ = 0;
    double load_ = 0;
};

/// The model without driving forces or resistance.
Model without_forces(const Model& model) {
    Model still = model;
    still.viscosity = 0;
    still.solver.rest_duration = 0;
    still.solver.depenetration_speed = 1e3;  // without inertia nothing can fly apart
    still.gravity = 0;
    still.friction_coefficient = still.building_friction_coefficient = still.internal_friction_coefficient = 0;
    still.cohesion = 0;
    still.inertial_friction = {};
    still.laws = {};
    still.cover = {};
    still.evolving_pressure.on = false;  // its laws divide by the weight
    still.solver.internal_friction = params::InternalFriction::pair;
    return still;
}

}  // namespace

bool relax(const Model& model, const Ground& ground, State& state, const std::vector<float>& overburden,
           const Progress& progress) {
    constexpr double dense_enough = 0.005;
    constexpr int max_rounds = 400, loading_rounds = 200;
    int round = 0;
    bool ended = false;
    const auto go_on = [&] {
        ended = progress && !progress(static_cast<double>(++round) / (max_rounds + loading_rounds));
        return !ended;
    };
    Model still = without_forces(model);
    Ground closed = ground;
    closed.solids.close_nets();
    for (ReleaseGroup& release : still.releases) release.start_time = 0;
    state.time_step = model.largest_time_step();
    relax_quasi_static(still, closed, state, max_rounds,
                       [&](const State& s) { return s.max_compression < dense_enough || !go_on(); });
    if (ended) return false;
    round = max_rounds;

    still.gravity = model.gravity;
    still.internal_friction_coefficient = model.internal_friction_coefficient;
    still.solver.internal_friction = model.solver.internal_friction;
    still.friction_coefficient = model.friction_coefficient;
    still.building_friction_coefficient = model.building_friction_coefficient;
    still.cohesion = model.cohesion;
    still.cover = model.cover;
    still.evolving_pressure = model.evolving_pressure;
    state.time_step = state.previous_time_step = model.largest_time_step() / 4;
    const double scale = -model.gravity * state.time_step * state.time_step;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        state.multiplier[i] = static_cast<float>(scale * overburden[state.id[i]]);
    }
    LoadWatch carried;
    relax_quasi_static(still, closed, state, loading_rounds, [&](const State& s) { return carried(s) || !go_on(); });
    state.time = 0;
    state.step = 0;
    return !ended;
}

void push_apart(const Model& model, const Ground& ground, State& state) {
    constexpr double dense_enough = 0.02;
    constexpr int max_rounds = 100;
    Model still = without_forces(model);
    still.releases = {{"", std::numeric_limits<double>::infinity(), 0, std::numeric_limits<std::uint32_t>::max()}};
    state.time_step = model.largest_time_step();
    relax_quasi_static(still, ground, state, max_rounds,
                       [](const State& s) { return s.max_compression < dense_enough; });
}

}  // namespace talus::sim
