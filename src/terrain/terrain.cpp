#include "terrain/terrain.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace talus {

Terrain::Terrain(Grid<float> elevation) : elevation_(std::move(elevation)) {
    const GridGeometry& g = elevation_.geometry;
    assert(g.columns >= 2 && g.rows >= 2 && g.cell > 0 && elevation_.values.size() == g.size());

    float lowest = std::numeric_limits<float>::infinity();
    for (const float z : elevation_.values) {
        if (z < lowest) lowest = z;  // false for NaN
    }
    const Extent extent = g.extent();
    frame_.origin = {(extent.x_min + extent.x_max) / 2, (extent.y_min + extent.y_max) / 2,
                     std::isfinite(lowest) ? lowest : 0.0};

    height_.resize(elevation_.values.size());
    std::transform(elevation_.values.begin(), elevation_.values.end(), height_.begin(),
                   [&](float z) { return static_cast<float>(z - frame_.origin.z); });
    stride_ = static_cast<std::size_t>(g.columns);
    last_column_ = g.columns - 1;
    last_row_ = g.rows - 1;
    // From the cell counts and not from the world origin: exact in float for the usual cell sizes.
    x_first_ = static_cast<float>(-0.5 * last_column_ * g.cell);
    y_first_ = static_cast<float>(-0.5 * last_row_ * g.cell);
    inverse_cell_ = static_cast<float>(1 / g.cell);
}

double Terrain::elevation_at(const PlanPoint& p) const {
    const double x = p.x - frame_.origin.x, y = p.y - frame_.origin.y;
    if (!covers(x, y)) return std::numeric_limits<double>::quiet_NaN();
    return sample(x, y).height + frame_.origin.z;
}

double Terrain::slope_cosine_at(const PlanPoint& p) const {
    const double x = p.x - frame_.origin.x, y = p.y - frame_.origin.y;
    if (!covers(x, y)) return std::numeric_limits<double>::quiet_NaN();
    return sample(x, y).normal.z;
}

}  // namespace talus
