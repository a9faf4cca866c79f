#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

/// A raster band on square north-aligned cells, and the metadata of its file.
struct Raster {
    Grid<float> grid;  ///< NaN: no data
    Crs crs;
    std::string vertical_unit;           ///< "m", or as stated; "not stated"
    double nodata_share = 0;             ///< 0 to 1
    std::optional<double> nodata_value;  ///< as stored
    bool crs_assumed = false;            ///< the file states none: that of the terrain
};

/// Reads a band of any GDAL raster in a projected metric CRS. South-up rasters are turned, pixel-is-point is respected.
/// `extent` (in the raster's CRS) reads that part only; it must overlap the raster. Errors, each naming the file and,
/// where there is one, the command that corrects it: missing file, a folder, empty or truncated data, no such band, all
/// nodata, fewer than 2 x 2 cells, geographic or missing CRS, unit other than metre, rotated, cells not square.
/// `local`: it need not state a CRS, and must not state one that is not local.
[[nodiscard]] Result<Raster> read_terrain_raster(const std::string& file, int band, const std::optional<Extent>& extent,
                                                 bool local = false);

/// Reads a band of values (release thickness) that must be in the CRS of the terrain, and is taken to be if its file
/// states none (.asc cannot); otherwise as above.
[[nodiscard]] Result<Raster> read_value_raster(const std::string& file, const Crs& terrain_crs);

/// A map written by talus, to be laid over the terrain: as read_value_raster, but it may consist of nodata only.
[[nodiscard]] Result<Raster> read_map_raster(const std::string& file, const Crs& terrain_crs);

/// One band to write.
struct RasterBand {
    const Grid<float>* grid = nullptr;
    std::string description;                                      ///< "peak flow depth"
    std::string unit;                                             ///< "m"
    std::vector<std::pair<std::string, std::string>> metadata{};  ///< of the file, by key
};

/// Writes a single-band Cloud-Optimised GeoTIFF: float32, nodata -9999 for NaN, overviews, unit and description.
[[nodiscard]] Status write_cog(const std::string& file, const RasterBand& band, const Crs& crs);

}  // namespace talus::geo
