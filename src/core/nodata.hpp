#pragma once

namespace talus {

/// What stands for NaN in files of rasters.
inline constexpr float nodata_in_files = -9999;

}  // namespace talus
