#pragma once

#include <functional>

#include "core/geometry.hpp"
#include "core/grid.hpp"

namespace talus::scene {

/// Where two polygons cover the same ground.
struct Overlap {
    double area = 0;  ///< m2
    PlanPoint place;  ///< a point in it
};

/// Area common to both by exact cuts along 2000 lines: right to about 0.1 %, whatever the rings look like, and zero for
/// polygons that only share edges.
[[nodiscard]] Overlap overlap_of(const Polygon& a, const Polygon& b);

/// Whether the overlap is more than the slivers that digitising and reprojection leave between neighbours.
[[nodiscard]] bool is_true_overlap(const Overlap& overlap, const Polygon& a, const Polygon& b);

/// Calls `visit` at points inside the polygon, `step` apart (coarser beyond 2000 lines); at least at one.
void for_each_inside(const Polygon& polygon, double step, const std::function<void(const PlanPoint&)>& visit);

/// Calls `visit(column, row)` for every cell of the grid whose centre lies inside the polygon.
void for_each_cell_inside(const Polygon& polygon, const GridGeometry& grid,
                          const std::function<void(int column, int row)>& visit);

/// Calls `visit` along all rings, corners included, at most `step` apart.
void for_each_on_rings(const Polygon& polygon, double step, const std::function<void(const PlanPoint&)>& visit);

}  // namespace talus::scene
