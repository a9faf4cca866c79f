#pragma once

#include <vector>

#include "sim/model.hpp"
#include "sim/state.hpp"

/// Measurements on the particles of a small world.
namespace talus::validate {

/// The value that `share` (0 to 1) of the values do not exceed, interpolated between the nearest; NaN of none.
[[nodiscard]] double percentile(std::vector<double> values, double share);

/// Elevation of the top of the debris, local m: the mean of its five highest particles, plus half a spacing. A single
/// particle can lie on top of a heap.
[[nodiscard]] double top_of(const sim::Model& model, const sim::State& state);

/// Thickness, m, in `cells` cells of size `cell` from `first` on: volume over area. `place(i)` is where particle i lies
/// along the row of cells, `width` m wide; particles outside do not count.
template <class Place>
[[nodiscard]] std::vector<double> thickness_profile(const sim::Model& model, const sim::State& state, double first,
                                                    double cell, int cells, double width, const Place& place) {
    std::vector<double> thickness(static_cast<std::size_t>(cells), 0.0);
    const double share = model.particle_volume() / (cell * width);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const double at = (place(i) - first) / cell;
        if (at >= 0 && at < cells) thickness[static_cast<std::size_t>(at)] += share;
    }
    return thickness;
}

/// The end of a deposit: the last place, m, at which its profile in cells of size `cell` from 0 on falls below `least`,
/// interpolated between the centres of cells; 0 if it never does.
///
/// A percentile of the particles' distances lies further inside: the 99th of a perfect cone at 94 % of its radius.
[[nodiscard]] double edge_of(const std::vector<double>& profile, double cell, double least);

/// Mean over the time from `from` to `to` of what was read at `times`, straight between readings; NaN: they do not
/// cover it.
[[nodiscard]] double time_mean(const std::vector<double>& times, const std::vector<double>& readings, double from,
                               double to);

/// When the readings first reach `least`, straight between them; NaN: never.
[[nodiscard]] double first_time_of(const std::vector<double>& times, const std::vector<double>& readings, double least);

/// Error norms of a profile against the exact one on cells of equal size.
struct ErrorNorms {
    double relative_l2 = 0;   ///< sqrt(sum of squared differences) / sqrt(sum of squared exact values)
    double relative_max = 0;  ///< largest difference over the largest exact value
};
[[nodiscard]] ErrorNorms error_norms(const std::vector<double>& computed, const std::vector<double>& exact);

}  // namespace talus::validate
