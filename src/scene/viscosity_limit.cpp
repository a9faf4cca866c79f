#include "scene/viscosity_limit.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "params/time_step.hpp"
#include "sim/physics/kernel.hpp"
#include "sim/physics/viscosity.hpp"

namespace talus::scene {
namespace {

/// The step that is as short as viscosity may make it.
double shortest_step(const params::SolverSpec& solver) {
    const double largest = solver.largest_time_step.value_or(sim::viscosity_reference_step);
    return solver.time_step.value_or(std::max(sim::shortest_viscous_step(largest), solver.smallest_time_step));
}

}  // namespace

double highest_viscosity(const params::SolverSpec& solver) {
    return sim::viscosity_reference_step / shortest_step(solver);
}

std::optional<params::Violation> too_viscous(const params::MaterialSpec& material, const params::SolverSpec& solver,
                                             double particle_spacing) {
    double given = material.viscosity, highest = highest_viscosity(solver);
    const char* key = "viscosity";
    if (material.kinematic_viscosity) {
        const sim::Kernel kernel =
            sim::make_kernel(solver.kernel, particle_spacing, solver.support_ratio * particle_spacing);
        given = *material.kinematic_viscosity;
        highest = sim::kinematic_viscosity(highest, kernel.second_moment);
        key = "kinematic_viscosity_m2ps";
    }
    if (given <= highest) return {};
    return params::Violation{
        key, fmt::format(" = {:.4g} is refused; with particles of {:.3g} m and solver.{} = {:.3g} it must be at most "
                         "{:.4g}; larger particles or shorter steps allow more",
                         given, particle_spacing, solver.time_step ? "time_step_s" : "largest_time_step_s",
                         solver.time_step.value_or(params::largest_time_step(solver, particle_spacing)),
                         std::floor(1e4 * highest) / 1e4)};
}

}  // namespace talus::scene
