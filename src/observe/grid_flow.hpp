#pragma once

#include <cmath>

#include "core/number.hpp"
#include "depth/solver.hpp"

namespace talus::observe {

/// Speed of horizontal velocities along the ground and of the climb of flight.
template <class Real>
[[nodiscard]] TALUS_INLINE Real speed_of(const Real& u, const Real& v, const Real& slope_x, const Real& slope_y,
                                         const Real& climb) {
    using std::sqrt;
    const Real w = u * slope_x + v * slope_y + climb;
    return sqrt(u * u + v * v + w * w);
}
[[nodiscard]] inline float speed_of(const depth::Solver& solver, int column, int row) {
    return speed_of(solver.u_at(column, row), solver.v_at(column, row), solver.slope_x_at(column, row),
                    solver.slope_y_at(column, row), solver.climb_at(column, row));
}
[[nodiscard]] inline float speed_of(const depth::CellRow& row, int k) {
    return speed_of(row.u[k], row.v[k], row.slope_x[k], row.slope_y[k], row.climb == nullptr ? 0.0F : row.climb[k]);
}

}  // namespace talus::observe
