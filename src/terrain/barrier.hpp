#pragma once

#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "terrain/buildings.hpp"
#include "terrain/terrain.hpp"

namespace talus::terrain {

/// A wall or a net along a line: one solid of many short parts with mitred joints, each with a roof of its own, so that
/// the crest follows the ground (or is level). In an opening the roof is the sill; without a sill there is no solid.
/// Errors: the line leaves the known ground, crosses itself, turns back, or has bends too close for the thickness;
/// openings that overlap, lie beyond the line's ends or have a sill as high as the crest; a crest below all ground.
[[nodiscard]] Result<Building> make_barrier(const Terrain& terrain, const std::string& name,
                                            const params::BarrierSpec& shape);

/// Length along the ground's plan, m.
[[nodiscard]] double length_of(const std::vector<PlanPoint>& line);

/// Whether the segments from `a` to `b` and from `c` to `d` have a point in common.
[[nodiscard]] bool segments_meet(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c, const PlanPoint& d);

/// Whether a closed ring touches or crosses itself, or has an edge of no length.
[[nodiscard]] bool meets_itself(const Ring& ring);

}  // namespace talus::terrain
