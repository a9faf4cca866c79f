#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"

namespace talus {

/// The outlines of the cells above zero, along their edges, with holes; cells that only touch in a corner are apart. By
/// GDAL. Empty: there is no such cell.
[[nodiscard]] Result<std::vector<Polygon>> outlines_above_zero(const Grid<float>& values);

}  // namespace talus
