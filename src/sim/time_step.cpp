#include "sim/time_step.hpp"

#include <algorithm>
#include <cmath>

#include "sim/physics/viscosity.hpp"

namespace talus::sim {

double choose_time_step(const Model& model, const StateSummary& state) {
    if (model.solver.time_step) return *model.solver.time_step;
    const double reach = model.solver.displacement_limit * model.particle_spacing;
    double dt = std::min(model.largest_time_step(), longest_viscous_step(model.viscosity));
    // Pressure spreads by a few layers per step. Debris that becomes denser is too deep for that; if nothing is done,
    // particles end up at the same place, where no gradient separates them.
    constexpr double too_compressed = 0.01, recovered = 0.005;
    if (state.time_step > 0 && state.mean_compression > recovered) {
        const double eased = state.mean_compression > too_compressed ? state.time_step / 2 : state.time_step;
        dt = std::clamp(eased, std::max(dt / 8, std::min(dt, model.solver.smallest_time_step)), dt);
    }
    // In steps of an eighth of an octave: coarser increments would halve the step for debris that is only just too
    // fast; finer ones would change the step, and the multipliers with it, at every change of speed.
    const double shorter = std::exp2(-0.125);
    const auto too_long = [&] { return dt * (state.max_speed + model.gravity * dt) > reach; };
    while (dt > model.solver.smallest_time_step && too_long())
        dt = std::max(shorter * dt, model.solver.smallest_time_step);
    return dt;
}

}  // namespace talus::sim
