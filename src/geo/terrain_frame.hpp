#pragma once

#include <optional>
#include <string>

#include "geo/raster.hpp"

/// What is asked of a terrain raster beside its elevations.
namespace talus::geo {

/// A terrain raster before its cells are read.
struct TerrainFrame {
    Crs crs;
    GridGeometry geometry;      ///< of the whole raster
    bool eight_bit = false;     ///< its cells can hold 256 values
    bool holes_read_0 = false;  ///< blocks that were never written, or holes of the file system, and no nodata value
};

/// Errors as of read_terrain_raster, as far as they show without the cells; `local` as there.
[[nodiscard]] Result<TerrainFrame> read_terrain_frame(const std::string& file, int band, bool local = false);

/// As read_terrain_raster, on cells `factor` times as large: the mean of those that hold data, nodata where fewer than
/// half do. Coarse cells begin at the raster's south-west corner; what is left over in the north and east is dropped.
[[nodiscard]] Result<Raster> read_coarse_terrain(const std::string& file, int band, const std::optional<Extent>& extent,
                                                 int factor, bool local = false);

/// The command that writes a copy in which cells of `value`, in m, are nodata.
[[nodiscard]] std::string declare_nodata_command(const std::string& file, int band, double value);

/// The command that writes a copy with its elevations multiplied.
[[nodiscard]] std::string scale_command(const std::string& file, int band, double factor);

/// The command that writes a copy in which all cells below `value`, in m, are nodata.
[[nodiscard]] std::string cut_below_command(const std::string& file, int band, double value);

}  // namespace talus::geo
