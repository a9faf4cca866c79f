#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace talus::params {

/// Maps of which contours can be asked for, by the names of their files.
inline constexpr std::array contour_maps = {"peak_depth",    "peak_speed",     "peak_pressure", "arrival_time",
                                            "deposit_depth", "peak_thickness", "erosion_depth"};

/// Contours of a map.
struct MapContours {
    std::string map;
    std::vector<double> values;  ///< in the unit of the map's file, ascending, none twice
};

/// Of "peak_depth=0.5,1,2". Errors: no such map; values that are not numbers above 0.
[[nodiscard]] Result<MapContours> contours_of(std::string_view text);

/// The same of several texts, one entry per map. Errors: as above.
[[nodiscard]] Result<std::vector<MapContours>> contours_of(const std::vector<std::string>& texts);

}  // namespace talus::params
