// Converts the sums of a MapAccumulator to depths, speeds and densities.
#include <algorithm>
#include <cmath>
#include <limits>

#include "observe/map_accumulator.hpp"
#include "observe/map_units.hpp"

namespace talus::observe {

MapAccumulator::CellSum MapAccumulator::sum_of(const Tile& tile, std::size_t cell) const {
    return tile.added == adds_ ? tile.sums[cell] : CellSum{};
}

double MapAccumulator::volume() const {
    read_back();
    double sum = 0;
    for (const auto& tile : tiles_) {
        for (std::size_t cell = 0; cell < tile_cells; ++cell) sum += sum_of(*tile, cell).volume();
    }
    return sum / map_units::particle * particle_volume_;
}

FlowAt MapAccumulator::at(const PlanPoint& place) const {
    const double column = std::floor((place.x - geometry_.x_min) * inverse_cell_);
    const double row = std::floor((place.y - geometry_.y_min) * inverse_cell_);
    if (!(column >= 0 && row >= 0 && column < geometry_.columns && row < geometry_.rows)) return {};
    const auto c = static_cast<unsigned>(column) + 1,
               r = static_cast<unsigned>(row) + 1;  // tiles begin one cell before
    const std::size_t position = std::size_t{r / tile_size} * tile_columns_ + c / tile_size;
    const std::size_t cell = std::size_t{r % tile_size} * tile_size + c % tile_size;
    const MapSum sum = sum_at(position, cell);
    FlowAt flow{depth(sum.volume)};
    if (sum.volume > 0 && flow.depth >= scale_.thinnest_depth) flow.speed = sum.speed();
    return flow;
}

MapAccumulator::Present MapAccumulator::present() const {
    read_back();
    int first_column = geometry_.columns, first_row = geometry_.rows, last_column = -1, last_row = -1;
    const auto edge = static_cast<int>(tile_size);
    for (std::uint32_t t = 0; t < active_count_; ++t) {
        const Tile& tile = *active_[t];
        first_column = std::min(first_column, std::max(tile.column, 0));
        first_row = std::min(first_row, std::max(tile.row, 0));
        last_column = std::max(last_column, std::min(tile.column + edge, geometry_.columns) - 1);
        last_row = std::max(last_row, std::min(tile.row + edge, geometry_.rows) - 1);
    }
    Present present;
    if (last_column < first_column || last_row < first_row) return present;
    present.first_column = first_column;
    present.first_row = first_row;
    const GridGeometry window{geometry_.x_min + first_column * geometry_.cell,
                              geometry_.y_min + first_row * geometry_.cell, geometry_.cell,
                              last_column - first_column + 1, last_row - first_row + 1};
    present.depth = present.speed = Grid<float>(window);
    const bool own_densities =
        std::any_of(tiles_.begin(), tiles_.end(), [](const auto& tile) { return !tile->density.empty(); });
    if (own_densities) present.density = Grid<float>(window, static_cast<float>(scale_.rest_density));
    for (std::uint32_t t = 0; t < active_count_; ++t) {
        const Tile& tile = *active_[t];
        for (std::size_t cell = 0; cell < tile_cells; ++cell) {
            const CellSum& sum = tile.sums[cell];
            if (sum.volume() == 0) continue;  // also those outside the map's edge
            const std::size_t k =
                window.index(tile.column + column_of(cell) - first_column, tile.row + row_of(cell) - first_row);
            present.depth.values[k] = static_cast<float>(depth(sum.volume()));
            if (own_densities) present.density.values[k] = static_cast<float>(density_in(tile, cell));
            if (present.depth.values[k] < scale_.thinnest_depth) continue;
            present.speed.values[k] = static_cast<float>(sum.sum().speed());
        }
    }
    return present;
}

Extent MapAccumulator::reached_cells() const {
    const double none = std::numeric_limits<double>::infinity();
    Extent reached{none, none, -none, -none};
    for (const auto& tile : tiles_) {
        for (std::size_t cell = 0; cell < tile_cells; ++cell) {
            if (tile->depth[cell] == 0) continue;
            reached.include(geometry_.centre(tile->column + column_of(cell), tile->row + row_of(cell)));
        }
    }
    if (reached.x_min > reached.x_max) {
        return {first_particle_.x, first_particle_.y, first_particle_.x, first_particle_.y};
    }
    return reached;
}

HazardMaps MapAccumulator::maps() const {
    read_back();
    constexpr double margin = 20;  // m around the reached cells
    const Extent frame = reached_cells().grown(margin);
    const auto cell_at = [&](double x, double x_min, int cells) {
        return static_cast<int>(std::clamp(std::floor((x - x_min) * inverse_cell_), 0.0, cells - 1.0));
    };
    const int first_column = cell_at(frame.x_min, geometry_.x_min, geometry_.columns);
    const int last_column = cell_at(frame.x_max, geometry_.x_min, geometry_.columns);
    const int first_row = cell_at(frame.y_min, geometry_.y_min, geometry_.rows);
    const int last_row = cell_at(frame.y_max, geometry_.y_min, geometry_.rows);
    const GridGeometry g{geometry_.x_min + first_column * geometry_.cell, geometry_.y_min + first_row * geometry_.cell,
                         geometry_.cell, last_column - first_column + 1, last_row - first_row + 1};

    HazardMaps maps = empty_maps(g);
    for (const auto& tile : tiles_) {
        for (std::size_t cell = 0; cell < tile_cells; ++cell) {
            if (tile->depth[cell] == 0) continue;
            const std::size_t k =
                g.index(tile->column + column_of(cell) - first_column, tile->row + row_of(cell) - first_row);
            const auto present = static_cast<float>(depth(sum_of(*tile, cell).volume()));
            read_cell(*tile, cell, peak_pressure(*tile, cell), present, maps, k);
        }
    }
    return maps;
}

}  // namespace talus::observe
