#include "sim/fault.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace talus::sim {

double speed_bound(const Model& model, double highest_energy_head) {
    const double fall = std::max(0.0, highest_energy_head) + model.particle_spacing;
    return speed_margin * std::sqrt(2 * model.gravity * fall) + 1;
}

Status find_fault(const Model& model, const StateSummary& state, double highest_energy_head) {
    const auto fault = [&]<class... Values>(fmt::format_string<double, Values...> text, Values... values) {
        return Error{fmt::vformat(text, fmt::make_format_args(state.time, values...))};
    };
    if (!std::isfinite(state.max_speed) || !std::isfinite(state.mean_compression)) {
        return fault(
            "at t = {:.4g} s positions are no longer finite numbers: lower solver.largest_time_step_s or "
            "solver.under_relaxation");
    }
    if (state.mean_compression > model.solver.compression_limit) {
        return fault(
            "at t = {:.4g} s debris is compressed by {:.3g} on average, over solver.compression_limit = {:.3g}: raise "
            "solver.iteration_count or lower solver.largest_time_step_s",
            state.mean_compression, model.solver.compression_limit);
    }
    if (!model.solver.time_step) {
        const double smallest = model.solver.smallest_time_step;
        const double moved = smallest * (state.max_speed + model.gravity * smallest);
        if (moved > model.solver.displacement_limit * model.particle_spacing) {
            return fault(
                "at t = {:.4g} s a particle at {:.4g} m/s moves more than solver.displacement_limit = {:.3g} of a "
                "spacing in "
                "the smallest step: lower solver.smallest_time_step_s = {:.3g} or raise solver.particle_spacing_m",
                state.max_speed, model.solver.displacement_limit, smallest);
        }
    }
    const double bound = speed_bound(model, highest_energy_head);
    if (state.max_speed > bound) {
        return fault(
            "at t = {:.4g} s a particle moves at {:.4g} m/s, more than its fall can explain ({:.4g} m/s): lower "
            "solver.largest_time_step_s or solver.under_relaxation",
            state.max_speed, bound);
    }
    return {};
}

}  // namespace talus::sim
