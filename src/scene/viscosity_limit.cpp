#include "scene/viscosity_limit.hpp"

#include <cmath>

#include <fmt/format.h>

#include "sim/physics/kernel.hpp"
#include "sim/physics/viscosity.hpp"

namespace talus {
namespace {

double longest_step(const SolverSpec& solver) {
    return solver.time_step.value_or(solver.largest_time_step);
}

}  // namespace

double highest_viscosity(const SolverSpec& solver) {
    return viscosity_reference_step / longest_step(solver);
}

std::optional<Violation> too_viscous(const MaterialSpec& material, const SolverSpec& solver, double particle_spacing) {
    double given = material.viscosity, highest = highest_viscosity(solver);
    const char* key = "viscosity";
    if (material.kinematic_viscosity) {
        const Kernel kernel = make_kernel(solver.kernel, particle_spacing, solver.support_ratio * particle_spacing);
        given = *material.kinematic_viscosity;
        highest = kinematic_viscosity(highest, kernel.second_moment);
        key = "kinematic_viscosity_m2ps";
    }
    if (given <= highest) return {};
    return Violation{
        key, fmt::format(" = {:.4g} is refused; with particles of {:.3g} m and steps of up to {:.3g} s it must be at "
                         "most {:.4g}; larger particles or shorter steps allow more",
                         given, particle_spacing, longest_step(solver), std::floor(1e4 * highest) / 1e4)};
}

}  // namespace talus
