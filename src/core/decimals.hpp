#pragma once

#include <algorithm>
#include <cmath>

namespace talus {

/// Decimals with which lengths in m, or volumes in m3, are printed beside each other of which the largest is `size`:
/// `least` in the field; where `size` is below 10, as in a laboratory, its three significant digits if these are more.
[[nodiscard]] inline int decimals_for(double size, int least) {
    constexpr int most = 9;
    const double magnitude = std::abs(size);
    if (!(magnitude > 0) || !(magnitude < 10)) return least;
    return std::clamp(2 - static_cast<int>(std::floor(std::log10(magnitude))), least, most);
}

}  // namespace talus
