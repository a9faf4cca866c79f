#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/number.hpp"
#include "core/result.hpp"

namespace talus::terrain {

/// A plan position relative to the flow path.
struct PathPosition {
    double chainage;  ///< horizontal distance along the path from its first point, m
    double offset;    ///< distance from the path, m
};

/// A segment of a path, with the values needed for projection.
struct PathSegment {
    double x, y;              ///< where it begins
    double dx, dy;            ///< from there to its end
    double share_x, share_y;  ///< rise of a projection's share of the segment, 1/m
};

/// Segments [first, last) of a path.
struct SegmentRange {
    std::uint32_t first, last;
};

/// What locates positions along a FlowPath, by pointers: see there. It owns nothing.
struct PathField {
    double x_min = 0, y_min = 0, inverse_cell = 1;  ///< of the tables
    int columns = 0, rows = 0;
    double half_width = 0;  ///< of the corridor
    const PathSegment* segments = nullptr;
    const double* chainage = nullptr;       ///< m, where each segment begins, and the end
    const SegmentRange* around = nullptr;   ///< by segment: those that may be nearest to a position in one of its cells
    const std::int32_t* nearest = nullptr;  ///< segment to a cell's centre; -1: no part of the cell is in the corridor
    const float* bound = nullptr;

    /// Of a segment at the projection of `p` on it.
    struct Projection {
        double share;             ///< 0 to 1
        double distance_squared;  ///< m2
    };
    [[nodiscard]] static TALUS_DEVICE Projection project(const PathSegment& s, const PlanPoint& p) {
        const double share = std::clamp((p.x - s.x) * s.share_x + (p.y - s.y) * s.share_y, 0.0, 1.0);
        const double x = s.x + share * s.dx - p.x, y = s.y + share * s.dy - p.y;
        return {share, x * x + y * y};
    }

    [[nodiscard]] TALUS_DEVICE std::size_t cells() const {
        return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    }
    /// Index into the tables; cells() outside.
    [[nodiscard]] TALUS_DEVICE std::size_t cell_of(const PlanPoint& p) const {
        const double u = (p.x - x_min) * inverse_cell, v = (p.y - y_min) * inverse_cell;
        if (!(u >= 0 && v >= 0 && u < columns && v < rows)) return cells();  // NaN, too
        return static_cast<std::size_t>(static_cast<int>(v)) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(static_cast<int>(u));
    }
    [[nodiscard]] TALUS_DEVICE float chainage_bound(const PlanPoint& p) const {
        const std::size_t cell = cell_of(p);
        return cell < cells() ? bound[cell] : -1.0F;
    }
    [[nodiscard]] TALUS_DEVICE std::optional<PathPosition> locate(const PlanPoint& p) const {
        const std::size_t cell = cell_of(p);
        if (cell >= cells() || nearest[cell] < 0) return std::nullopt;

        // The cell's segment is nearest to its centre; the one nearest to this point may be slightly up or down the
        // path.
        const SegmentRange range = around[nearest[cell]];
        double least = std::numeric_limits<double>::infinity(), at = 0;
        for (std::uint32_t i = range.first; i < range.last; ++i) {
            const Projection q = project(segments[i], p);
            if (q.distance_squared >= least) continue;
            least = q.distance_squared;
            at = chainage[i] + q.share * (chainage[i + 1] - chainage[i]);
        }
        const double offset = std::sqrt(least);
        if (offset > half_width) return std::nullopt;
        return PathPosition{at, offset};
    }
};

/// The line along which debris is expected to run (the thalweg), and the chainage along it.
class FlowPath {
  public:
    FlowPath() = default;
    /// `points`: world, from the crown downstream, at least two. `corridor_width` in m.
    FlowPath(const std::vector<PlanPoint>& points, double corridor_width);

    [[nodiscard]] bool empty() const { return points_.empty(); }
    [[nodiscard]] const std::vector<PlanPoint>& points() const { return points_; }
    [[nodiscard]] double length() const { return chainage_.empty() ? 0 : chainage_.back(); }
    [[nodiscard]] double corridor_width() const { return corridor_width_; }

    /// Projection on the nearest part of the path, its ends included; empty outside the corridor. A table look-up and
    /// the few segments near it.
    [[nodiscard]] std::optional<PathPosition> locate(const PlanPoint& p) const { return field().locate(p); }

    /// An upper bound of the chainage by `locate`, less than 0 where that is empty: one table look-up, to skip
    /// positions far behind a front.
    [[nodiscard]] float chainage_bound(const PlanPoint& p) const { return field().chainage_bound(p); }

    /// For whoever locates many positions, or elsewhere: valid as long as the path.
    [[nodiscard]] PathField field() const {
        return {
            table_.x_min,          table_.y_min,     inverse_cell_,    table_.columns,          table_.rows,
            corridor_width_ / 2,   segments_.data(), chainage_.data(), segments_around_.data(), nearest_segment_.data(),
            chainage_bound_.data()};
    }

    /// A rectangle around every position whose `chainage_bound` is `chainage` or more; empty (maximum less than
    /// minimum) if there is none. One look-up.
    [[nodiscard]] Extent extent_beyond(double chainage) const;

    /// World plan position at a chainage, clamped to the path's ends.
    [[nodiscard]] PlanPoint point_at(double chainage) const;

  private:
    void fill_nearest_segment();
    void fill_chainage_bound();
    void fill_extent_beyond();
    /// The segments [first, last) that may be nearest to a position in a cell whose centre is nearest to `middle`.
    [[nodiscard]] SegmentRange find_segments_around(std::size_t middle) const;

    std::vector<PlanPoint> points_;
    std::vector<double> chainage_;
    std::vector<PathSegment> segments_;  // between one point and the next
    std::vector<SegmentRange> segments_around_;
    double corridor_width_ = 0;
    GridGeometry table_{0, 0, 1, 0, 0};
    double inverse_cell_ = 1;
    std::vector<std::int32_t> nearest_segment_;  // to the cell's centre; -1: no part of the cell is in the corridor
    std::vector<float> chainage_bound_;
    std::vector<Extent> extent_beyond_;  // by chainage in cells of the table
};

/// The smallest chainage of a corner of the outlines; empty: all lie outside the corridor.
[[nodiscard]] std::optional<double> first_chainage(const FlowPath& path, const std::vector<Polygon>& outlines);

/// Steepest descent (D8) from `start` over a sink-filled copy of the elevations, to the edge of the data, to a place
/// below which nothing can be reached (the sea, the bottom of a closed basin) or to `longest` metres. Sinks are filled
/// by priority flood (Barnes, Lehman, Mulla 2014). The steps from cell to cell are smoothed, because their zigzag would
/// add up to 8 % to the chainage. The first point is `start`; there are at least two. Errors: start outside the data.
[[nodiscard]] Result<std::vector<PlanPoint>> trace_flow_path(const Grid<float>& elevation, const PlanPoint& start,
                                                             double longest);

}  // namespace talus::terrain
