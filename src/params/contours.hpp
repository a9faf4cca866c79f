#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/hazard_maps.hpp"
#include "core/result.hpp"

namespace talus::params {

/// Maps of which contours can be asked for, by the names of their files: those of every run, and two that not every run
/// has.
inline constexpr auto contour_maps = [] {
    std::array<std::string_view, named_maps.size() + 2> keys = {};
    std::transform(named_maps.begin(), named_maps.end(), keys.begin(), [](const NamedMap& map) { return map.key; });
    keys[named_maps.size()] = "peak_thickness";
    keys[named_maps.size() + 1] = "erosion_depth";
    return keys;
}();

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
