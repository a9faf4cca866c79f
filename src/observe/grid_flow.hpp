#pragma once

#include <algorithm>
#include <cmath>

#include "depth/solver.hpp"

namespace talus::observe {

/// Speed of horizontal velocities along the ground and of the climb of flight.
[[nodiscard]] inline float speed_of(float u, float v, float slope_x, float slope_y, float climb) {
    const float w = u * slope_x + v * slope_y + climb;
    return std::sqrt(u * u + v * v + w * w);
}
[[nodiscard]] inline float speed_of(const depth::Solver& solver, int column, int row) {
    return speed_of(solver.u_at(column, row), solver.v_at(column, row), solver.slope_x_at(column, row),
                    solver.slope_y_at(column, row), solver.climb_at(column, row));
}
[[nodiscard]] inline float speed_of(const depth::CellRow& row, int k) {
    return speed_of(row.u[k], row.v[k], row.slope_x[k], row.slope_y[k], row.climb == nullptr ? 0 : row.climb[k]);
}

/// Calls f(k) for every k below `count` for which holds(k). Where that is true of few, sixteen of the others cost no
/// more than a look at their values.
template <class Holds, class F>
void for_each_of_few(int count, const Holds& holds, const F& f) {
    constexpr int strip = 16;
    for (int first = 0; first < count; first += strip) {
        const int last = std::min(first + strip, count);
        int found = 0;
        for (int k = first; k < last; ++k) found += holds(k) ? 1 : 0;
        for (int k = first; k < last && found > 0; ++k) {
            if (holds(k)) f(k);
        }
    }
}

/// Calls f(k) for every cell first + k of a row with debris deeper than `limit`, m.
template <class F>
void for_each_deeper(const depth::CellRow& row, float limit, const F& f) {
    for_each_of_few(
        row.last - row.first, [&](int k) { return row.depth[k] > limit; }, f);
}

}  // namespace talus::observe
