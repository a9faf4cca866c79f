#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
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
    [[nodiscard]] std::optional<PathPosition> locate(const PlanPoint& p) const;

    /// An upper bound of the chainage by `locate`, less than 0 where that is empty: one table look-up, to skip
    /// positions far behind a front.
    [[nodiscard]] float chainage_bound(const PlanPoint& p) const {
        const std::size_t cell = cell_of(p);
        return cell < chainage_bound_.size() ? chainage_bound_[cell] : -1.0F;
    }

    /// A rectangle around every position whose `chainage_bound` is `chainage` or more; empty (maximum less than
    /// minimum) if there is none. One look-up.
    [[nodiscard]] Extent extent_beyond(double chainage) const;

    /// World plan position at a chainage, clamped to the path's ends.
    [[nodiscard]] PlanPoint point_at(double chainage) const;

  private:
    /// Index into the tables; their size outside their extent.
    [[nodiscard]] std::size_t cell_of(const PlanPoint& p) const {
        const double u = (p.x - table_.x_min) * inverse_cell_, v = (p.y - table_.y_min) * inverse_cell_;
        if (!(u >= 0 && v >= 0 && u < table_.columns && v < table_.rows)) return nearest_segment_.size();  // NaN, too
        return table_.index(static_cast<int>(u), static_cast<int>(v));
    }
    void fill_nearest_segment();
    void fill_chainage_bound();
    void fill_extent_beyond();
    /// The segments [first, last) that may be nearest to a position in a cell whose centre is nearest to `middle`.
    [[nodiscard]] std::pair<std::size_t, std::size_t> find_segments_around(std::size_t middle) const;

    std::vector<PlanPoint> points_;
    std::vector<double> chainage_;
    std::vector<PathSegment> segments_;  // between one point and the next
    std::vector<std::pair<std::size_t, std::size_t>> segments_around_;
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
