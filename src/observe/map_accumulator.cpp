#include "observe/map_accumulator.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "sim/cpu/parallel.hpp"

namespace talus {
namespace {

constexpr int one = 1 << 12;  ///< a weight of 1 along one axis
constexpr double one_particle = static_cast<double>(one) * one;
constexpr double speed_units = 1024;  ///< per m/s
constexpr double fastest = 1e4;       ///< m/s; keeps a broken state from overflowing the sums
constexpr double margin = 20;         ///< m around the reached cells
constexpr std::size_t grain = 1024;   ///< particles per task
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

std::uint32_t fetch_add(std::uint32_t& counter, std::uint32_t n) {
    return std::atomic_ref<std::uint32_t>(counter).fetch_add(n, std::memory_order_relaxed);
}

/// Whole-number weights of the cells before, at and after a position along one axis: a quadratic B-spline. What would
/// fall off the map's rim stays in its outermost cell. `offset`: from the cell's centre, in cells.
std::array<int, 3> weights(double offset, int cell, int cells) {
    const double f = std::clamp(offset, -0.5, 0.5);
    std::array<int, 3> weight{static_cast<int>(0.5 * (0.5 - f) * (0.5 - f) * one), 0,
                              static_cast<int>(0.5 * (0.5 + f) * (0.5 + f) * one)};
    if (cell == 0) weight[0] = 0;
    if (cell == cells - 1) weight[2] = 0;
    weight[1] = one - weight[0] - weight[2];
    return weight;
}

}  // namespace

MapAccumulator::MapAccumulator(const Model& model, const State& state, double map_cell, double arrival_depth)
    : inverse_cell_(1 / map_cell),
      particle_volume_(model.particle_volume()),
      rest_density_(model.rest_density),
      arrival_depth_(arrival_depth) {
    const Extent extent = model.terrain.elevation().geometry.extent();
    const auto cells = [&](double length) {
        return std::max(1, static_cast<int>(std::ceil(length / map_cell - 1e-6)));
    };
    geometry_ = {extent.x_min, extent.y_min, map_cell, cells(extent.width()), cells(extent.height())};
    const WorldPoint& origin = model.terrain.frame().origin;
    x_offset_ = origin.x - geometry_.x_min;
    y_offset_ = origin.y - geometry_.y_min;
    depth_of_unit_ = particle_volume_ / one_particle / (map_cell * map_cell);
    thinnest_depth_ = 0.1 * model.particle_spacing;

    tile_columns_ = (geometry_.columns + tile_size - 1) / tile_size;
    const int tile_rows = (geometry_.rows + tile_size - 1) / tile_size;
    const auto positions = static_cast<std::size_t>(tile_columns_) * static_cast<std::size_t>(tile_rows);
    tile_at_.assign(positions, -1);
    tile_count_.assign(positions, 0);
    const std::size_t most_entries = 4 * static_cast<std::size_t>(state.count);
    active_.resize(std::min(positions, most_entries));
    entry_start_.resize(active_.size() + 1);
    entries_.resize(most_entries);
    cell_.resize(state.count);
    if (state.count > 0) first_particle_ = {origin.x + state.position.x[0], origin.y + state.position.y[0]};
}

MapAccumulator::Cell MapAccumulator::cell_of(const LocalPoint& p) const {
    const double u = (p.x + x_offset_) * inverse_cell_, v = (p.y + y_offset_) * inverse_cell_;
    return {static_cast<int>(std::clamp(u, 0.0, geometry_.columns - 1.0)),
            static_cast<int>(std::clamp(v, 0.0, geometry_.rows - 1.0))};
}

void MapAccumulator::locate_particles(const State& state) {
    cpu::parallel_ranges(state.count, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const LocalPoint p = state.position.at(i);
            const bool counts = state.held[i] == 0 && std::isfinite(p.x) && std::isfinite(p.y);
            cell_[i] = counts ? cell_of(p) : Cell{-1, -1};
        }
    });
}

