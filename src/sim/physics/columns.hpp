#pragma once

#include <cstdint>

#include "core/number.hpp"

/// How particles are counted in columns, from which the thickness of the flow follows (see flow_thickness()).
namespace talus::sim {

/// Shares of particles are counted in whole units, so that sums do not depend on the order of the particles.
inline constexpr float units_per_particle = 65536;

/// As std::floor, which is a call without SSE4.1.
[[nodiscard]] TALUS_DEVICE inline std::int64_t floor_to_int(double x) {
    const auto whole = static_cast<std::int64_t>(x);
    return whole - (static_cast<double>(whole) > x ? 1 : 0);
}

[[nodiscard]] TALUS_DEVICE inline std::uint32_t column_units(float share) {
    return static_cast<std::uint32_t>(floor_to_int(static_cast<double>(share * units_per_particle) + 0.5));
}

/// Calls f(column, row, share) for the four columns whose centres surround a place, each with its share by bilinear
/// interpolation. Columns are counted from the frame's origin; `inverse_width` of a column in 1/m.
template <class F>
TALUS_INLINE void for_each_column(float x, float y, double inverse_width, const F& f) {
    const double u = x * inverse_width - 0.5, v = y * inverse_width - 0.5;
    const std::int64_t column = floor_to_int(u), row = floor_to_int(v);
    const auto right = static_cast<float>(u - static_cast<double>(column)),
               upper = static_cast<float>(v - static_cast<double>(row));
    for (int dy = 0; dy < 2; ++dy) {
        for (int dx = 0; dx < 2; ++dx) {
            f(column + dx, row + dy, (dx == 1 ? right : 1 - right) * (dy == 1 ? upper : 1 - upper));
        }
    }
}

}  // namespace talus::sim
