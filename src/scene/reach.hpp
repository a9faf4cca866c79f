#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "terrain/release.hpp"
#include "terrain/terrain.hpp"

namespace talus {

/// The ground that debris could get to: cells that stay below an energy line which falls by `tan(travel_angle)` per
/// metre of the shortest way from the release (the energy-line method of Heim 1932, with the way taken over reachable
/// cells instead of straight). `travel_angle` in radians. Returns the extent of those cells in world coordinates.
[[nodiscard]] Extent reachable_extent(const Terrain& terrain, const std::vector<Release>& releases,
                                      double travel_angle);

}  // namespace talus
