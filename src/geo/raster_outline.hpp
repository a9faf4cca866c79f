#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"

namespace talus::geo {

/// The outlines of the cells above zero, along their edges, with holes; cells that touch only at a corner are separate.
/// By GDAL. Empty: there is no such cell.
[[nodiscard]] Result<std::vector<Polygon>> outlines_above_zero(const Grid<float>& values);

/// The cells of one class.
struct ClassOutline {
    std::size_t number = 0;  ///< 1, 2, ...
    std::vector<Polygon> polygons;
    double area = 0;  ///< m2
};

/// The outlines of the cells with the values 1, 2, ... `count`, of each that occurs.
[[nodiscard]] Result<std::vector<ClassOutline>> class_outlines(const Grid<float>& classes, std::size_t count);

}  // namespace talus::geo
