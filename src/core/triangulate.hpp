#pragma once

#include <array>
#include <vector>

#include "core/geometry.hpp"

namespace talus {

/// Corners in counterclockwise order.
using PlanTriangle = std::array<PlanPoint, 3>;

/// Cuts a polygon into triangles between its own corners by clipping ears (Meisters 1975, "Polygons have ears"), after
/// each hole was joined to the outline by a cut. Rings may run either way round. Of an outline that crosses itself the
/// triangles are some that end. Effort rises with the square of the corners: for footprints.
[[nodiscard]] std::vector<PlanTriangle> triangulate(const Polygon& polygon);

}  // namespace talus
