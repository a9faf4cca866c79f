#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "observe/device/maps.hpp"
#include "observe/particle_sums.hpp"
#include "sim/device/atomics.hpp"
#include "sim/device/views.hpp"
#include "sim/particle_density.hpp"

/// One functor per kernel, called with a particle, a tile or a cell. Those that choose particles write 0 or 1 in the
/// step's `index`, of which a prefix sum makes places in a list.
namespace talus::observe::device {

using sim::device::Data;

struct SumsOf {
    Data d;
    double deposited_speed{};

    TALUS_DEVICE ParticleSums operator()(std::uint32_t i) const {
        const bool own = !d.state.density_of_id.empty();
        const double weight = own ? sim::density_of(d.model, d.state, i) / d.model.rest_density : 1;
        ParticleSums sums;
        sums.add(d.state.velocity[i], d.state.position[i].z, d.state.held[i] != 0, weight, deposited_speed);
        return sums;
    }
};

struct IsHeld {
    Data d;

    TALUS_DEVICE std::uint32_t operator()(std::uint32_t i) const { return d.state.held[i] != 0 ? 1 : 0; }
};

/// Released particles on the path.
struct OnPathBeyond {
    using Item = PathParticle;
    Data d;
    ChainageBeyond chainage{};

    TALUS_DEVICE bool takes(std::uint32_t i) const {
        return d.state.held[i] == 0 && chainage.of(d.state.position[i].x, d.state.position[i].y) >= 0;
    }
    TALUS_DEVICE Item item(std::uint32_t i) const {
        return {i, chainage.of(d.state.position[i].x, d.state.position[i].y), length(d.state.velocity[i])};
    }
};

struct BesideWalls {
    using Item = WallParticle;
    Data d;
    terrain::PlanBinItems bins;

    TALUS_DEVICE bool takes(std::uint32_t i) const {
        return d.state.held[i] == 0 && !bins.near(d.state.position[i].x, d.state.position[i].y).empty();
    }
    TALUS_DEVICE Item item(std::uint32_t i) const {
        return {d.state.position[i], d.state.velocity[i], sim::density_of(d.model, d.state, i)};
    }
};

struct Inside {
    using Item = PlacedParticle;
    Data d;
    PlanRectangle rectangle{};
    bool released{};

    TALUS_DEVICE bool takes(std::uint32_t i) const {
        return rectangle.contains(d.state.position[i].x, d.state.position[i].y) && (!released || d.state.held[i] == 0);
    }
    TALUS_DEVICE Item item(std::uint32_t i) const {
        return {d.state.position[i], d.state.id[i], length(d.state.velocity[i])};
    }
};

template <class Choice>
struct Mark {
    Choice choice;

    TALUS_DEVICE void operator()(std::uint32_t i) const { choice.d.work.index[i] = choice.takes(i) ? 1 : 0; }
};

/// Lists the marked ones in their order.
template <class Choice>
struct Take {
    Choice choice;
    typename Choice::Item* to;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const std::uint32_t at = choice.d.work.index[i];
        if (choice.d.work.index[i + 1] > at) to[at] = choice.item(i);
    }
};

/// The tiles of a map: see MapAccumulator. A position is where a tile may be, an index where its cells are.
struct TileArrays : MapArrays<float*> {
    std::uint32_t* index_at;  ///< by position, one more than the index; 0: no tile yet
    std::uint8_t* active;     ///< by position: reached in this step
    std::uint8_t* missing;    ///< one for all: 1 where debris reached a position without a tile
    std::uint32_t tile_columns;
    // By cell, in the order of the indices.
    WholeSum* sum;
    float* density;
};

/// Where a particle counts.
struct MapPlace {
    AxisShare<float, std::int32_t> x, y;
    bool counts;  ///< it is released, and its position a number

    TALUS_DEVICE MapPlace(const Data& d, const MapFrame& map, std::uint32_t i)
        : x(axis_share(d.state.position[i].x, map.x_offset, map.inverse_cell, map.columns)),
          y(axis_share(d.state.position[i].y, map.y_offset, map.inverse_cell, map.rows)) {
        const LocalPoint p = d.state.position[i];
        counts = d.state.held[i] == 0 && p.x - p.x == 0 && p.y - p.y == 0;
    }
};

/// Notes the tiles that the nine cells of a particle lie in.
struct MarkTiles {
    Data d;
    MapFrame map;
    TileArrays tiles{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const MapPlace place(d, map, i);
        if (!place.counts) return;
        const auto column = static_cast<std::uint32_t>(place.x.cell), row = static_cast<std::uint32_t>(place.y.cell);
        for (std::uint32_t r = row / map_tile_size; r <= (row + 2) / map_tile_size; ++r) {
            for (std::uint32_t c = column / map_tile_size; c <= (column + 2) / map_tile_size; ++c) {
                const std::uint32_t position = r * tiles.tile_columns + c;
                sim::device::store_shared(tiles.active[position], std::uint8_t{1});
                if (tiles.index_at[position] == 0) sim::device::store_shared(*tiles.missing, std::uint8_t{1});
            }
        }
    }
};

