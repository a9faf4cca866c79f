#include "observe/map_accumulator.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <mutex>
#include <unordered_map>

#include "observe/map_units.hpp"
#include "simd/lanes.hpp"
#include "simd/parallel.hpp"

namespace talus::observe {
namespace {

constexpr std::size_t grain = 2048;  ///< particles per task

using L = simd::Lanes<4>;
constexpr std::size_t chunk = 16;  ///< particles whose shares are computed at once
static_assert(chunk <= sim::array_padding);

/// The shares of a chunk along one axis.
struct AxisShares {
    std::array<std::int32_t, chunk> cell;
    std::array<std::array<float, chunk>, 3> weight;

    void set(std::size_t at, const AxisShare<L, decltype(truncated(L(0)))>& share) {
        std::memcpy(cell.data() + at, &share.cell.v, sizeof share.cell.v);
        share.before.store(weight[0].data() + at);
        share.at.store(weight[1].data() + at);
        share.after.store(weight[2].data() + at);
    }
};

}  // namespace

MapAccumulator::MapAccumulator(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                               double map_cell, double arrival_depth)
    : inverse_cell_(1 / map_cell), particle_volume_(model.particle_volume()) {
    const Extent extent = ground.terrain.elevation().geometry.extent();
    const auto cells = [&](double length) {
        return std::max(1, static_cast<int>(std::ceil(length / map_cell - 1e-6)));
    };
    geometry_ = {extent.x_min, extent.y_min, map_cell, cells(extent.width()), cells(extent.height())};
    const WorldPoint& origin = ground.terrain.frame().origin;
    frame_ = {static_cast<float>(origin.x - geometry_.x_min), static_cast<float>(origin.y - geometry_.y_min),
              static_cast<float>(inverse_cell_), geometry_.columns, geometry_.rows};
    scale_.depth_of_unit = particle_volume_ / map_units::particle / (map_cell * map_cell);
    scale_.thinnest_depth = 0.1 * model.particle_spacing;
    scale_.arrival_depth = arrival_depth;
    scale_.rest_density = model.rest_density;

    // Tiles also hold the cells just outside the map's edge, which never receive a share, so that every particle has
    // nine cells.
    const auto tiles_along = [](int cells_along) {
        return (static_cast<unsigned>(cells_along) + 2 + tile_size - 1) / tile_size;
    };
    tile_columns_ = tiles_along(geometry_.columns);
    const std::size_t positions = std::size_t{tile_columns_} * tiles_along(geometry_.rows);
    tile_at_.assign(positions, nullptr);
    make_room(state.count);
    if (state.count > 0) first_particle_ = {origin.x + state.position.x[0], origin.y + state.position.y[0]};
}

MapAccumulator::MapAccumulator(const MapAccumulator& other)
    : geometry_(other.geometry_),
      inverse_cell_(other.inverse_cell_),
      particle_volume_(other.particle_volume_),
      frame_(other.frame_),
      scale_(other.scale_),
      tile_columns_(other.tile_columns_),
      first_particle_(other.first_particle_) {
    other.read_back();
    adds_ = other.adds_;
    active_count_ = other.active_count_;
    active_.resize(other.active_.size(), nullptr);
    tiles_.reserve(other.tiles_.capacity());
    std::unordered_map<const Tile*, Tile*> copy_of;
    for (const auto& tile : other.tiles_) {
        Tile& made = *tiles_.emplace_back(std::make_unique<Tile>());
        static_cast<TileValues&>(made) = *tile;
        copy_of[tile.get()] = &made;
    }
    tile_at_.assign(other.tile_at_.size(), nullptr);
    for (std::size_t position = 0; position < tile_at_.size(); ++position) {
        if (const Tile* tile = other.tile_at_[position]) tile_at_[position] = copy_of[tile];
    }
    for (std::uint32_t t = 0; t < active_count_; ++t) active_[t] = copy_of[other.active_[t]];
}

/// The shares of the particles of a chunk and their cells.
struct MapAccumulator::Shares {
    AxisShares x, y;
    std::array<float, chunk> speed;  ///< or density, kg/m3: whole numbers either way
    std::array<float, chunk> known;  ///< 0: its position is not finite
};

/// A task's own sums for a tile: of the particles whose first cell, of nine, lies in the tile. The others may lie up to
/// two cells beyond it eastward and northward.
struct MapAccumulator::Patch {
    static constexpr std::size_t edge = tile_size + 2;
    unsigned tile_column = 0, tile_row = 0;  // of the tile, in tiles
    unsigned rows = 0;                       // bit r: row r may have shares
    unsigned east = 0;                       // 8: the columns beyond the tile may have shares
    std::array<CellSum, edge * edge> sums{};
};

/// The patches that a task works on. Consecutive particles are close together, but not always in one tile: there are
/// several patches, and one that must be replaced is added to the map. Adding single particles would need a lock on the
/// tile or sorting by tile; either costs more than the addition.
class MapAccumulator::Patches {
  public:
    explicit Patches(MapAccumulator& maps) : maps_(maps) {}

