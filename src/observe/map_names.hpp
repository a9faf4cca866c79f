#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "observe/observation.hpp"

namespace talus::observe {

/// A map of a run, by the name that files, messages and other programs know it by.
struct NamedMap {
    std::string_view key;
    const char* title;
    const char* unit;   ///< of files and reports
    double factor = 1;  ///< from SI to `unit`
    int decimals = 1;   ///< in that unit, of a single value
    Grid<float> HazardMaps::*grid = nullptr;
};

/// The maps that every run has, in the order in which they are written. One that is added here is in the products, the
/// reports, the records of ensembles and the live twin. tests/report/map_names_test.cpp says which lists of other
/// languages need it.
inline constexpr std::array named_maps = {
    NamedMap{"peak_depth", "Peak depth", "m", 1, 1, &HazardMaps::peak_depth},
    NamedMap{"peak_speed", "Peak speed", "m/s", 1, 1, &HazardMaps::peak_speed},
    NamedMap{"peak_pressure", "Peak dynamic pressure", "kPa", 1e-3, 0, &HazardMaps::peak_pressure},
    NamedMap{"arrival_time", "Arrival time", "s", 1, 1, &HazardMaps::arrival_time},
    NamedMap{"deposit_depth", "Deposit depth", "m", 1, 1, &HazardMaps::deposit_depth},
};

/// nullptr: none of that name.
[[nodiscard]] constexpr const NamedMap* find_map(std::string_view key) {
    for (const NamedMap& map : named_maps) {
        if (map.key == key) return &map;
    }
    return nullptr;
}

/// Names of layers: `before`, those of the maps, `after`.
[[nodiscard]] inline std::vector<std::string_view> map_keys(std::string_view before, std::string_view after = {}) {
    std::vector<std::string_view> keys{before};
    for (const NamedMap& map : named_maps) keys.push_back(map.key);
    if (!after.empty()) keys.push_back(after);
    return keys;
}

}  // namespace talus::observe