/// 1 where a tile is missing.
struct CountMissing {
    TileArrays tiles{};
    std::uint32_t* index{};

    TALUS_DEVICE void operator()(std::uint32_t position) const {
        index[position] = tiles.active[position] != 0 && tiles.index_at[position] == 0 ? 1 : 0;
    }
};

/// Gives the missing ones the indices after `present`; lists their positions.
struct GiveTiles {
    TileArrays tiles{};
    const std::uint32_t* index{};
    std::uint32_t* position_of{};
    std::uint32_t present{};

    TALUS_DEVICE void operator()(std::uint32_t position) const {
        const std::uint32_t at = index[position];
        if (index[position + 1] == at) return;
        tiles.index_at[position] = present + at + 1;
        position_of[present + at] = position;
    }
};

/// A cell that no debris has reached.
struct ClearCell {
    TileArrays tiles{};
    std::uint32_t first{};

    TALUS_DEVICE void operator()(std::uint32_t k) const {
        const std::uint32_t cell = first + k;
        tiles.sum[cell] = {0, 0};
        clear_cell(map_cell(tiles, cell));
        tiles.density[cell] = 0;
    }
};

struct ClearSum {
    TileArrays tiles{};

    TALUS_DEVICE void operator()(std::uint32_t cell) const { tiles.sum[cell] = {0, 0}; }
};
struct ClearByte {
    std::uint8_t* bytes{};

    TALUS_DEVICE void operator()(std::uint32_t k) const { bytes[k] = 0; }
};

/// Adds a particle to its nine cells, weighed by its speed or its density.
struct SpreadOnMap {
    Data d;
    MapFrame map;
    TileArrays tiles{};
    double rest_density{};  ///< above 0: weighed by densities

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const MapPlace place(d, map, i);
        if (!place.counts) return;
        const auto amount = static_cast<unsigned long long>(weight(i));
        const float along_x[3] = {place.x.before, place.x.at, place.x.after};
        const float along_y[3] = {place.y.before, place.y.at, place.y.after};
        for (std::uint32_t r = 0; r < 3; ++r) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                const auto share = static_cast<unsigned long long>(along_y[r] * along_x[c]);
                if (share == 0) continue;
                WholeSum& sum =
                    cell(static_cast<std::uint32_t>(place.x.cell) + c, static_cast<std::uint32_t>(place.y.cell) + r);
                sim::device::add_atomically(sum.volume, share);
                sim::device::add_atomically(sum.weighted, share * amount);
            }
        }
    }
    [[nodiscard]] TALUS_DEVICE float weight(std::uint32_t i) const {
        const LocalPoint v = d.state.velocity[i];
        if (!(rest_density > 0)) return whole_speed(v.x, v.y, v.z);
        const std::uint32_t id = d.state.id[i];
        return whole_density(id < d.state.density_of_id.size() ? d.state.density_of_id[id] : 0, rest_density);
    }
    [[nodiscard]] TALUS_DEVICE WholeSum& cell(std::uint32_t column, std::uint32_t row) const {
        const std::uint32_t position = row / map_tile_size * tiles.tile_columns + column / map_tile_size;
        const std::uint32_t first = (tiles.index_at[position] - 1) * static_cast<std::uint32_t>(map_tile_cells);
        return tiles.sum[first + row % map_tile_size * map_tile_size + column % map_tile_size];
    }
};

/// The mean density of a cell, of sums that are weighed by densities.
struct KeepDensity {
    TileArrays tiles{};
    MapScale scale;

    TALUS_DEVICE void operator()(std::uint32_t cell) const {
        tiles.density[cell] = tiles.sum[cell].sum().density(scale);
    }
};

struct UpdateCell {
    TileArrays tiles{};
    MapScale scale;
    double time{};
    bool own_densities{};

    TALUS_DEVICE void operator()(std::uint32_t cell) const {
        const double density = own_densities ? static_cast<double>(tiles.density[cell]) : scale.rest_density;
        update_cell(scale, tiles.sum[cell].sum(), density, time, map_cell(tiles, cell));
    }
};

/// active[k] by index in place of position.
struct ActiveByIndex {
    TileArrays tiles{};
    const std::uint32_t* position_of{};
    std::uint8_t* to{};

    TALUS_DEVICE void operator()(std::uint32_t k) const { to[k] = tiles.active[position_of[k]]; }
};

}  // namespace talus::observe::device
