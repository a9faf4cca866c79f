#pragma once

#include <functional>
#include <limits>

#include "core/grid.hpp"

namespace talus::terrain {

inline constexpr float nodata = std::numeric_limits<float>::quiet_NaN();

/// A grid with values from a function of x, y in the world.
inline Grid<float> make(const GridGeometry& g, const std::function<double(double, double)>& height) {
    Grid<float> grid(g);
    for (int r = 0; r < g.rows; ++r) {
        for (int c = 0; c < g.columns; ++c) {
            const PlanPoint p = g.centre(c, r);
            grid.at(c, r) = static_cast<float>(height(p.x, p.y));
        }
    }
    return grid;
}

}  // namespace talus::terrain
