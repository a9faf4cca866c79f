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

std::uint32_t increment(std::uint32_t& counter) {
    return std::atomic_ref<std::uint32_t>(counter).fetch_add(1, std::memory_order_relaxed);
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
    if (state.count > 0) first_particle_ = {origin.x + state.position.x[0], origin.y + state.position.y[0]};
}

bool MapAccumulator::counts(const State& state, std::size_t i) const {
    return state.held[i] == 0 && std::isfinite(state.position.x[i]) && std::isfinite(state.position.y[i]);
}

MapAccumulator::Share MapAccumulator::share_of(const LocalPoint& p) const {
    const auto axis = [](double u, int cells, std::array<int, 3>& weight) {
        const double cell = std::clamp(std::floor(u), 0.0, cells - 1.0);
        const double f = std::clamp(u - cell - 0.5, -0.5, 0.5);  // from the cell's centre
        weight[0] = static_cast<int>(0.5 * (0.5 - f) * (0.5 - f) * one + 0.5);
        weight[2] = static_cast<int>(0.5 * (0.5 + f) * (0.5 + f) * one + 0.5);
        weight[1] = one - weight[0] - weight[2];
        return static_cast<int>(cell) - 1;
    };
    Share share{};
    share.column = axis((p.x + x_offset_) * inverse_cell_, geometry_.columns, share.weight_x);
    share.row = axis((p.y + y_offset_) * inverse_cell_, geometry_.rows, share.weight_y);
    return share;
}

template <class F>
void MapAccumulator::for_each_tile(const LocalPoint& p, const F& f) const {
    const Share share = share_of(p);
    const int first_column = std::max(share.column, 0) / tile_size, first_row = std::max(share.row, 0) / tile_size;
    const int last_column = std::min(share.column + 2, geometry_.columns - 1) / tile_size;
    const int last_row = std::min(share.row + 2, geometry_.rows - 1) / tile_size;
    for (int row = first_row; row <= last_row; ++row) {
        for (int column = first_column; column <= last_column; ++column) {
            f(static_cast<std::size_t>(row) * static_cast<std::size_t>(tile_columns_) +
              static_cast<std::size_t>(column));
        }
    }
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
    cpu::parallel_ranges(state.count, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (!counts(state, i)) continue;
            for_each_tile(state.position.at(i), [&](std::size_t position) {
                if (increment(tile_count_[position]) == 0) {
                    active_[increment(active_count_)] = static_cast<std::uint32_t>(position);
                }
            });
        }
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
        for (std::size_t i = first; i < last; ++i) {
            if (!counts(state, i)) continue;
            for_each_tile(state.position.at(i), [&](std::size_t position) {
                entries_[increment(tile_count_[position])] = static_cast<std::uint32_t>(i);
            });
        }
    });
    for (std::uint32_t k = 0; k < active_count_; ++k) tile_count_[active_[k]] = 0;
}

void MapAccumulator::sum_up(Tile& tile, const State& state, std::size_t first, std::size_t last) const {
    for (std::size_t k = first; k < last; ++k) {
        const std::size_t i = entries_[k];
        const Share share = share_of(state.position.at(i));
        const double speed = length(state.velocity.at(i));
        const auto whole_speed = static_cast<std::int64_t>((speed < fastest ? speed : fastest) * speed_units + 0.5);
        for (int r = 0; r < 3; ++r) {
            // What would fall off the map's rim stays in its outermost cells.
            const int row = std::clamp(share.row + r, 0, geometry_.rows - 1) - tile.row;
            if (row < 0 || row >= tile_size) continue;
            for (int c = 0; c < 3; ++c) {
                const int column = std::clamp(share.column + c, 0, geometry_.columns - 1) - tile.column;
                if (column < 0 || column >= tile_size) continue;
                const std::int64_t weight = share.weight_x[static_cast<std::size_t>(c)] *
                                            static_cast<std::int64_t>(share.weight_y[static_cast<std::size_t>(r)]);
                const auto cell = static_cast<std::size_t>(row * tile_size + column);
                tile.volume[cell] += weight;
                tile.momentum[cell] += weight * whole_speed;
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
    const Share share = share_of(p);
    const int column = share.column + 1, row = share.row + 1;
    const std::int32_t index =
        tile_at_[static_cast<std::size_t>(row / tile_size) * static_cast<std::size_t>(tile_columns_) +
                 static_cast<std::size_t>(column / tile_size)];
    if (index < 0) return 0;
    const Tile& tile = *tiles_[static_cast<std::size_t>(index)];
    const auto cell = static_cast<std::size_t>(row % tile_size * tile_size + column % tile_size);
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
