#pragma once

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "observe/observation.hpp"

namespace talus::observe {

/// The greatest value of a map, and the centre of its cell. NaN: no cell has a value.
struct Peak {
    double value = never;
    PlanPoint at{never, never};
};

[[nodiscard]] Peak peak_of(const Grid<float>& map);

/// Of a run's maps.
struct Peaks {
    Peak depth;     ///< m
    Peak speed;     ///< m/s
    Peak pressure;  ///< Pa, dynamic
};

[[nodiscard]] Peaks measure_peaks(const HazardMaps& maps);

}  // namespace talus::observe
