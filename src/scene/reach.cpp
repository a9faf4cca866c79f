#include "scene/reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

constexpr float unreached = -std::numeric_limits<float>::infinity();

/// Heights of the energy lines over the ground: Dijkstra with the highest first, so that the first visit of a cell is
/// by the path with the smallest loss.
class EnergyLines {
  public:
    EnergyLines(const Grid<float>& elevation, double travel_angle)
        : elevation_(elevation),
          loss_(std::tan(travel_angle) * elevation.geometry.cell),
          energy_(elevation.geometry, unreached) {}

    /// A line that begins `above` the ground of the cell at a place.
    void begin(const PlanPoint& p, double above) {
        const GridGeometry& g = elevation_.geometry;
        const int column = std::clamp(static_cast<int>((p.x - g.x_min) / g.cell), 0, g.columns - 1);
        const int row = std::clamp(static_cast<int>((p.y - g.y_min) / g.cell), 0, g.rows - 1);
        offer(column, row, elevation_.at(column, row) + above);
    }

    /// Calls `visit(column, row)` for every cell that is reached, some of them several times.
    template <class Visit>
    void follow(const Visit& visit) {
        const GridGeometry& g = elevation_.geometry;
        const auto columns = static_cast<std::size_t>(g.columns);
        while (!open_.empty()) {
            const auto [level, k] = open_.top();
            open_.pop();
            if (level < energy_.values[k]) continue;
            const int column = static_cast<int>(k % columns), row = static_cast<int>(k / columns);
            visit(column, row);
            for (const Neighbour& n : neighbours) {
                const int c = column + n.column, r = row + n.row;
                if (c >= 0 && r >= 0 && c < g.columns && r < g.rows) offer(c, r, level - loss_ * n.length);
            }
        }
    }

  private:
    void offer(int column, int row, double level) {
        const auto height = static_cast<float>(level);
        const std::size_t k = elevation_.geometry.index(column, row);
        if (!(height >= elevation_.values[k]) || !(height > energy_.values[k])) return;  // also refuses nodata
        energy_.values[k] = height;
        open_.emplace(height, k);
    }

    const Grid<float>& elevation_;
    const double loss_;
    Grid<float> energy_;
    std::priority_queue<std::pair<float, std::size_t>> open_;
};

/// The lowest ground of blocks of cells; NaN where all is nodata. Few enough to be searched at once.
Grid<float> lowest_of_blocks(const Grid<float>& elevation, int block) {
    const GridGeometry& g = elevation.geometry;
    Grid<float> lowest(
        GridGeometry{g.x_min, g.y_min, g.cell * block, (g.columns + block - 1) / block, (g.rows + block - 1) / block},
        std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const float z = elevation.at(column, row);
            float& low = lowest.at(column / block, row / block);
            if (!std::isnan(z) && !(low <= z)) low = z;
        }
    }
    return lowest;
}

}  // namespace

Extent reachable_extent(const terrain::Terrain& terrain, const std::vector<terrain::Release>& releases,
                        double travel_angle) {
    const GridGeometry& g = terrain.elevation().geometry;
    EnergyLines lines(terrain.elevation(), travel_angle);
    Extent reached = releases.front().extent();
    for (const terrain::Release& release : releases) {
        const Extent e = release.extent();
        reached.include({e.x_min, e.y_min});
        reached.include({e.x_max, e.y_max});
        for (const terrain::ReleasePatch& patch : release.patches) {
            for_each_inside(patch.polygon, g.cell / 2,
                            [&](const PlanPoint& p) { lines.begin(p, release.thickness_at(p)); });
        }
    }
    lines.follow([&](int column, int row) {
        const PlanPoint centre = g.centre(column, row);
        reached.include({centre.x - g.cell / 2, centre.y - g.cell / 2});
        reached.include({centre.x + g.cell / 2, centre.y + g.cell / 2});
    });
    return reached;
}

bool ReachableGround::holds(int column, int row) const {
    return blocks.values.empty() || blocks.at(column / block, row / block) != 0;
}

std::optional<double> ReachableGround::cells() const {
    if (blocks.values.empty()) return std::nullopt;
    const auto reached = std::count(blocks.values.begin(), blocks.values.end(), std::uint8_t{1});
    return static_cast<double>(reached) * block * block;
}

ReachableGround reachable_ground(const terrain::Terrain& terrain, const std::vector<terrain::Release>& releases,
                                 double travel_angle) {
    constexpr double most_blocks = 250'000;
    ReachableGround ground;
    if (releases.empty()) return ground;
    const Grid<float>& elevation = terrain.elevation();
    ground.block = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(elevation.geometry.size()) / most_blocks)));
    const Grid<float> lowest = lowest_of_blocks(elevation, ground.block);
    const GridGeometry& g = lowest.geometry;
    EnergyLines lines(lowest, travel_angle);
    for (const terrain::Release& release : releases) {
        for (const terrain::ReleasePatch& patch : release.patches) {
            for_each_inside(patch.polygon, elevation.geometry.cell / 2, [&](const PlanPoint& p) {
                const double low = value_at(lowest, p), own = terrain.elevation_at(p);
                lines.begin(p, release.thickness_at(p) + (own > low ? own - low : 0));
            });
        }
    }
    ground.blocks = Grid<std::uint8_t>(g, 0);
    lines.follow([&](int column, int row) {
        // And around it: what is implausible can stand at the edge of the reach.
        for (int r = std::max(0, row - 1); r <= std::min(g.rows - 1, row + 1); ++r) {
            for (int c = std::max(0, column - 1); c <= std::min(g.columns - 1, column + 1); ++c)
                ground.blocks.at(c, r) = 1;
        }
    });
    return ground;
}

}  // namespace talus::scene
