#include "terrain/terrain.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace talus {
namespace {

/// Slope between the neighbours of a node, or on one side where the other has no data; 0 where neither has.
float difference(float before, float here, float after, float inverse_cell) {
    if (!std::isnan(before) && !std::isnan(after)) return (after - before) * 0.5F * inverse_cell;
    if (!std::isnan(after)) return (after - here) * inverse_cell;
    if (!std::isnan(before)) return (here - before) * inverse_cell;
    return 0;
}

}  // namespace

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

    slope_x_.resize(height_.size());
    slope_y_.resize(height_.size());
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const std::size_t i = g.index(column, row);
            const float west = column > 0 ? height_[i - 1] : none;
            const float east = column < last_column_ ? height_[i + 1] : none;
            const float south = row > 0 ? height_[i - stride_] : none;
            const float north = row < last_row_ ? height_[i + stride_] : none;
            slope_x_[i] = difference(west, height_[i], east, inverse_cell_);
            slope_y_[i] = difference(south, height_[i], north, inverse_cell_);
        }
    }
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
