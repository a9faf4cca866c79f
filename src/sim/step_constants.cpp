#include "sim/step_constants.hpp"

#include <algorithm>
#include <cmath>

#include "sim/physics/density.hpp"
#include "sim/physics/friction.hpp"
#include "sim/physics/resistance.hpp"
#include "sim/physics/viscosity.hpp"

namespace talus::sim {

StepConstants::StepConstants(const Model& model, const StateSummary& state) {
    const auto narrow = [](double number) { return static_cast<float>(number); };
    const params::SolverSpec& solver = model.solver;
    const double dt = state.time_step, before = state.previous_time_step;
    time_step = narrow(dt);
    inverse_time_step = narrow(1 / dt);
    fall = narrow(model.gravity * dt);
    max_shift = narrow(model.particle_spacing / 4);

    keeps_stress = solver.internal_friction == params::InternalFriction::stress;
    softness = narrow(solver.constraint_relaxation * model.kernel.rest_gradient_sum);
    jacobi_factor = narrow(sim::jacobi_factor(solver.under_relaxation, model.kernel));
    const double ratio = before > 0 ? dt / before : 0;
    warm_start_scale = narrow(ratio * ratio);
    pressure_scale = narrow(before > 0 ? -1 / (before * before) : 0);
    spreading_share = narrow(sim::spreading_share(dt));
    undone_compression = narrow(solver.depenetration_speed * dt / model.particle_spacing);

    resists_by_particle = sim::resists_by_particle(model);
    cohesive = model.cohesion > 0;
    strength_per_pascal = narrow(sim::strength_per_pascal(model, dt));
    internal_strength = narrow(sim::internal_strength(model, dt));
    inertial_grain_size = narrow(model.inertial_friction.grain_size / model.kernel.gradient_moment);
    pair_friction_cap = narrow(sim::pair_friction_cap(model.internal_friction_coefficient));
    viscous_smoothing = narrow(step_smoothing(model.viscosity, dt));
    water_rises = std::any_of(state.water_of_release.begin(), state.water_of_release.end(),
                              [](const Water& water) { return water.rises(); });

    // A hundredth of the speed of a fall through its own size; waking takes twice that, so that particles do not
    // alternate between the two.
    const double sleep_speed = 0.01 * std::sqrt(model.gravity * model.particle_spacing), wake_speed = 2 * sleep_speed;
    rest_duration = narrow(solver.rest_duration);
    sleep_square = narrow(sleep_speed * sleep_speed);
    wake_square = narrow(wake_speed * wake_speed);
}

}  // namespace talus::sim
