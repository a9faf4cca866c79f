#pragma once

#include <cmath>

namespace talus {

/// The greater of two values. NaN takes precedence: std::max would lose it.
[[nodiscard]] inline float max_or_nan(float a, float b) {
    return std::isnan(a) || b <= a ? a : b;
}

}  // namespace talus
