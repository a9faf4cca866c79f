#pragma once

#include <optional>
#include <string>

#include "core/result.hpp"

namespace talus::geo {

/// What a file holds, by the formats that GDAL knows.
enum class FileKind { raster, vector, other };

/// What a raster says about itself, whether or not it can serve as terrain; reads no cells.
struct RasterFacts {
    std::string format;  ///< "GTiff"
    int columns = 0, rows = 0;
    std::string crs;         ///< with its name; empty: none stated
    std::string metric_crs;  ///< "EPSG:32650": its own if that is metric and true to scale, else one that suits its
                             ///< place; empty: the place is not known
    std::string value_unit;  ///< as stated; empty: none
    /// Metres per unit of its heights, as far as it says: the unit of its values, else the vertical or else the
    /// horizontal one of its reference system.
    double height_unit = 1;
};
[[nodiscard]] Result<RasterFacts> raster_facts(const std::string& file);

/// What is to be mended of a raster, each as its user states it.
struct Mending {
    int epsg = 0;                           ///< the system that it is in; 0: as the file says
    bool local = false;                     ///< or that its coordinates are metres of its own, as those of a flume
    bool metric = false;                    ///< bring it onto square cells of RasterFacts::metric_crs
    std::optional<double> metres_per_unit;  ///< of its values
    std::optional<double> nodata;           ///< the value that marks missing data

    [[nodiscard]] bool any() const { return epsg != 0 || local || metric || metres_per_unit || nodata; }
};

/// Writes the first band, mended, as a GeoTIFF. Errors: no such system, no position, more than `most_cells` cells,
/// cannot be written; then nothing remains.
[[nodiscard]] Status repair_raster(const std::string& file, const std::string& to, const Mending& mending,
                                   double most_cells);

}  // namespace talus::geo
