#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "scene/zone.hpp"

namespace talus::twin {

/// Where a zone from a raster lies, as rectangles that do not overlap: at most `most`, for which cells of the terrain
/// are taken together, by twos, fours, ..., where half of them belong to the zone. Empty: the zone has outlines.
[[nodiscard]] std::vector<Extent> blocks_of(const scene::Zone& zone, const GridGeometry& terrain,
                                            std::size_t most = 2000);

}  // namespace talus::twin
