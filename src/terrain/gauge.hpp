#pragma once

#include <limits>
#include <string>

#include "core/geometry.hpp"

namespace talus::terrain {

/// A place at which depth and speed are recorded.
struct Gauge {
    std::string name;
    PlanPoint at;                                                ///< world
    double chainage = std::numeric_limits<double>::quiet_NaN();  ///< m along the flow path; NaN: given as a place
};

}  // namespace talus::terrain
