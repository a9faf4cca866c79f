#pragma once

#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "terrain/buildings.hpp"
#include "terrain/terrain.hpp"

namespace talus::twin {

/// A wall along a line (world plan coordinates, two points or more): one solid of many short parts with mitred joints,
/// each with a roof `height` above the ground of its centre line, so that the crest follows the ground.
/// Errors: the line leaves the known ground, crosses itself, turns back, or has bends too close for the thickness.
[[nodiscard]] Result<Building> make_barrier(const Terrain& terrain, const std::string& name,
                                            const std::vector<PlanPoint>& line, double height, double thickness);

/// Length along the ground's plan, m.
[[nodiscard]] double length_of(const std::vector<PlanPoint>& line);

/// Whether the segments from `a` to `b` and from `c` to `d` have a point in common.
[[nodiscard]] bool segments_meet(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c, const PlanPoint& d);

/// Whether a closed ring touches or crosses itself, or has an edge of no length.
[[nodiscard]] bool meets_itself(const Ring& ring);

}  // namespace talus::twin
