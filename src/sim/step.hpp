#pragma once

#include "core/try.hpp"
#include "sim/compression.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/stage_times.hpp"

namespace talus::sim {

/// The parts of a step other than moving particles (see Simulation). This one has none: particles are moved by the
/// state's time step.
struct NoHooks {
    void inject_inflow() {}
    void choose_time_step() {}
    Status check_faults() { return {}; }
    Status entrain_bed() { return {}; }
    void observe() {}
    void remove_failed() {}
};

/// One step of the method, one line per stage, for any backend: the CPU one, and the double-precision reference that
/// checks it. Returns why the step cannot be trusted, if it cannot; the state is then as it left it.
template <class Backend, class State, class Run>
Status step(Backend& backend, const Model& model, const Ground& ground, State& state, StageTimes& times, Run&& run) {
    const auto timed = [&](Stage stage, auto&& f) {
        const StageTimer timer(times, stage);
        return f();
    };
    timed(Stage::inject_inflow, [&] { run.inject_inflow(); });
    timed(Stage::choose_time_step, [&] { run.choose_time_step(); });
    backend.begin_step(model, state);
    timed(Stage::release_held, [&] { backend.release_held(model, state); });
    timed(Stage::apply_drag, [&] { backend.apply_drag(model, ground, state); });
    timed(Stage::predict_positions, [&] { backend.predict_positions(model, ground, state); });
    timed(Stage::sort_particles, [&] { backend.sort_particles(model, state); });
    timed(Stage::find_neighbours, [&] { backend.find_neighbours(model, state); });
    timed(Stage::prepare_particles, [&] { backend.prepare_particles(model, ground, state); });
    timed(Stage::warm_start, [&] { backend.warm_start(model, ground, state); });
    // The shear of the first iteration must already include the resistance of the ground.
    timed(Stage::solve_contacts, [&] { backend.solve_contacts(model, ground, state); });
    const int fewest = model.solver.iteration_count, most = fewest + model.solver.extra_iteration_count;
    for (state.iterations = 0; state.iterations < most;) {
        // Density and internal friction; then ground, buildings and their friction.
        timed(Stage::solve_density, [&] { backend.solve_density(model, ground, state); });
        timed(Stage::solve_contacts, [&] { backend.solve_contacts(model, ground, state); });
        if (++state.iterations < fewest) continue;
        timed(Stage::measure_compression, [&] { backend.measure_compression(model, state); });
        if (!needs_iteration(state)) break;
    }
    timed(Stage::resolve_penetration, [&] { backend.resolve_penetration(model, ground, state); });
    timed(Stage::enforce_boundaries, [&] { backend.enforce_boundaries(model, ground, state); });
    timed(Stage::update_velocities, [&] { backend.update_velocities(model, ground, state); });
    timed(Stage::measure_impacts, [&] { backend.measure_impacts(model, ground, state); });
    timed(Stage::apply_viscosity, [&] { backend.apply_viscosity(model, ground, state); });
    timed(Stage::update_sleep, [&] { backend.update_sleep(model, ground, state); });
    timed(Stage::remove_outflow, [&] { backend.remove_outflow(model, ground, state); });
    state.time += state.time_step;
    ++state.step;
    TALUS_TRY(timed(Stage::check_faults, [&] { return run.check_faults(); }));
    TALUS_TRY(timed(Stage::entrain_bed, [&] { return run.entrain_bed(); }));
    timed(Stage::observe, [&] { run.observe(); });
    timed(Stage::remove_failed, [&] { run.remove_failed(); });
    return {};
}

template <class Backend, class State>
void step(Backend& backend, const Model& model, const Ground& ground, State& state, StageTimes& times) {
    (void)step(backend, model, ground, state, times, NoHooks{});  // which finds no fault
}

}  // namespace talus::sim
