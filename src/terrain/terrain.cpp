#include "terrain/terrain.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace talus {
namespace {

/// Rise over one cell at a node between its neighbours: central, but level at a summit or a bottom and at most twice
/// that of either side. Where one side has no data the other's; 0 where neither has.
float rise(float before, float here, float after) {
    const float back = here - before, ahead = after - here;
    if (std::isnan(back)) return std::isnan(ahead) ? 0 : ahead;
    if (std::isnan(ahead)) return back;
    if (back * ahead <= 0) return 0;
    const float most = 2 * std::min(std::abs(back), std::abs(ahead));
    return std::clamp((back + ahead) / 2, -most, most);
}

}  // namespace

Terrain::Terrain(Grid<float> elevation) : elevation_(std::make_shared<const Grid<float>>(std::move(elevation))) {
    const GridGeometry& g = elevation_->geometry;
    const std::vector<float>& heights = elevation_->values;
    assert(g.columns >= 2 && g.rows >= 2 && g.cell > 0 && heights.size() == g.size());

    float lowest = std::numeric_limits<float>::infinity();
    for (const float z : heights) {
        if (z < lowest) lowest = z;  // false for NaN
    }
    const Extent extent = g.extent();
    frame_.origin = {(extent.x_min + extent.x_max) / 2, (extent.y_min + extent.y_max) / 2,
                     std::isfinite(lowest) ? lowest : 0.0};

    const auto local = [&](std::size_t i) { return static_cast<float>(heights[i] - frame_.origin.z); };
    stride_ = g.columns;
    last_column_ = g.columns - 1;
    last_row_ = g.rows - 1;
    // From the cell counts and not from the world origin: exact in float for the usual cell sizes.
    x_first_ = static_cast<float>(-0.5 * last_column_ * g.cell);
    y_first_ = static_cast<float>(-0.5 * last_row_ * g.cell);
    inverse_cell_ = static_cast<float>(1 / g.cell);

    const auto stride = static_cast<std::size_t>(stride_);
    const auto nodes = std::make_shared<Quad[]>(heights.size());
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const std::size_t i = g.index(column, row);
            const float west = column > 0 ? local(i - 1) : none, east = column < last_column_ ? local(i + 1) : none;
            const float south = row > 0 ? local(i - stride) : none, north = row < last_row_ ? local(i + stride) : none;
            nodes[i] = {local(i), rise(west, local(i), east), rise(south, local(i), north), 0};
        }
    }
    nodes_ = nodes;
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
