#include "terrain/wall_effort.hpp"

#include <algorithm>
#include <cstddef>

namespace talus::terrain {

WallEffort::WallEffort(const std::vector<Building>& buildings, double range) : range_(range) {
    for (const Building& building : buildings) {
        if (!stands(building)) continue;
        for (const Polygon& polygon : building.footprint) {
            Part& part = parts_.emplace_back(Part{extent_of(polygon), static_cast<double>(polygon.outer.size())});
            for (const Ring& hole : polygon.holes) part.walls += static_cast<double>(hole.size());
        }
    }
    std::sort(parts_.begin(), parts_.end(),
              [](const Part& a, const Part& b) { return a.extent.x_min < b.extent.x_min; });
    for (std::size_t a = 0; a < parts_.size(); ++a) {
        for (std::size_t b = a + 1; b < parts_.size() && parts_[b].extent.x_min <= parts_[a].extent.x_max; ++b) {
            const Extent &p = parts_[a].extent, &q = parts_[b].extent;
            if (p.y_min > q.y_max || q.y_min > p.y_max) continue;
            parts_[a].others += parts_[b].walls;
            parts_[b].others += parts_[a].walls;
        }
    }
    for (const Part& part : parts_) comparisons_ += part.walls * part.others * part.others;
}

double WallEffort::pieces() const {
    double pieces = 0;
    for (const Part& part : parts_) pieces += part.walls * (1 + part.cuts());
    return pieces;
}

double WallEffort::pieces_near(const Extent& extent) const {
    constexpr int samples = 20;
    double pieces = 0;
    for (const Part& part : parts_) {
        const Extent reach = part.extent.grown(range_);
        const double of_part = part.walls + part.cuts();
        for (int row = 0; row < samples; ++row) {
            for (int column = 0; column < samples; ++column) {
                const PlanPoint p{extent.x_min + (column + 0.5) / samples * extent.width(),
                                  extent.y_min + (row + 0.5) / samples * extent.height()};
                pieces += reach.contains(p) ? of_part : 0;
            }
        }
    }
    return pieces / (samples * samples);
}

}  // namespace talus::terrain
