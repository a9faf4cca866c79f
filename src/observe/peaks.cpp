#include "observe/peaks.hpp"

#include <cmath>

namespace talus::observe {

Peak peak_of(const Grid<float>& map) {
    Peak peak;
    for (int row = 0; row < map.geometry.rows; ++row) {
        for (int column = 0; column < map.geometry.columns; ++column) {
            const double value = map.at(column, row);
            if (std::isnan(value) || value <= peak.value) continue;
            peak = {value, map.geometry.centre(column, row)};
        }
    }
    return peak;
}

Peaks measure_peaks(const HazardMaps& maps) {
    return {peak_of(maps.peak_depth), peak_of(maps.peak_speed), peak_of(maps.peak_pressure)};
}

}  // namespace talus::observe