    void take_all() {
        for (Patch& patch : patches_) maps_.take(patch);
    }
    Patch& at(unsigned tile_column, unsigned tile_row) {
        Patch& patch = patches_[tile_row % rows * columns + tile_column % columns];
        if (patch.tile_column != tile_column || patch.tile_row != tile_row) {
            maps_.take(patch);
            patch.tile_column = tile_column;
            patch.tile_row = tile_row;
        }
        return patch;
    }

  private:
    static constexpr unsigned columns = 8, rows = 4;
    MapAccumulator& maps_;
    std::array<Patch, columns * rows> patches_;
};

void MapAccumulator::find_shares(const sim::State& state, std::size_t first, bool densities, Shares& shares) const {
    for (std::size_t k = 0; k < chunk; k += L::size) {
        const std::size_t i = first + k;
        const L x = L::load(&state.position.x[i]), y = L::load(&state.position.y[i]);
        shares.x.set(k, axis_share(x, frame_.x_offset, frame_.inverse_cell, frame_.columns));
        shares.y.set(k, axis_share(y, frame_.y_offset, frame_.inverse_cell, frame_.rows));
        select((x - x == L(0)) & (y - y == L(0)), L(1), L(0)).store(&shares.known[k]);
        const L vx = L::load(&state.velocity.x[i]), vy = L::load(&state.velocity.y[i]),
                vz = L::load(&state.velocity.z[i]);
        whole_speed(vx, vy, vz).store(&shares.speed[k]);
    }
    if (!densities) return;
    for (std::size_t k = 0; k < chunk; ++k) {
        const std::uint32_t id = first + k < state.count ? state.id[first + k] : 0;
        const float own = id < state.density_of_id.size() ? state.density_of_id[id] : 0;
        shares.speed[k] = whole_density(own, scale_.rest_density);
    }
}

void MapAccumulator::spread(const sim::State& state, bool densities, std::size_t first, std::size_t last) {
    Patches patches(*this);
    Shares shares{};
    for (std::size_t i = first; i < last; i += chunk) {
        find_shares(state, i, densities, shares);
        const std::size_t present = std::min(chunk, last - i);
        for (std::size_t k = 0; k < present; ++k) {
            if (state.held[i + k] != 0 || shares.known[k] == 0) continue;
            // The first cell of the nine, counted from the one before the map's.
            const auto column = static_cast<unsigned>(shares.x.cell[k]), row = static_cast<unsigned>(shares.y.cell[k]);
            Patch& patch = patches.at(column / tile_size, row / tile_size);
            const unsigned c = column % tile_size, r = row % tile_size;
            patch.east |= c + 2;
            patch.rows |= 7U << r;
            CellSum* sums = patch.sums.data() + r * Patch::edge + c;
            const CellSum::Pair one_and_speed{1, shares.speed[k]};
            for (std::size_t y = 0; y < 3; ++y) {
                const CellSum::Pair in_row = one_and_speed * static_cast<double>(shares.y.weight[y][k]);
                for (std::size_t x = 0; x < 3; ++x) {
                    sums[y * Patch::edge + x].pair += in_row * static_cast<double>(shares.x.weight[x][k]);
                }
            }
        }
    }
    patches.take_all();
}

MapAccumulator::Tile& MapAccumulator::tile_at(unsigned tile_column, unsigned tile_row) const {
    const std::size_t position = std::size_t{tile_row} * tile_columns_ + tile_column;
    const std::atomic_ref<Tile*> tile(tile_at_[position]);
    if (Tile* found = tile.load(std::memory_order_acquire)) return *found;
    const std::scoped_lock lock(new_tile_);
    if (Tile* found = tile.load(std::memory_order_relaxed)) return *found;
    Tile& made = *tiles_.emplace_back(std::make_unique<Tile>());
    made.column = static_cast<int>(tile_column * tile_size) - 1;
    made.row = static_cast<int>(tile_row * tile_size) - 1;
    made.arrival_time.fill(std::numeric_limits<float>::quiet_NaN());
    tile.store(&made, std::memory_order_release);
    return made;
}

void MapAccumulator::take(Patch& patch) {
    constexpr std::size_t size = tile_size;
    const auto take_part = [&](unsigned east, unsigned north) {
        Tile& tile = tile_at(patch.tile_column + east, patch.tile_row + north);
        const std::size_t columns = east != 0 ? 2 : size, row_begin = north != 0 ? size : 0;
        const std::scoped_lock lock(tile.adding);
        if (tile.added != adds_) {
            tile.added = adds_;
            tile.sums.fill({});
            active_[std::atomic_ref(active_count_).fetch_add(1, std::memory_order_relaxed)] = &tile;
        }
        for (std::size_t row = row_begin; row < (north != 0 ? Patch::edge : size); ++row) {
            if ((patch.rows >> row & 1U) == 0) continue;
            const CellSum* from = patch.sums.data() + row * Patch::edge + (east != 0 ? size : 0);
            CellSum* to = tile.sums.data() + (row - row_begin) * size;
            for (std::size_t column = 0; column < columns; ++column) to[column].pair += from[column].pair;
        }
    };
    if (patch.rows == 0) return;
    const bool east = (patch.east & tile_size) != 0, north = patch.rows >> tile_size != 0;
    take_part(0, 0);
    if (east) take_part(1, 0);
    if (north) take_part(0, 1);
    if (east && north) take_part(1, 1);
    for (std::size_t row = 0; row < Patch::edge; ++row) {
        if (patch.rows >> row & 1U) std::fill_n(patch.sums.begin() + row * Patch::edge, Patch::edge, CellSum{});
    }
    patch.rows = patch.east = 0;
}

void MapAccumulator::make_room(std::size_t particles) {
    const std::size_t wanted = std::min(tile_at_.size(), 4 * particles);
    if (active_.size() < wanted) active_.resize(std::min(tile_at_.size(), wanted + wanted / 2));
}

void MapAccumulator::follow(const sim::Model& model, const sim::State& state) {
    make_room(state.count);
    if (model.rest_density == scale_.rest_density) return;
    read_back();
    device_is_older_ = true;
    keep_pressures();
    scale_.rest_density = model.rest_density;
}

void MapAccumulator::keep_pressures() {
    if (!scale_.keeps_pressures) {
        for (const auto& tile : tiles_) {
            for (std::size_t cell = 0; cell < tile_cells; ++cell) tile->pressure[cell] = peak_pressure(*tile, cell);
        }
    }
    scale_.keeps_pressures = true;
}

float MapAccumulator::peak_pressure(const Tile& tile, std::size_t cell) const {
    if (scale_.keeps_pressures) return tile.pressure[cell];
    const double speed = tile.speed[cell];
    return static_cast<float>(scale_.rest_density * speed * speed);
}

void MapAccumulator::update_peaks(Tile& tile, double time) const {
    for (std::size_t cell = 0; cell < tile_cells; ++cell) {
        update_cell(scale_, tile.sums[cell].sum(), density_in(tile, cell), time, map_cell(tile, cell));
    }
}

void MapAccumulator::spread_all(const sim::State& state, bool densities) {
    ++adds_;
    active_count_ = 0;
    simd::parallel_ranges(state.count, grain,
                          [&](std::size_t first, std::size_t last) { spread(state, densities, first, last); });
}

void MapAccumulator::take_densities(const sim::State& state) {
    keep_pressures();
    spread_all(state, true);
    simd::parallel_ranges(active_count_, 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            Tile& tile = *active_[k];
            tile.density.resize(tile_cells);
            for (std::size_t cell = 0; cell < tile_cells; ++cell) {
                tile.density[cell] = tile.sums[cell].sum().density(scale_);
            }
        }
    });
}

void MapAccumulator::add(const sim::State& state) {
    read_back();
    device_is_older_ = true;
    make_room(state.count);
    if (!state.density_of_id.empty()) take_densities(state);
    spread_all(state, false);
    simd::parallel_ranges(active_count_, 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) update_peaks(*active_[k], state.time);
    });
}

}  // namespace talus::observe
