#pragma once

#include <string>

#include "core/result.hpp"

/// File names as people give them: a layer behind the name, a file in an archive.
namespace talus::geo {

struct LayerOfFile {
    std::string file;
    std::string layer;  ///< empty: none is named
};

/// Splits "map.gpkg|layername=scar", as QGIS names a layer. A file whose name holds a bar is itself. Errors: something
/// else behind the bar, such as |layerid=0.
[[nodiscard]] Result<LayerOfFile> split_layer(const std::string& name);

/// Whether it is a name of GDAL's and no path, such as NETCDF:"file.nc":band or /vsizip/...
[[nodiscard]] bool is_gdal_name(const std::string& name);

/// The file on disk that a name leads to, without layer and place in an archive: "dem.zip/valley.tif" is in "dem.zip".
/// Names of GDAL's, such as /vsizip/dem.zip, are left as they are.
[[nodiscard]] std::string file_on_disk(const std::string& name);

/// The name by which GDAL reads a file in an archive: "dem.zip", where it holds one data set of the kind (`flags`:
/// GDAL_OF_RASTER or GDAL_OF_VECTOR; `kind`: "raster"), "dem.zip/valley/dem.tif" and "dem.tif.gz". Any other name is
/// left as it is. Errors: no such data set in the archive, or several (names them), or one that may name other files.
[[nodiscard]] Result<std::string> name_for_gdal(const std::string& file, unsigned flags, const std::string& kind);

}  // namespace talus::geo
