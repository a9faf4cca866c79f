#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"

/// Rasters over time, on the cells of one grid.
namespace talus::geo {

/// One quantity. Its values are read while they are written: they need not fit into memory.
struct RasterSeries {
    std::string name;         ///< "depth"
    std::string description;  ///< "flow depth"
    std::string unit;         ///< "m"
    /// Gives a row of a frame, south first, from west to east; NaN: no debris.
    std::function<Status(std::size_t frame, int row, float* values)> read;
};

/// What all quantities have in common.
struct SeriesFile {
    GridGeometry geometry;
    std::vector<double> times;  ///< s, rising
    Crs crs;
    std::vector<std::pair<std::string, std::string>> metadata;  ///< of the file, by key
};

/// Writes a Cloud-Optimised GeoTIFF with a band per frame, as write_cog(); bands are described by their times.
[[nodiscard]] Status write_cog_series(const std::string& file, const SeriesFile& series, const RasterSeries& quantity);

/// Writes a NetCDF-4 file after the CF conventions 1.8: `quantities` over time, y and x, `terrain` over y and x, their
/// reference system. Times are seconds since an arbitrary date, as programs that show them require one.
[[nodiscard]] Status write_netcdf_series(const std::string& file, const SeriesFile& series, const Grid<float>& terrain,
                                         const std::vector<RasterSeries>& quantities);

}  // namespace talus::geo
