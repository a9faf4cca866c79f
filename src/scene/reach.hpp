#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "terrain/release.hpp"
#include "terrain/terrain.hpp"

namespace talus::scene {

/// Lower than the travel angles of observed hillslope and channelised debris flows: the ground outside is not reached.
inline constexpr double travel_angle_deg = 11;

/// The ground that debris could reach: cells that stay below an energy line which falls by `tan(travel_angle)` per
/// metre of the shortest path from the release (the energy-line method of Heim 1932, with the path over reachable cells
/// instead of a straight line). `travel_angle` in radians. Returns the extent of those cells in world coordinates.
[[nodiscard]] Extent reachable_extent(const terrain::Terrain& terrain, const std::vector<terrain::Release>& releases,
                                      double travel_angle);

/// Cells that debris can reach, in blocks of cells, and the blocks around them.
struct ReachableGround {
    int block = 1;              ///< cells along its edge
    Grid<std::uint8_t> blocks;  ///< 1: reached; empty: all of the ground

    [[nodiscard]] bool holds(int column, int row) const;
    /// How many cells; nothing: all of them.
    [[nodiscard]] std::optional<double> cells() const;
};

/// By energy lines of that angle over the lowest ground of each block: too much rather than too little. Without a
/// release, all of it.
[[nodiscard]] ReachableGround reachable_ground(const terrain::Terrain& terrain,
                                               const std::vector<terrain::Release>& releases, double travel_angle);

}  // namespace talus::scene
