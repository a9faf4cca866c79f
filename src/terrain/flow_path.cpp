#include "terrain/flow_path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace talus::terrain {
namespace {

/// Whether `p` is nearer to `a` than to `b`: if this holds at the corners of a cell, it holds in the whole cell.
bool nearer_to(const PlanPoint& a, const PlanPoint& b, const PlanPoint& p) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    return (2 * p.x - a.x - b.x) * dx + (2 * p.y - a.y - b.y) * dy < -1e-6;  // false for rounding differences
}

}  // namespace

FlowPath::FlowPath(const std::vector<PlanPoint>& points, double corridor_width) : corridor_width_(corridor_width) {
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
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        const PlanPoint &a = points_[i], &b = points_[i + 1];
        const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
        segments_.push_back({a.x, a.y, dx, dy, dx / square, dy / square});
    }

    const double half_width = corridor_width / 2;
    Extent extent{points_[0].x, points_[0].y, points_[0].x, points_[0].y};
    for (const PlanPoint& p : points_) extent.include(p);
    extent = extent.grown(half_width);
    // An eighth of the half width, but not more than some four million cells.
    const double cell = std::max(half_width / 8, std::sqrt(extent.width() * extent.height() / 4e6));
    table_ = {extent.x_min, extent.y_min, cell, static_cast<int>(extent.width() / cell) + 1,
              static_cast<int>(extent.height() / cell) + 1};
    inverse_cell_ = 1 / cell;
    for (std::size_t i = 0; i < segments_.size(); ++i) segments_around_.push_back(find_segments_around(i));
    fill_nearest_segment();
    fill_chainage_bound();
    fill_extent_beyond();
}

void FlowPath::fill_nearest_segment() {
    nearest_segment_.assign(table_.size(), -1);
    const double reach = corridor_width_ / 2 + table_.cell;  // so that no cell touched by the corridor is missed
    std::vector<double> nearest(table_.size(), reach * reach);
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        const PlanPoint &a = points_[i], &b = points_[i + 1];
        const auto column = [&](double x) {
            return std::clamp(static_cast<int>((x - table_.x_min) / table_.cell), 0, table_.columns - 1);
        };
        const auto row = [&](double y) {
            return std::clamp(static_cast<int>((y - table_.y_min) / table_.cell), 0, table_.rows - 1);
        };
        const int last_column = column(std::max(a.x, b.x) + reach), last_row = row(std::max(a.y, b.y) + reach);
        for (int r = row(std::min(a.y, b.y) - reach); r <= last_row; ++r) {
            for (int c = column(std::min(a.x, b.x) - reach); c <= last_column; ++c) {
                const double d = PathField::project(segments_[i], table_.centre(c, r)).distance_squared;
                const std::size_t k = table_.index(c, r);
                if (d >= nearest[k]) continue;
                nearest[k] = d;
                nearest_segment_[k] = static_cast<std::int32_t>(i);
            }
        }
    }
}

void FlowPath::fill_chainage_bound() {
    chainage_bound_.assign(table_.size(), -1.0F);
    for (int r = 0; r < table_.rows; ++r) {
        for (int c = 0; c < table_.columns; ++c) {
            const std::size_t k = table_.index(c, r);
            if (nearest_segment_[k] < 0) continue;
            const auto [first, last] = segments_around_[static_cast<std::size_t>(nearest_segment_[k])];
            const PlanPoint centre = table_.centre(c, r);
            double bound = 0;
            for (std::size_t i = first; i < last; ++i) {
                // The chainage of the projection on a segment is greatest in one of the cell's corners.
                double share = 0;
                bool nearer_before = i > first;
                for (const double x : {-0.5, 0.5}) {
                    for (const double y : {-0.5, 0.5}) {
                        const PlanPoint corner{centre.x + x * table_.cell, centre.y + y * table_.cell};
                        share = std::max(share, PathField::project(segments_[i], corner).share);
                        nearer_before = nearer_before && nearer_to(points_[i - 1], points_[i], corner);
                    }
                }
                // The whole cell is before this segment, and nearer to the start of the previous one.
                if (share == 0 && nearer_before) continue;
                bound = std::max(bound, chainage_[i] + share * (chainage_[i + 1] - chainage_[i]));
            }
            chainage_bound_[k] = static_cast<float>(bound + 1e-3);  // for the rounding to float
        }
    }
}

void FlowPath::fill_extent_beyond() {
    const double none = std::numeric_limits<double>::infinity();
    // The last: beyond the path's end.
    extent_beyond_.assign(static_cast<std::size_t>((length() + 1) * inverse_cell_) + 2, {none, none, -none, -none});
    for (int r = 0; r < table_.rows; ++r) {
        for (int c = 0; c < table_.columns; ++c) {
            const float bound = chainage_bound_[table_.index(c, r)];
            if (bound < 0) continue;
            Extent& extent = extent_beyond_[static_cast<std::size_t>(bound * inverse_cell_)];
            const PlanPoint corner{table_.x_min + c * table_.cell, table_.y_min + r * table_.cell};
            extent.include(corner);
            extent.include({corner.x + table_.cell, corner.y + table_.cell});
        }
    }
    for (std::size_t k = extent_beyond_.size() - 1; k > 0; --k) {
        const Extent& beyond = extent_beyond_[k];
        if (beyond.x_min > beyond.x_max) continue;
        extent_beyond_[k - 1].include({beyond.x_min, beyond.y_min});
        extent_beyond_[k - 1].include({beyond.x_max, beyond.y_max});
    }
}

Extent FlowPath::extent_beyond(double chainage) const {
    assert(!empty());
    const auto k = static_cast<std::size_t>(std::max(0.0, chainage) * inverse_cell_);
    return extent_beyond_[std::min(k, extent_beyond_.size() - 1)];
}

SegmentRange FlowPath::find_segments_around(std::size_t middle) const {
    std::size_t first = middle, last = middle + 1;
    const double begin = chainage_[first] - 2 * table_.cell, end = chainage_[last] + 2 * table_.cell;
    while (first > 0 && chainage_[first] >= begin) --first;
    while (last + 1 < points_.size() && chainage_[last] <= end) ++last;
    return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)};
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

std::optional<double> first_chainage(const FlowPath& path, const std::vector<Polygon>& outlines) {
    std::optional<double> first;
    for (const Polygon& outline : outlines) {
        for (const PlanPoint& corner : outline.outer) {
            const auto place = path.locate(corner);
            if (place && (!first || place->chainage < *first)) first = place->chainage;
        }
    }
    return first;
}

}  // namespace talus::terrain
