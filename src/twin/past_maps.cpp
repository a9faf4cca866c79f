#include "twin/past_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/hazard_maps.hpp"

namespace talus::twin {
namespace {

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

/// The cells over which any of the frames has debris.
GridGeometry common_window(const std::vector<FramePtr>& frames, const GridGeometry& map) {
    auto first_column = static_cast<std::uint32_t>(map.columns), first_row = static_cast<std::uint32_t>(map.rows);
    std::uint32_t columns_end = 0, rows_end = 0;
    for (const FramePtr& frame : frames) {
        const auto [column, row, columns, rows] = frame->window;
        if (columns == 0 || rows == 0) continue;
        first_column = std::min(first_column, column);
        first_row = std::min(first_row, row);
        columns_end = std::max(columns_end, column + columns);
        rows_end = std::max(rows_end, row + rows);
    }
    if (columns_end <= first_column) return {map.x_min, map.y_min, map.cell, 1, 1};
    return {map.x_min + first_column * map.cell, map.y_min + first_row * map.cell, map.cell,
            static_cast<int>(columns_end - first_column), static_cast<int>(rows_end - first_row)};
}

/// Calls `take(index in grid, debris)` for the cells of a frame's window.
template <class Take>
void for_each_cell(const Frame& frame, const GridGeometry& map, const GridGeometry& grid, const Take& take) {
    const auto shift_x = static_cast<int>(std::lround((grid.x_min - map.x_min) / map.cell));
    const auto shift_y = static_cast<int>(std::lround((grid.y_min - map.y_min) / map.cell));
    const auto [first_column, first_row, columns, rows] = frame.window;
    const std::vector<DebrisAt> cells = debris_in_window(frame);
    for (std::uint32_t row = 0; row < rows; ++row) {
        const std::size_t begin =
            grid.index(static_cast<int>(first_column) - shift_x, static_cast<int>(first_row + row) - shift_y);
        for (std::uint32_t column = 0; column < columns; ++column) {
            take(begin + column, cells[std::size_t{row} * columns + column]);
        }
    }
}

/// The value of a layer for one frame's debris in a cell; `named`: nullptr where it is none of the maps.
double value_of(const std::string& name, const NamedMap* named, const DebrisAt& debris) {
    if (named != nullptr) return named->value({debris.depth, debris.speed, debris.density});
    return name == pore_pressure_layer ? debris.pore_pressure_ratio : debris.depth;
}

Grid<float> past_arrival(const Grid<float>& now, double time) {
    Grid<float> then = now;
    for (float& value : then.values) {
        if (!(value <= time)) value = nothing;
    }
    return then;
}

}  // namespace

std::vector<std::string_view> run_layers() {
    std::vector<std::string_view> names = map_keys("depth");
    names.insert(names.end(), {pore_pressure_layer, "erosion_depth"});
    return names;
}

Grid<float> past_layer(const std::string& name, const std::vector<FramePtr>& frames, const MapFrame& map) {
    if (frames.empty()) return Grid<float>({map.geometry.x_min, map.geometry.y_min, map.geometry.cell, 1, 1}, nothing);
    const NamedMap* named = find_map(name);
    if (named != nullptr && named->kind == MapKind::arrival) return past_arrival(map.arrival_now, frames.back()->time);
    Grid<float> layer(common_window(frames, map.geometry), nothing);
    // "depth" and the pore pressure are those of the last frame; so is the deposit depth, wherever debris has been.
    const bool now_alone = named == nullptr, peaks = !now_alone && named->kind == MapKind::peak;
    for (const FramePtr& frame : frames) {
        const bool last = frame == frames.back();
        if (now_alone && !last) continue;
        for_each_cell(*frame, map.geometry, layer.geometry, [&](std::size_t k, const DebrisAt& debris) {
            if (debris.depth <= 0) return;
            float& value = layer.values[k];
            if (debris.depth >= map.thinnest && !now_alone && std::isnan(value)) value = 0;
            if (!peaks && !last) return;
            if (!now_alone && std::isnan(value)) return;
            const auto now = static_cast<float>(value_of(name, named, debris));
            value = std::isnan(value) ? now : std::max(value, now);
        });
    }
    return layer;
}

}  // namespace talus::twin
