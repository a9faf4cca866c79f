#include "terrain/plan_bins.hpp"

#include <algorithm>
#include <cmath>

namespace talus::terrain {

PlanBins::PlanBins(std::span<const Extent> extents, double smallest) {
    if (extents.empty()) return;
    Extent all = extents.front();
    for (const Extent& e : extents) {
        all.include({e.x_min, e.y_min});
        all.include({e.x_max, e.y_max});
    }
    box_.x_min = all.x_min;
    box_.y_min = all.y_min;
    box_.edge = std::max(smallest, std::sqrt(all.width() * all.height() / 1e6));
    box_.columns = static_cast<int>(all.width() / box_.edge) + 1;
    box_.rows = static_cast<int>(all.height() / box_.edge) + 1;

    const auto for_each_bin = [&](const Extent& e, const auto& f) {
        const auto column = [&](double x) { return static_cast<int>((x - box_.x_min) / box_.edge); };
        const auto row = [&](double y) { return static_cast<int>((y - box_.y_min) / box_.edge); };
        for (int r = row(e.y_min); r <= row(e.y_max); ++r) {
            for (int c = column(e.x_min); c <= column(e.x_max); ++c) f(box_.index(c, r));
        }
    };
    start_.assign(static_cast<std::size_t>(box_.columns) * static_cast<std::size_t>(box_.rows) + 1, 0);
    for (const Extent& e : extents) for_each_bin(e, [&](std::size_t bin) { ++start_[bin + 1]; });
    for (std::size_t bin = 1; bin < start_.size(); ++bin) start_[bin] += start_[bin - 1];
    items_.resize(start_.back());
    std::vector<std::uint32_t> next = start_;
    for (std::uint32_t i = 0; i < extents.size(); ++i) {
        for_each_bin(extents[i], [&](std::size_t bin) { items_[next[bin]++] = i; });
    }
}

}  // namespace talus::terrain
