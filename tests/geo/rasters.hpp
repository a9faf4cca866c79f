#pragma once

#include <optional>

#include "geo/raster.hpp"
#include "support/fixtures.hpp"

namespace talus::geo {

/// Values that tell a cell's column and row.
inline double pattern(int column, int row) {
    return 100 + column + 0.01 * row;
}

/// The Hong Kong 1980 Grid, as a file has it.
inline Crs hong_kong() {
    const test::TemporaryFolder folder;
    return read_terrain_raster(test::write_plane(folder.file("dem.tif")), 1, std::nullopt)->crs;
}

}  // namespace talus::geo
