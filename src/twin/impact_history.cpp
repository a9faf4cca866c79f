#include "twin/impact_history.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace talus::twin {
namespace {

bool same(const observe::BuildingImpact& a, const observe::BuildingImpact& b) {
    const auto numbers = [](const observe::BuildingImpact& i) {
        return std::array{
            i.peak_force, i.peak_impact_pressure, i.peak_depth,          i.peak_dynamic_pressure, i.peak_speed,
            i.impulse,    i.retained_volume,      i.peak_filling_height, i.overtopped_volume,     i.passed_volume};
    };
    return a.hit == b.hit && std::isnan(a.failure_time) == std::isnan(b.failure_time) && numbers(a) == numbers(b);
}

}  // namespace

void ImpactHistory::add(std::size_t obstacle, double time, const observe::BuildingImpact& impact) {
    if (obstacle >= entries_.size()) entries_.resize(obstacle + 1);
    auto& entries = entries_[obstacle];
    if (same(entries.empty() ? observe::BuildingImpact{} : entries.back().second, impact)) return;
    entries.emplace_back(time, impact);
    entries.back().second.name.clear();
    entries.back().second.history.clear();
}

void ImpactHistory::forget(std::size_t obstacle) {
    if (obstacle < entries_.size()) entries_[obstacle].clear();
}

observe::BuildingImpact ImpactHistory::at(std::size_t obstacle, double time) const {
    if (obstacle >= entries_.size()) return {};
    const auto& entries = entries_[obstacle];
    const auto after = std::upper_bound(entries.begin(), entries.end(), time + 1e-9,
                                        [](double t, const auto& entry) { return t < entry.first; });
    return after == entries.begin() ? observe::BuildingImpact{} : (after - 1)->second;
}

}  // namespace talus::twin
