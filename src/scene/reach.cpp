#include "scene/reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

#include "scene/polygons.hpp"

namespace talus::scene {
namespace {

struct Neighbour {
    int column, row;
    double length;  // in cells
};
constexpr double diagonal = 1.4142135623730951;
constexpr std::array<Neighbour, 8> neighbours{{{1, 0, 1},
                                               {0, 1, 1},
                                               {-1, 0, 1},
                                               {0, -1, 1},
                                               {1, 1, diagonal},
                                               {-1, 1, diagonal},
                                               {-1, -1, diagonal},
                                               {1, -1, diagonal}}};

}  // namespace

Extent reachable_extent(const terrain::Terrain& terrain, const std::vector<terrain::Release>& releases,
                        double travel_angle) {
    const Grid<float>& elevation = terrain.elevation();
    const GridGeometry& g = elevation.geometry;
    const double loss = std::tan(travel_angle) * g.cell;
    // Dijkstra with the highest energy line first: the first visit of a cell is by the path with the smallest loss.
    Grid<float> energy(g, -std::numeric_limits<float>::infinity());
    std::priority_queue<std::pair<float, std::size_t>> open;
    const auto offer = [&](int column, int row, double level) {
        const auto height = static_cast<float>(level);
        const std::size_t k = g.index(column, row);
        if (!(height >= elevation.values[k]) || !(height > energy.values[k])) return;  // also refuses nodata
        energy.values[k] = height;
        open.emplace(height, k);
    };
    Extent reached = releases.front().extent();
    for (const terrain::Release& release : releases) {
        const Extent e = release.extent();
        reached.include({e.x_min, e.y_min});
        reached.include({e.x_max, e.y_max});
        for (const terrain::ReleasePatch& patch : release.patches) {
            for_each_inside(patch.polygon, g.cell / 2, [&](const PlanPoint& p) {
                const int column = std::clamp(static_cast<int>((p.x - g.x_min) / g.cell), 0, g.columns - 1);
                const int row = std::clamp(static_cast<int>((p.y - g.y_min) / g.cell), 0, g.rows - 1);
                offer(column, row, elevation.at(column, row) + release.thickness_at(p));
            });
        }
    }
    while (!open.empty()) {
        const auto [level, k] = open.top();
        open.pop();
        if (level < energy.values[k]) continue;
        const auto columns = static_cast<std::size_t>(g.columns);
        const int column = static_cast<int>(k % columns), row = static_cast<int>(k / columns);
        const PlanPoint centre = g.centre(column, row);
        reached.include({centre.x - g.cell / 2, centre.y - g.cell / 2});
        reached.include({centre.x + g.cell / 2, centre.y + g.cell / 2});
        for (const Neighbour& n : neighbours) {
            const int c = column + n.column, r = row + n.row;
            if (c >= 0 && r >= 0 && c < g.columns && r < g.rows) offer(c, r, level - loss * n.length);
        }
    }
    return reached;
}

}  // namespace talus::scene