template <class F>
void MapAccumulator::for_each_run(std::size_t first, std::size_t last, const F& f) const {
    std::array<std::uint32_t, 64> run{};
    std::uint32_t length = 0;
    std::size_t run_position = 0;
    for (std::size_t i = first; i < last; ++i) {
        const Cell cell = cell_[i];
        if (cell.column < 0) continue;
        const int first_column = std::max(cell.column - 1, 0) / tile_size;
        const int last_column = std::min(cell.column + 1, geometry_.columns - 1) / tile_size;
        const int first_row = std::max(cell.row - 1, 0) / tile_size;
        const int last_row = std::min(cell.row + 1, geometry_.rows - 1) / tile_size;
        for (int row = first_row; row <= last_row; ++row) {
            for (int column = first_column; column <= last_column; ++column) {
                const std::size_t position = static_cast<std::size_t>(row) * static_cast<std::size_t>(tile_columns_) +
                                             static_cast<std::size_t>(column);
                if (length == run.size() || (length > 0 && position != run_position)) {
                    f(run_position, run.data(), length);
                    length = 0;
                }
                run_position = position;
                run[length++] = static_cast<std::uint32_t>(i);
            }
        }
    }
    if (length > 0) f(run_position, run.data(), length);
}

void MapAccumulator::sort_into_tiles(const State& state) {
    // Depths and speeds of tiles that debris has left are those of this step: none.
    cpu::parallel_ranges(active_count_, 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            Tile& tile = *tiles_[static_cast<std::size_t>(tile_at_[active_[k]])];
            tile.volume.fill(0);
            tile.momentum.fill(0);
        }
    });
    active_count_ = 0;
    locate_particles(state);
    cpu::parallel_ranges(state.count, grain, [&](std::size_t first, std::size_t last) {
        for_each_run(first, last, [&](std::size_t position, const std::uint32_t*, std::uint32_t n) {
            if (fetch_add(tile_count_[position], n) == 0) {
                active_[fetch_add(active_count_, 1)] = static_cast<std::uint32_t>(position);
            }
        });
    });
    std::uint32_t start = 0;
    for (std::uint32_t k = 0; k < active_count_; ++k) {
        const std::uint32_t position = active_[k];
        if (tile_at_[position] < 0) {
            tile_at_[position] = static_cast<std::int32_t>(tiles_.size());
            auto tile = std::make_unique<Tile>();
            tile->column = static_cast<int>(position) % tile_columns_ * tile_size;
            tile->row = static_cast<int>(position) / tile_columns_ * tile_size;
            tile->arrival_time.fill(not_a_number);
            tiles_.push_back(std::move(tile));
        }
        entry_start_[k] = start;
        const std::uint32_t count = tile_count_[position];
        tile_count_[position] = start;
        start += count;
    }
    entry_start_[active_count_] = start;
    cpu::parallel_ranges(state.count, grain, [&](std::size_t first, std::size_t last) {
        for_each_run(first, last, [&](std::size_t position, const std::uint32_t* particles, std::uint32_t n) {
            std::copy_n(particles, n, entries_.begin() + fetch_add(tile_count_[position], n));
        });
    });
    for (std::uint32_t k = 0; k < active_count_; ++k) tile_count_[active_[k]] = 0;
}

void MapAccumulator::sum_up(Tile& tile, const State& state, std::size_t first, std::size_t last) const {
    for (std::size_t k = first; k < last; ++k) {
        const std::size_t i = entries_[k];
        const Cell cell = cell_[i];
        const auto weight_x = weights((state.position.x[i] + x_offset_) * inverse_cell_ - cell.column - 0.5,
                                      cell.column, geometry_.columns);
        const auto weight_y =
            weights((state.position.y[i] + y_offset_) * inverse_cell_ - cell.row - 0.5, cell.row, geometry_.rows);
        const double speed = length(state.velocity.at(i));
        const auto whole_speed = std::llround((speed < fastest ? speed : fastest) * speed_units);
        // The particle's cells that lie in this tile.
        const int column = cell.column - 1 - tile.column, row = cell.row - 1 - tile.row;
        const int first_column = std::max(0, -column), last_column = std::min(3, tile_size - column);
        const int first_row = std::max(0, -row), last_row = std::min(3, tile_size - row);
        for (int r = first_row; r < last_row; ++r) {
            for (int c = first_column; c < last_column; ++c) {
                const std::int64_t weight = static_cast<std::int64_t>(weight_x[static_cast<std::size_t>(c)]) *
                                            weight_y[static_cast<std::size_t>(r)];
                const int cell_in_tile = (row + r) * tile_size + column + c;
                const auto at = static_cast<std::size_t>(cell_in_tile);
                tile.volume[at] += weight;
                tile.momentum[at] += weight * whole_speed;
            }
        }
    }
}

