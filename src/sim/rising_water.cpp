#include "sim/rising_water.hpp"

#include <algorithm>
#include <cmath>

#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::sim {

double ratio_at(const std::vector<params::PressureSample>& rows, double time) {
    const auto after = std::upper_bound(rows.begin(), rows.end(), time,
                                        [](double t, const params::PressureSample& row) { return t < row.time; });
    if (after == rows.begin()) return rows.front().ratio;
    if (after == rows.end()) return rows.back().ratio;
    const params::PressureSample &a = *(after - 1), &b = *after;
    return a.ratio + (b.ratio - a.ratio) * (time - a.time) / (b.time - a.time);
}

bool has_rising_water(const Model& model) {
    return std::any_of(model.releases.begin(), model.releases.end(),
                       [](const ReleaseGroup& release) { return !release.water.empty(); });
}

bool water_to_come(const Model& model, const StateSummary& state) {
    for (std::size_t r = 0; r < model.releases.size(); ++r) {
        const ReleaseGroup& release = model.releases[r];
        if (release.water.empty() || !std::isfinite(release.start_time)) continue;
        const bool failed = r < state.water_of_release.size() && state.water_of_release[r].failed != 0;
        if (!failed && state.time <= release.water.back().time) return true;
    }
    return false;
}

void raise_water(const Model& model, StateSummary& state,
                 const std::function<PlaceSum(std::uint32_t, std::uint32_t)>& places) {
    if (!has_rising_water(model)) return;
    state.water_of_release.resize(model.releases.size());
    for (std::size_t r = 0; r < model.releases.size(); ++r) {
        const ReleaseGroup& release = model.releases[r];
        Water& water = state.water_of_release[r];
        if (release.water.empty() || water.failed != 0) continue;
        if (state.time >= release.start_time) {
            const PlaceSum sum = places(release.first_particle, release.last_particle);
            if (sum.count == 0) continue;
            const Vec3<double> now = sum.mean();
            if (water.started == 0) water.start = now;
            water.started = 1;
            if (length(now - water.start) > model.particle_spacing) {
                water.failed = 1;
                water.failed_at = state.time;
                water.rise = 0;
                continue;
            }
        }
        const double before = ratio_at(release.water, state.time);
        const double after = ratio_at(release.water, state.time + state.time_step);
        water.ratio = static_cast<float>(after);
        water.rise = static_cast<float>(after - before);
    }
}

}  // namespace talus::sim
