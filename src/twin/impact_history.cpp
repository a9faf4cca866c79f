#include "twin/impact_history.hpp"

#include <algorithm>
#include <array>

namespace talus::twin {
namespace {

bool same(const ObstacleRecord& a, const ObstacleRecord& b) {
    const auto numbers = [](const ObstacleRecord& r) {
        return std::array{r.impact.peak_force,
                          r.impact.peak_pressure,
                          r.impact.peak_depth,
                          r.impact.peak_dynamic_pressure,
                          r.impact.peak_speed,
                          r.overtopped,
                          r.held};
    };
    return a.impact.hit == b.impact.hit && numbers(a) == numbers(b);
}

}  // namespace

void ImpactHistory::add(std::size_t obstacle, double time, const ObstacleRecord& record) {
    if (obstacle >= entries_.size()) entries_.resize(obstacle + 1);
    auto& entries = entries_[obstacle];
    if (same(entries.empty() ? ObstacleRecord{} : entries.back().second, record)) return;
    entries.emplace_back(time, record);
    entries.back().second.impact.name.clear();
}

void ImpactHistory::forget(std::size_t obstacle) {
    if (obstacle < entries_.size()) entries_[obstacle].clear();
}

ObstacleRecord ImpactHistory::at(std::size_t obstacle, double time) const {
    if (obstacle >= entries_.size()) return {};
    const auto& entries = entries_[obstacle];
    const auto after = std::upper_bound(entries.begin(), entries.end(), time + 1e-9,
                                        [](double t, const auto& entry) { return t < entry.first; });
    return after == entries.begin() ? ObstacleRecord{} : (after - 1)->second;
}

}  // namespace talus::twin
