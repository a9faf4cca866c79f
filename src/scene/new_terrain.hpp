#pragma once

#include <string>

#include "geo/terrain_frame.hpp"
#include "scene/parse.hpp"

/// The terrain of a new scene: the part of a raster that matters.
namespace talus::scene {

/// Cells of the raster along an edge of a cell of `cell` m. Errors: it is finer, or no whole multiple.
[[nodiscard]] Result<int> coarsening(const std::string& file, const geo::TerrainFrame& frame, double cell);

/// The extent for a scene whose releases lie within `footprint`: all ground below an energy line of `travel_angle_deg`
/// from them (reach.hpp), and a margin, in whole cells of `factor` cells of the raster. Reads only as much of the
/// raster as it takes to know. Errors: as load_releases, and: debris can reach too many cells.
[[nodiscard]] Result<Extent> choose_extent(const ParsedScene& parsed, const geo::TerrainFrame& frame,
                                           const Extent& footprint, int factor);

}  // namespace talus::scene
