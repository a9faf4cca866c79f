#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "depth/solver.hpp"

namespace talus::test {

inline constexpr double gravity = 9.80665;

using PlanFunction = std::function<double(double, double)>;

/// Values of a function at cell centres; the corner is at the origin.
template <class T = double>
Grid<T> grid_of(int columns, int rows, double cell, const PlanFunction& f) {
    Grid<T> grid({0, 0, cell, columns, rows});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const PlanPoint p = grid.geometry.centre(column, row);
            grid.at(column, row) = static_cast<T>(f(p.x, p.y));
        }
    }
    return grid;
}

inline void advance_until(depth::Solver& solver, double time) {
    while (solver.time() < time - 1e-9) {
        const Status stepped = solver.advance(std::min(0.5, time - solver.time()));
        ASSERT_TRUE(stepped.ok());
    }
}

/// Whether every cell has its depth of the start, to the bit, and no velocity.
inline bool as_at_start(const depth::Solver& solver, const Grid<float>& start) {
    for (int row = 0; row < start.geometry.rows; ++row) {
        for (int column = 0; column < start.geometry.columns; ++column) {
            if (solver.depth_at(column, row) != start.at(column, row)) return false;
            if (solver.u_at(column, row) != 0 || solver.v_at(column, row) != 0) return false;
        }
    }
    return true;
}

}  // namespace talus::test
