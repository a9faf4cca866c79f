#include "observe/erosion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus::observe {

Erosion measure_erosion(const sim::Ground& ground, const terrain::FlowPath& flow_path, double chainage_interval) {
    Erosion erosion;
    const terrain::Bed& bed = ground.bed;
    if (bed.empty()) return erosion;
    const GridGeometry& g = ground.terrain.elevation().geometry;
    const double area = g.cell * g.cell;
    for (const double eroded : bed.eroded) erosion.volume += eroded * area;
    erosion.depth = erosion_depth(g, bed.eroded);
    set_upstream_volumes(flow_path, chainage_interval, erosion);
    return erosion;
}

void set_upstream_volumes(const terrain::FlowPath& flow_path, double chainage_interval, Erosion& erosion) {
    erosion.chainage.clear();
    erosion.upstream.clear();
    if (flow_path.empty()) return;
    const GridGeometry& g = erosion.depth.geometry;
    const double area = g.cell * g.cell;
    const auto bins = static_cast<std::size_t>(flow_path.length() / chainage_interval) + 2;
    erosion.chainage.resize(bins);
    for (std::size_t k = 0; k < bins; ++k) {
        erosion.chainage[k] = std::min(static_cast<double>(k) * chainage_interval, flow_path.length());
    }
    erosion.upstream.assign(bins, 0);
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const double eroded = erosion.depth.at(column, row);
            if (std::isnan(eroded)) continue;
            if (const auto at = flow_path.locate(g.centre(column, row))) {
                const auto bin = static_cast<std::size_t>(std::ceil(at->chainage / chainage_interval));
                erosion.upstream[std::min(bin, bins - 1)] += eroded * area;
            }
        }
    }
    for (std::size_t k = 1; k < bins; ++k) erosion.upstream[k] += erosion.upstream[k - 1];
}

Grid<float> erosion_depth(const GridGeometry& terrain, const std::vector<float>& eroded) {
    int first_column = terrain.columns, first_row = terrain.rows, last_column = -1, last_row = -1;
    for (std::size_t k = 0; k < eroded.size(); ++k) {
        if (!(eroded[k] > 0)) continue;
        const auto columns = static_cast<std::size_t>(terrain.columns);
        const auto column = static_cast<int>(k % columns), row = static_cast<int>(k / columns);
        first_column = std::min(first_column, column);
        last_column = std::max(last_column, column);
        first_row = std::min(first_row, row);
        last_row = std::max(last_row, row);
    }
    if (last_column < first_column) return {};

    constexpr int margin = 2;
    first_column = std::max(0, first_column - margin);
    first_row = std::max(0, first_row - margin);
    const int columns = std::min(terrain.columns - 1, last_column + margin) - first_column + 1;
    const int rows = std::min(terrain.rows - 1, last_row + margin) - first_row + 1;
    Grid<float> depth({terrain.x_min + first_column * terrain.cell, terrain.y_min + first_row * terrain.cell,
                       terrain.cell, columns, rows},
                      std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const float here = eroded[terrain.index(first_column + column, first_row + row)];
            if (here > 0) depth.at(column, row) = here;
        }
    }
    return depth;
}

}  // namespace talus::observe
