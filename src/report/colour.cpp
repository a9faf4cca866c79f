#include "report/colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

namespace talus::report {
namespace {

using Linear = std::array<double, 3>;

// OKLab to linear sRGB and back (Ottosson 2020).
Linear to_linear(double l, double a, double b) {
    const double p = std::pow(l + 0.3963377774 * a + 0.2158037573 * b, 3);
    const double q = std::pow(l - 0.1055613458 * a - 0.0638541728 * b, 3);
    const double r = std::pow(l - 0.0894841775 * a - 1.2914855480 * b, 3);
    return {4.0767416621 * p - 3.3077115913 * q + 0.2309699292 * r,
            -1.2684380046 * p + 2.6097574011 * q - 0.3413193965 * r,
            -0.0041960863 * p - 0.7034186147 * q + 1.7076147010 * r};
}

bool displayable(const Linear& c) {
    return std::all_of(c.begin(), c.end(), [](double v) { return v >= -1e-4 && v <= 1 + 1e-4; });
}

std::uint8_t encode(double v) {
    v = std::clamp(v, 0.0, 1.0);
    const double s = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(s * 255));
}

double decode(std::uint8_t byte) {
    const double s = byte / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

}  // namespace

std::string Colour::hex() const {
    return fmt::format("#{:02x}{:02x}{:02x}", red, green, blue);
}

Colour colour_at(const Ramp& ramp, double share) {
    share = std::clamp(share, 0.0, 1.0);
    const double l = ramp.low_lightness + (ramp.high_lightness - ramp.low_lightness) * share;
    const double hue = (ramp.low_hue + (ramp.high_hue - ramp.low_hue) * share) * std::numbers::pi / 180;
    // Chroma peaks between the ends: very light and very dark colours have little chroma.
    double chroma =
        ramp.low_chroma + (ramp.high_chroma - ramp.low_chroma) * share + 0.05 * std::sin(std::numbers::pi * share);
    Linear c = to_linear(l, chroma * std::cos(hue), chroma * std::sin(hue));
    while (!displayable(c) && chroma > 0) {
        chroma -= 0.002;
        c = to_linear(l, chroma * std::cos(hue), chroma * std::sin(hue));
    }
    return {encode(c[0]), encode(c[1]), encode(c[2])};
}

double lightness(const Colour& colour) {
    const double r = decode(colour.red), g = decode(colour.green), b = decode(colour.blue);
    return 0.2104542553 * std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b) +
           0.7936177850 * std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b) -
           0.0040720468 * std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
}

int Classes::of(double value) const {
    if (std::isnan(value)) return -1;
    return static_cast<int>(std::upper_bound(breaks.begin(), breaks.end(), value) - breaks.begin()) - 1;
}

Classes fixed_classes(const std::vector<double>& breaks, double largest, const Ramp& ramp) {
    Classes classes;
    for (const double b : breaks) {
        if (!classes.breaks.empty() && !(b < largest)) break;
        classes.breaks.push_back(b);
    }
    const std::size_t n = classes.breaks.size();
    for (std::size_t k = 0; k < n; ++k) {
        classes.colours.push_back(colour_at(ramp, n == 1 ? 0.5 : static_cast<double>(k) / static_cast<double>(n - 1)));
    }
    return classes;
}

Classes even_classes(double largest, const Ramp& ramp) {
    std::vector<double> breaks = {0};
    if (largest > 0 && std::isfinite(largest)) {
        const double step = round_step(largest / 8);
        for (int k = 1; k * step < largest; ++k) breaks.push_back(k * step);
    }
    return fixed_classes(breaks, std::isfinite(largest) ? largest : 0, ramp);
}

Classes difference_classes(double usual) {
    constexpr std::array<Colour, 9> colours = {{{127, 59, 8},
                                                {190, 100, 10},
                                                {230, 150, 60},
                                                {250, 208, 150},
                                                {226, 226, 226},
                                                {166, 206, 232},
                                                {92, 160, 208},
                                                {40, 110, 175},
                                                {8, 48, 107}}};
    double outer = 1;
    if (usual > 0 && std::isfinite(usual)) {
        const double power = std::pow(10, std::floor(std::log10(usual)));
        outer = 10 * power;
        for (const double m : {5.0, 2.0, 1.0}) {
            if (usual <= m * power * (1 + 1e-9)) outer = m * power;
        }
    }
    Classes classes;
    classes.colours.assign(colours.begin(), colours.end());
    classes.breaks = {-std::numeric_limits<double>::infinity(),
                      -outer,
                      -outer / 2,
                      -outer / 4,
                      -outer / 10,
                      outer / 10,
                      outer / 4,
                      outer / 2,
                      outer};
    return classes;
}

double round_step(double value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const double power = std::pow(10, std::floor(std::log10(value)));
    for (const double m : {1.0, 2.0, 2.5, 5.0}) {
        if (value <= m * power * (1 + 1e-9)) return m * power;
    }
    return 10 * power;
}

}  // namespace talus::report
