#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"

namespace talus::geo {

/// A line of equal elevation, or of another quantity; closed where it ends at its start.
struct Contour {
    double elevation = 0;  ///< m, or the quantity's value
    std::vector<PlanPoint> points;
};

/// Contour lines at whole multiples of `interval` up to the edges of the grid, by GDAL. None where no cell has a value.
[[nodiscard]] std::vector<Contour> contours(const Grid<float>& elevation, double interval);

/// The same at given levels, in their order.
[[nodiscard]] std::vector<Contour> contours(const Grid<float>& values, const std::vector<double>& levels);

}  // namespace talus::geo