void MapAccumulator::update_peaks(Tile& tile, double time) const {
    for (std::size_t cell = 0; cell < tile_cells; ++cell) {
        const double now = depth(tile.volume[cell]);
        if (now < thinnest_depth_) continue;
        const double speed =
            static_cast<double>(tile.momentum[cell]) / static_cast<double>(tile.volume[cell]) / speed_units;
        tile.peak_depth[cell] = std::max(tile.peak_depth[cell], static_cast<float>(now));
        tile.peak_speed[cell] = std::max(tile.peak_speed[cell], static_cast<float>(speed));
        if (now > arrival_depth_ && std::isnan(tile.arrival_time[cell])) {
            tile.arrival_time[cell] = static_cast<float>(time);
        }
    }
}

void MapAccumulator::add(const State& state) {
    sort_into_tiles(state);
    cpu::parallel_ranges(active_count_, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            Tile& tile = *tiles_[static_cast<std::size_t>(tile_at_[active_[k]])];
            sum_up(tile, state, entry_start_[k], entry_start_[k + 1]);
            update_peaks(tile, state.time);
        }
    });
}

double MapAccumulator::speed_at(const LocalPoint& p) const {
    const auto [column, row] = cell_of(p);
    const std::int32_t index =
        tile_at_[static_cast<std::size_t>(row / tile_size) * static_cast<std::size_t>(tile_columns_) +
                 static_cast<std::size_t>(column / tile_size)];
    if (index < 0) return 0;
    const Tile& tile = *tiles_[static_cast<std::size_t>(index)];
    const int cell_in_tile = row % tile_size * tile_size + column % tile_size;
    const auto cell = static_cast<std::size_t>(cell_in_tile);
    if (depth(tile.volume[cell]) < thinnest_depth_) return 0;
    return static_cast<double>(tile.momentum[cell]) / static_cast<double>(tile.volume[cell]) / speed_units;
}

double MapAccumulator::volume() const {
    std::int64_t sum = 0;
    for (const auto& tile : tiles_) {
        for (const std::int64_t v : tile->volume) sum += v;
    }
    return static_cast<double>(sum) / one_particle * particle_volume_;
}

Extent MapAccumulator::reached_cells() const {
    const double none = std::numeric_limits<double>::infinity();
    Extent reached{none, none, -none, -none};
    for (const auto& tile : tiles_) {
        for (std::size_t cell = 0; cell < tile_cells; ++cell) {
            if (tile->peak_depth[cell] == 0) continue;
            const int column = tile->column + static_cast<int>(cell) % tile_size;
            const int row = tile->row + static_cast<int>(cell) / tile_size;
            reached.include(geometry_.centre(column, row));
        }
    }
    if (reached.x_min > reached.x_max) {
        return {first_particle_.x, first_particle_.y, first_particle_.x, first_particle_.y};
    }
    return reached;
}

HazardMaps MapAccumulator::maps() const {
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

    const Grid<float> empty(g, not_a_number);
    HazardMaps maps{empty, empty, empty, empty, empty};
    for (const auto& tile : tiles_) {
        for (std::size_t cell = 0; cell < tile_cells; ++cell) {
            if (tile->peak_depth[cell] == 0) continue;
            const std::size_t k = g.index(tile->column + static_cast<int>(cell) % tile_size - first_column,
                                          tile->row + static_cast<int>(cell) / tile_size - first_row);
            const double speed = tile->peak_speed[cell];
            maps.peak_depth.values[k] = tile->peak_depth[cell];
            maps.peak_speed.values[k] = tile->peak_speed[cell];
            maps.peak_pressure.values[k] = static_cast<float>(rest_density_ * speed * speed);
            maps.arrival_time.values[k] = tile->arrival_time[cell];
            maps.deposit_depth.values[k] = static_cast<float>(depth(tile->volume[cell]));
        }
    }
    return maps;
}

}  // namespace talus
