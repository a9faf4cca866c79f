#pragma once

#include <cmath>

namespace talus::observe {

/// Speed along the ground of horizontal velocities over its slopes.
[[nodiscard]] inline float speed_of(float u, float v, float slope_x, float slope_y) {
    const float w = u * slope_x + v * slope_y;
    return std::sqrt(u * u + v * v + w * w);
}

}  // namespace talus::observe
