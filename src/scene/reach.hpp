#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "terrain/release.hpp"
#include "terrain/terrain.hpp"

namespace talus::scene {

/// The ground that debris could reach: cells that stay below an energy line which falls by `tan(travel_angle)` per
/// metre of the shortest path from the release (the energy-line method of Heim 1932, with the path over reachable cells
/// instead of a straight line). `travel_angle` in radians. Returns the extent of those cells in world coordinates.
[[nodiscard]] Extent reachable_extent(const terrain::Terrain& terrain, const std::vector<terrain::Release>& releases,
                                      double travel_angle);

}  // namespace talus::scene
