#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "report/colour.hpp"

/// Pictures inside the report, as PNG in data URIs.
namespace talus::report {

/// Grey and opacity per pixel, from the top row down.
struct GreyImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;  ///< grey, alpha, grey, alpha, ...
};

/// A class index per pixel, from the top row down; 0 is transparent, k shows colours[k - 1].
struct ClassImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
    std::vector<Colour> colours;
};

/// Values for the page's read-out, 16 bit: red is the high and green the low byte of 1 + value / resolution; 0: none.
struct ValueImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;  ///< red, green, blue (0), ...
};

/// "data:image/png;base64,..."; empty images are errors.
[[nodiscard]] Result<std::string> png_uri(const GreyImage& image);
[[nodiscard]] Result<std::string> png_uri(const ClassImage& image);
[[nodiscard]] Result<std::string> png_uri(const ValueImage& image);

}  // namespace talus::report
