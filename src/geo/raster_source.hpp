#pragma once

#include <optional>
#include <string>

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "core/result.hpp"
#include "geo/crs.hpp"

/// A raster file that has passed the checks on format and georeference. Not for other modules.
namespace talus::geo {

struct RasterSource {
    GDALDatasetUniquePtr data;
    GDALRasterBand* band = nullptr;
    int columns = 0, rows = 0;
    double x_min = 0, y_min = 0;  ///< south-west corner of the south-west cell
    double cell = 0;              ///< m
    bool first_row_north = true, first_column_west = true;
    Crs crs;
    bool crs_assumed = false;
    std::string value_unit;  ///< "m", as stated, or "not stated"
    double scale = 1, offset = 0;
    std::optional<double> nodata;  ///< as stored, before scale and offset
};

/// Opens a band of a raster on square north-aligned cells in a projected metric CRS; reads no cells yet. `otherwise`:
/// the CRS of a file that states none; without it that is an error.
[[nodiscard]] Result<RasterSource> open_raster(const std::string& file, int band, const Crs* otherwise = nullptr);

/// Of elevations. `local`: as for read_terrain_raster.
[[nodiscard]] Result<RasterSource> open_terrain(const std::string& file, int band, bool local);

/// Metres per unit of a name as rasters state it ("ft"); empty: not known.
[[nodiscard]] std::optional<double> metres_per(std::string name);

/// GDAL reads zeros where a raw file ends too early; detected by its size.
[[nodiscard]] Status check_raw_size(const std::string& file, GDALDataset& data);

/// The command that declares `value` as the nodata value of a file, given the name of its driver.
[[nodiscard]] std::string declare_nodata_command(const std::string& file, const std::string& driver, double value);

}  // namespace talus::geo
