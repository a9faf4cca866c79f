#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "report/image.hpp"

/// Shaded relief for the report's maps.
namespace talus::report {

/// The cells of `grid` whose centres lie within `extent`, plus one on each side where it exists; at most `longest_side`
/// cells a side (then every n-th cell, its value the mean of the cells around it that have one).
[[nodiscard]] Grid<float> crop(const Grid<float>& grid, const Extent& extent, int longest_side);

/// Shaded relief of `extent`, lit from the north-west with some light from the west and north, `pixels_per_metre` fine.
/// Slopes after Horn (1981), "Hill shading and the reflectance map". Transparent where there is no elevation.
[[nodiscard]] GreyImage hillshade(const Grid<float>& elevation, const Extent& extent, double pixels_per_metre);

/// Elevation interpolated between cell centres with the weights of those that have a value; NaN where their total
/// weight is below one half.
[[nodiscard]] double interpolate(const Grid<float>& grid, const PlanPoint& p);

}  // namespace talus::report
