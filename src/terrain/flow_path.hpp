#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"

namespace talus {

/// Where a plan position lies relative to the flow path.
struct PathPosition {
    double chainage;  ///< horizontal distance along the path from its first point, m
    double offset;    ///< distance from the path, m
};

/// The line along which debris is expected to run (the thalweg), and the chainage along it.
class FlowPath {
  public:
    FlowPath() = default;
    /// `points`: world, from the crown downstream, at least two. `corridor_width` in m.
    FlowPath(std::vector<PlanPoint> points, double corridor_width);

    [[nodiscard]] bool empty() const { return points_.empty(); }
    [[nodiscard]] const std::vector<PlanPoint>& points() const { return points_; }
    [[nodiscard]] double length() const { return chainage_.empty() ? 0 : chainage_.back(); }
    [[nodiscard]] double corridor_width() const { return corridor_width_; }

    /// Projection on the nearest part of the path, its ends included; nothing outside the corridor. A table look-up and
    /// the few segments near it.
    [[nodiscard]] std::optional<PathPosition> locate(const PlanPoint& p) const;

    /// World plan position at a chainage, clamped to the path's ends.
    [[nodiscard]] PlanPoint point_at(double chainage) const;

  private:
    std::vector<PlanPoint> points_;
    std::vector<double> chainage_;
    double corridor_width_ = 0;
    Grid<std::int32_t> nearest_segment_;  // to the cell's centre; -1: no part of the cell is in the corridor
};

/// Steepest descent (D8) from `start` over a sink-filled copy of the elevations, to the edge of the data, to where
/// nothing lower can be reached (the sea, the bottom of a basin that the data close) or to `longest` metres. Sinks are
/// filled by priority flood (Barnes, Lehman, Mulla 2014). The steps from cell to cell are smoothed, because their
/// zigzag would add up to 8 % to the chainage. The first point is `start`; there are at least two.
/// Errors: start outside the data.
[[nodiscard]] Result<std::vector<PlanPoint>> trace_flow_path(const Grid<float>& elevation, const PlanPoint& start,
                                                             double longest);

}  // namespace talus
