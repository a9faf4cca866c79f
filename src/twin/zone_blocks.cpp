#include "twin/zone_blocks.hpp"

#include <cstddef>
#include <map>
#include <utility>

namespace talus::twin {
namespace {

/// Rows of neighbours become one rectangle, and so do equal ones above each other.
std::vector<Extent> rectangles_of(const Grid<int>& counts, int least) {
    const GridGeometry& g = counts.geometry;
    std::vector<Extent> made;
    std::map<std::pair<int, int>, std::size_t> below;  // by first and end column, in `made`
    for (int row = 0; row < g.rows; ++row) {
        std::map<std::pair<int, int>, std::size_t> here;
        const double south = g.y_min + row * g.cell;
        for (int column = 0; column < g.columns; ++column) {
            if (counts.at(column, row) < least) continue;
            const int first = column;
            while (column < g.columns && counts.at(column, row) >= least) ++column;
            const std::pair run{first, column};
            const auto same = below.find(run);
            if (same == below.end()) {
                made.push_back({g.x_min + first * g.cell, south, g.x_min + column * g.cell, south + g.cell});
                here[run] = made.size() - 1;
            } else {
                made[same->second].y_max = south + g.cell;
                here[run] = same->second;
            }
        }
        below = std::move(here);
    }
    return made;
}

}  // namespace

std::vector<Extent> blocks_of(const scene::Zone& zone, const GridGeometry& terrain, std::size_t most) {
    if (zone.cells == nullptr) return {};
    for (int factor = 1;; factor *= 2) {
        const GridGeometry coarse{terrain.x_min, terrain.y_min, terrain.cell * factor,
                                  (terrain.columns + factor - 1) / factor, (terrain.rows + factor - 1) / factor};
        Grid<int> counts(coarse);
        for (const std::size_t cell : zone.cells->cell) {
            const auto column = static_cast<int>(cell % static_cast<std::size_t>(terrain.columns));
            const auto row = static_cast<int>(cell / static_cast<std::size_t>(terrain.columns));
            ++counts.at(column / factor, row / factor);
        }
        std::vector<Extent> made = rectangles_of(counts, (factor * factor + 1) / 2);
        if (made.size() <= most || coarse.size() == 1) return made;
    }
}

}  // namespace talus::twin
