#include "run/run_result.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "run/words.hpp"

namespace talus::run {
namespace {

/// Of the peak of the kinetic energy: the stop criterion of AvaFrame (com1DFA, stopCrit).
constexpr double slow_share = 0.01;

}  // namespace

StillMoving still_moving(const std::vector<observe::TimeSample>& timeseries, const observe::TimeSample& end) {
    StillMoving moving;
    const double debris = end.volume_moving + end.volume_deposited + end.volume_left;
    if (end.volume_moving > 0) {
        moving.volume = end.volume_moving;
        moving.share = end.volume_moving / debris;
        moving.greatest_speed = end.largest_speed;
    }
    double peak = end.kinetic_energy;
    for (const observe::TimeSample& row : timeseries) peak = std::max(peak, row.kinetic_energy);
    if (!(peak > 0) || end.kinetic_energy >= slow_share * peak) return moving;
    const auto last = std::find_if(timeseries.rbegin(), timeseries.rend(), [&](const observe::TimeSample& row) {
        return row.kinetic_energy >= slow_share * peak;
    });
    if (last != timeseries.rend()) moving.slow_since = last->time;
    return moving;
}

std::string with_what_moved(std::string reason, const StillMoving& moving) {
    if (!(moving.volume > 0)) return reason;
    reason += fmt::format(" with {} m3 still moving ({} % of the debris), at up to {} m/s", rounded(moving.volume, 3),
                          rounded(100 * moving.share, 3), rounded(moving.greatest_speed, 2));
    if (!std::isnan(moving.slow_since)) {
        reason += fmt::format("; its kinetic energy was below {:.3g} % of its peak from {:.3g} s on", 100 * slow_share,
                              moving.slow_since);
    }
    return reason;
}

}  // namespace talus::run
