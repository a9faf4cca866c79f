#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/ramp.hpp"

/// Colours and class breaks of the report's maps.
namespace talus::report {

struct Colour {
    std::uint8_t red = 0, green = 0, blue = 0;

    [[nodiscard]] std::string hex() const;
    friend bool operator==(const Colour&, const Colour&) = default;
};

/// `share`: 0 (low end) to 1. Chroma is reduced where sRGB cannot show it; lightness is kept.
[[nodiscard]] Colour colour_at(const Ramp& ramp, double share);

/// Lightness in OKLab, 0 (black) to 1 (white).
[[nodiscard]] double lightness(const Colour& colour);

/// Values between breaks[k] and breaks[k + 1] are of class k; the last class is open upward.
struct Classes {
    std::vector<double> breaks;   ///< lower limit of each class, ascending
    std::vector<Colour> colours;  ///< one per class

    /// -1: below the lowest break or NaN.
    [[nodiscard]] int of(double value) const;
};

/// Classes from a fixed list of breaks, cut off above `largest` so that the highest class occurs.
[[nodiscard]] Classes fixed_classes(const std::vector<double>& breaks, double largest, const Ramp& ramp);

/// Classes of equal round width from 0, at most about eight.
[[nodiscard]] Classes even_classes(double largest, const Ramp& ramp);

/// Classes of differences around 0, as wide below as above: blue above, orange below (both also with colour blindness),
/// grey up to a tenth. The outer limits are the number of 1, 2, 5, 10, ... at or above `usual`.
[[nodiscard]] Classes difference_classes(double usual);

/// The round number (1, 2, 2.5 or 5 times a power of ten) at or above `value`.
[[nodiscard]] double round_step(double value);

}  // namespace talus::report
