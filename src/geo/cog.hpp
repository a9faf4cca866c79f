#pragma once

#include <string>

#include "core/result.hpp"
#include "geo/gdal.hpp"

/// Shared by the writers of rasters. Not for other modules.
namespace talus::geo {

/// Copies a data set into a Cloud-Optimised GeoTIFF with overviews. A full disk and all else is an error, and leaves
/// no file. `block`: edge of its tiles, cells.
[[nodiscard]] Status copy_to_cog(const std::string& file, GDALDataset& source, GdalMessages& messages, int block = 512);

}  // namespace talus::geo
