#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace talus {

/// A coordinate in m for a sentence: to the decimetre, and short where it is far from everything: 1e300 would be three
/// hundred digits.
[[nodiscard]] inline std::string coordinate_text(double metres) {
    std::array<char, 32> text{};
    (void)std::snprintf(text.data(), text.size(), std::abs(metres) < 1e9 ? "%.1f" : "%.6g", metres);
    return text.data();
}

}  // namespace talus
