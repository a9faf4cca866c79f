#pragma once

#include <vector>

#include "core/geometry.hpp"

namespace talus::geo {

/// The parts of a line within a rectangle (Liang and Barsky 1984).
[[nodiscard]] std::vector<std::vector<PlanPoint>> clip_line(const std::vector<PlanPoint>& line, const Extent& to);

/// The part of a ring within a rectangle (Sutherland and Hodgman 1974): one ring, which may run along the edges of the
/// rectangle where it leaves and comes back; empty: nothing is inside.
[[nodiscard]] Ring clip_ring(const Ring& ring, const Extent& to);

}  // namespace talus::geo
