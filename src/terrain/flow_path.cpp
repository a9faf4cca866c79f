#include "terrain/flow_path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace talus {
namespace {

struct Projection {
    double share;     ///< of the segment, 0 to 1
    double distance;  ///< m
};

Projection project(const PlanPoint& a, const PlanPoint& b, const PlanPoint& p) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double share = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    return {share, std::hypot(a.x + share * dx - p.x, a.y + share * dy - p.y)};
}

}  // namespace

FlowPath::FlowPath(std::vector<PlanPoint> points, double corridor_width) : corridor_width_(corridor_width) {
    for (const PlanPoint& p : points) {
        if (points_.empty()) {
            chainage_.push_back(0);
        } else {
            const double step = std::hypot(p.x - points_.back().x, p.y - points_.back().y);
            if (!(step > 1e-6)) continue;  // a repeated point has no direction
            chainage_.push_back(chainage_.back() + step);
        }
        points_.push_back(p);
    }
    assert(points_.size() >= 2 && corridor_width > 0);

    const double half_width = corridor_width / 2;
    Extent extent{points_[0].x, points_[0].y, points_[0].x, points_[0].y};
    for (const PlanPoint& p : points_) extent.include(p);
    extent = extent.grown(half_width);
    // An eighth of the half width, but not more than some four million cells.
    const double cell = std::max(half_width / 8, std::sqrt(extent.width() * extent.height() / 4e6));
    const GridGeometry g{extent.x_min, extent.y_min, cell, static_cast<int>(extent.width() / cell) + 1,
                         static_cast<int>(extent.height() / cell) + 1};
    nearest_segment_ = Grid<std::int32_t>(g, -1);
    std::vector<float> distance(g.size(), std::numeric_limits<float>::infinity());
    const double reach = half_width + cell;  // so that no cell that the corridor touches is left out
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        const PlanPoint &a = points_[i], &b = points_[i + 1];
        const auto column = [&](double x) {
            return std::clamp(static_cast<int>((x - g.x_min) / cell), 0, g.columns - 1);
        };
        const auto row = [&](double y) { return std::clamp(static_cast<int>((y - g.y_min) / cell), 0, g.rows - 1); };
        const int last_column = column(std::max(a.x, b.x) + reach), last_row = row(std::max(a.y, b.y) + reach);
        for (int r = row(std::min(a.y, b.y) - reach); r <= last_row; ++r) {
            for (int c = column(std::min(a.x, b.x) - reach); c <= last_column; ++c) {
                const auto d = static_cast<float>(project(a, b, g.centre(c, r)).distance);
                const std::size_t k = g.index(c, r);
                if (d > reach || d >= distance[k]) continue;
                distance[k] = d;
                nearest_segment_.values[k] = static_cast<std::int32_t>(i);
            }
        }
    }
}

std::optional<PathPosition> FlowPath::locate(const PlanPoint& p) const {
    if (empty()) return std::nullopt;
    const GridGeometry& g = nearest_segment_.geometry;
    const double column = std::floor((p.x - g.x_min) / g.cell), row = std::floor((p.y - g.y_min) / g.cell);
    if (!(column >= 0 && row >= 0 && column < g.columns && row < g.rows)) return std::nullopt;
    const std::int32_t centre = nearest_segment_.at(static_cast<int>(column), static_cast<int>(row));
    if (centre < 0) return std::nullopt;

    // The cell's segment is nearest to its centre; nearest to this point may be one a little up or down the path.
    PathPosition best{0, std::numeric_limits<double>::infinity()};
    const auto consider = [&](std::size_t i) {
        const Projection q = project(points_[i], points_[i + 1], p);
        if (q.distance < best.offset) best = {chainage_[i] + q.share * (chainage_[i + 1] - chainage_[i]), q.distance};
    };
    const auto middle = static_cast<std::size_t>(centre);
    const double first = chainage_[middle] - 2 * g.cell, last = chainage_[middle + 1] + 2 * g.cell;
    consider(middle);
    for (std::size_t i = middle; i > 0 && chainage_[i] >= first; --i) consider(i - 1);
    for (std::size_t i = middle + 1; i + 1 < points_.size() && chainage_[i] <= last; ++i) consider(i);
    if (best.offset > corridor_width_ / 2) return std::nullopt;
    return best;
}

PlanPoint FlowPath::point_at(double chainage) const {
    assert(!empty());
    if (!(chainage > 0)) return points_.front();
    if (chainage >= length()) return points_.back();
    const auto next = std::upper_bound(chainage_.begin(), chainage_.end(), chainage);
    const auto i = static_cast<std::size_t>(next - chainage_.begin()) - 1;
    const double share = (chainage - chainage_[i]) / (chainage_[i + 1] - chainage_[i]);
    const PlanPoint &a = points_[i], &b = points_[i + 1];
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

}  // namespace talus
