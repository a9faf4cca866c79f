#pragma once

#include <string>

namespace talus::geo {

/// Versions of the libraries in use at run time: "3.6.2", "9.1.1".
[[nodiscard]] std::string gdal_version();
[[nodiscard]] std::string proj_version();

}  // namespace talus::geo
