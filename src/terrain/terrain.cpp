#include "terrain/terrain.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace talus::terrain {
namespace {

/// Rise over one cell at a node between its neighbours: central, but zero at a summit or a bottom and at most twice
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

Terrain::Terrain(Grid<float> elevation) : elevation_(std::make_shared<Grid<float>>(std::move(elevation))) {
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

    field_.stride = g.columns;
    field_.last_column = g.columns - 1;
    field_.last_row = g.rows - 1;
    // From the cell counts and not from the world origin: exact in float for the usual cell sizes.
    field_.x_first = static_cast<float>(-0.5 * field_.last_column * g.cell);
    field_.y_first = static_cast<float>(-0.5 * field_.last_row * g.cell);
    field_.inverse_cell = static_cast<float>(1 / g.cell);

    nodes_ = std::shared_ptr<Quad[]>(new Quad[heights.size()]());
    field_.nodes = nodes_.get();
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) nodes_[g.index(column, row)] = make_node(column, row);
    }
    continue_into_nodata();
}

Quad Terrain::make_node(int column, int row) const {
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    const auto local = [&](int c, int r) {
        if (c < 0 || r < 0 || c > field_.last_column || r > field_.last_row) return none;
        return static_cast<float>(elevation_->at(c, r) - frame_.origin.z);
    };
    const float here = local(column, row);
    if (std::isnan(here)) return {none, 0, 0, none};
    return {here, rise(local(column - 1, row), here, local(column + 1, row)),
            rise(local(column, row - 1), here, local(column, row + 1)), 0};
}

/// Ring by ring around the data, each cell takes the mean of the planes of its neighbours nearer to data.
void Terrain::continue_into_nodata() {
    const GridGeometry& g = elevation_->geometry;
    constexpr float waiting = std::numeric_limits<float>::infinity();
    const auto for_each_neighbour = [&](std::size_t cell, const auto& f) {
        const auto columns = static_cast<std::size_t>(g.columns);
        const int column = static_cast<int>(cell % columns), row = static_cast<int>(cell / columns);
        if (column > 0) f(cell - 1, 1, 0);
        if (column < field_.last_column) f(cell + 1, -1, 0);
        if (row > 0) f(cell - columns, 0, 1);
        if (row < field_.last_row) f(cell + columns, 0, -1);
    };
    std::vector<std::size_t> ring, next;
    const auto add_unreached = [&](std::size_t cell) {
        for_each_neighbour(cell, [&](std::size_t other, int, int) {
            if (!std::isnan(nodes_[other][0])) return;
            nodes_[other][0] = waiting;
            next.push_back(other);
        });
    };
    for (std::size_t cell = 0; cell < g.size(); ++cell) {
        if (!std::isnan(nodes_[cell][3])) add_unreached(cell);
    }
    std::vector<Quad> planes;
    while (!next.empty()) {
        ring.swap(next);
        next.clear();
        planes.clear();
        for (const std::size_t cell : ring) {
            Quad plane{};
            float known = 0;
            for_each_neighbour(cell, [&](std::size_t other, int east, int north) {
                const Quad& from = nodes_[other];
                if (!std::isfinite(from[0])) return;
                plane[0] += from[0] + static_cast<float>(east) * from[1] + static_cast<float>(north) * from[2];
                plane[1] += from[1];
                plane[2] += from[2];
                ++known;
            });
            planes.push_back({plane[0] / known, plane[1] / known, plane[2] / known, nodes_[cell][3]});
        }
        for (std::size_t k = 0; k < ring.size(); ++k) nodes_[ring[k]] = planes[k];
        for (const std::size_t cell : ring) add_unreached(cell);
    }
}

std::size_t Terrain::cell_at(float x, float y) const {
    const auto nearest = [this](float along, float first, int last) {
        return std::clamp(static_cast<int>(std::lround((along - first) * field_.inverse_cell)), 0, last);
    };
    return elevation_->geometry.index(nearest(x, field_.x_first, field_.last_column),
                                      nearest(y, field_.y_first, field_.last_row));
}

double Terrain::slope_cosine_of(std::size_t cell) const {
    const double east = nodes_[cell][1] * field_.inverse_cell, north = nodes_[cell][2] * field_.inverse_cell;
    return 1 / std::sqrt(1 + east * east + north * north);
}

void Terrain::set_elevation(std::size_t cell, float elevation) {
    if (elevation_.use_count() > 1 || nodes_.use_count() > 1) {
        const std::size_t cells = elevation_->values.size();
        elevation_ = std::make_shared<Grid<float>>(*elevation_);
        const std::shared_ptr<Quad[]> nodes(new Quad[cells]());
        std::copy_n(nodes_.get(), cells, nodes.get());
        nodes_ = nodes;
        field_.nodes = nodes_.get();
    }
    elevation_->values[cell] = elevation;
    const auto columns = static_cast<std::size_t>(elevation_->geometry.columns);
    const int column = static_cast<int>(cell % columns), row = static_cast<int>(cell / columns);
    const auto renew = [&](int c, int r) {
        if (c < 0 || r < 0 || c > field_.last_column || r > field_.last_row || std::isnan(elevation_->at(c, r))) return;
        nodes_[elevation_->geometry.index(c, r)] = make_node(c, r);
    };
    renew(column, row);
    for (const int side : {-1, 1}) {
        renew(column + side, row);
        renew(column, row + side);
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

}  // namespace talus::terrain
