#pragma once

#include "sim/model.hpp"
#include "sim/stage_times.hpp"

namespace talus {

/// One step of the method, a line per stage, for any backend: CPU, and the double-precision reference that checks it.
/// The backend has chosen `state.time_step` beforehand.
template <class Backend, class State>
void step(Backend& backend, const Model& model, State& state, StageTimes& times) {
    const auto timed = [&](Stage stage, auto&& run) {
        const StageTimer timer(times, stage);
        run();
    };
    timed(Stage::predict_positions, [&] { backend.predict_positions(model, state); });
    timed(Stage::find_neighbours, [&] { backend.find_neighbours(model, state); });
    timed(Stage::warm_start, [&] { backend.warm_start(model, state); });
    // The shear of the first iteration must already know what the ground holds back.
    timed(Stage::solve_contacts, [&] { backend.solve_contacts(model, state); });
    for (int iteration = 0; iteration < model.solver.iteration_count; ++iteration) {
        timed(Stage::solve_density, [&] { backend.solve_density(model, state); });    // density and internal friction
        timed(Stage::solve_contacts, [&] { backend.solve_contacts(model, state); });  // ground, buildings, friction
    }
    timed(Stage::undo_overlaps, [&] { backend.undo_overlaps(model, state); });  // moves particles, adds no velocity
    timed(Stage::enforce_boundaries, [&] { backend.enforce_boundaries(model, state); });
    timed(Stage::update_velocities, [&] { backend.update_velocities(model, state); });  // v = (x* - x) / dt
    timed(Stage::apply_viscosity, [&] { backend.apply_viscosity(model, state); });
    timed(Stage::remove_left, [&] { backend.remove_left(model, state); });
    state.time += state.time_step;
    ++state.step;
}

}  // namespace talus
