#pragma once

#include <string>
#include <vector>

#include "core/geometry.hpp"

namespace talus::terrain {

/// A line across which discharge is recorded.
struct CrossSection {
    std::string name;
    std::vector<PlanPoint> line;  ///< world; debris that passes from its left to its right counts as positive
    double interval = 1;          ///< s, over which discharge is averaged
};

}  // namespace talus::terrain
