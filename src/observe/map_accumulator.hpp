#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include <tbb/spin_mutex.h>

#include "core/grid.hpp"
#include "observe/map_shares.hpp"
#include "observe/observation.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::observe::device {
class Maps;
}

namespace talus::observe {

/// Peak maps, accumulated after every step.
///
/// Every particle spreads its volume, and its volume times its speed, over 3 x 3 map cells with a quadratic B-spline:
/// with cells of about 2.5 spacings, depth over a uniform sheet is uniform to a few per cent. Weights and speeds are
/// whole numbers (2^-24 of a particle, 2^-10 m/s), so a particle's shares add up to exactly one particle and sums do
/// not depend on their order: the result is the same on any number of threads.
///
/// The map is kept in tiles that are created when debris first reaches them. Tasks take the particles in their order,
/// sum them in patches of their own and add these to the tiles: cost and memory depend on the debris, not the terrain.
class MapAccumulator {
  public:
    /// The map's corner is the terrain grid's. `arrival_depth`, `map_cell` in m.
    MapAccumulator(const sim::Model& model, const sim::Ground& ground, const sim::State& state, double map_cell,
                   double arrival_depth);

    /// A copy goes on by itself; on a device, with maps of its own.
    explicit MapAccumulator(const MapAccumulator& other);
    MapAccumulator& operator=(const MapAccumulator&) = delete;
    ~MapAccumulator() = default;

    /// Call when model or state were changed between two steps. Peak pressures so far keep the previous density.
    void follow(const sim::Model& model, const sim::State& state);
    /// Reserves memory for this number of particles; call before their number exceeds its previous maximum.
    void make_room(std::size_t particles);

    /// Updates the peaks with the current state. Particles of releases that have not started do not count.
    void add(const sim::State& state);
    /// The same where a device has the particles; their maps are then on it too, until somebody reads them here. It
    /// must live as long as the maps.
    void add(device::Maps& device, const sim::StateSummary& state);

    /// Volume on the map at the last `add`, m3: exactly the particles added.
    [[nodiscard]] double volume() const;

    /// Debris at the last `add`, over the part of the map that contains any; 0 where there is none.
    struct Present {
        int first_column = 0, first_row = 0;  ///< of geometry()
        Grid<float> depth;                    ///< m
        Grid<float> speed;                    ///< depth-averaged, m/s; 0 where debris is too thin
        Grid<float> density;                  ///< depth-averaged, kg/m3; empty: that of the material everywhere
    };
    [[nodiscard]] Present present() const;
    /// At the last `add`, in the cell that a place lies in; nothing outside the map.
    [[nodiscard]] FlowAt at(const PlanPoint& place) const;

    /// Of the whole map.
    [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }

    /// The peaks so far, with the depths of the last `add` as deposit, over the cells that debris reached and a margin.
    [[nodiscard]] HazardMaps maps() const;

    /// Debris thinner than this does not count as having reached a cell, m: a tenth of a layer of particles. Without
    /// it, the edge of a single particle's share would set the peak speed of cells that the particle never entered.
    [[nodiscard]] double thinnest_depth() const { return scale_.thinnest_depth; }

    /// Of the same map.
    template <class Archive>
    void keep(Archive& archive);

  private:
    static constexpr unsigned tile_size = map_tile_size;
    static constexpr std::size_t tile_cells = map_tile_cells;
    static constexpr int column_of(std::size_t cell_in_tile) { return static_cast<int>(cell_in_tile % tile_size); }
    static constexpr int row_of(std::size_t cell_in_tile) { return static_cast<int>(cell_in_tile / tile_size); }

    /// Whole numbers, far below 2^53: they add up exactly. Adjacent, so that one addition does both.
    struct CellSum {
        using Pair = double __attribute__((vector_size(16)));
        Pair pair{};
        [[nodiscard]] double volume() const { return pair[0]; }  // 2^-24 of a particle
        [[nodiscard]] MapSum sum() const { return {pair[0], pair[1]}; }
    };
    struct TileValues : MapArrays<std::array<float, tile_cells>> {
        int column = 0, row = 0;  // of its first cell
        std::uint64_t added = 0;  // the add to which the sums belong
        std::array<CellSum, tile_cells> sums{};
        std::vector<float> density;  // mean, kg/m3, by cell; empty: the rest density
    };
    struct Tile : TileValues {
        tbb::spin_mutex adding;
    };
    struct Shares;
    struct Patch;
    class Patches;

    /// Sums over the cells of all particles, weighted by their speeds or densities.
    void spread_all(const sim::State& state, bool densities);
    /// Finds the mean density of every cell, of particles that have densities of their own.
    void take_densities(const sim::State& state);
    /// Stores peak pressures from now on, as they no longer follow from peak speeds.
    void keep_pressures();
    [[nodiscard]] double density_in(const Tile& tile, std::size_t cell) const {
        return tile.density.empty() ? scale_.rest_density : static_cast<double>(tile.density[cell]);
    }
    /// The shares of the next particles and their cells.
    void find_shares(const sim::State& state, std::size_t first, bool densities, Shares& shares) const;
    /// Adds particles [first, last) to their tiles.
    void spread(const sim::State& state, bool densities, std::size_t first, std::size_t last);
    /// Moves the sums of a patch into the tiles that it lies over.
    void take(Patch& patch);
    /// Created if it does not exist yet.
    Tile& tile_at(unsigned tile_column, unsigned tile_row) const;
    void update_peaks(Tile& tile, double time) const;
    /// Takes the tiles back from the device, if it has newer ones. What a lost device had is lost.
    void read_back() const;
    void send_tiles();
    [[nodiscard]] float peak_pressure(const Tile& tile, std::size_t cell) const;
    /// At the last add.
    [[nodiscard]] CellSum sum_of(const Tile& tile, std::size_t cell) const;
    [[nodiscard]] MapSum sum_at(std::size_t position, std::size_t cell) const;
    [[nodiscard]] double depth(double volume) const { return volume * scale_.depth_of_unit; }
    [[nodiscard]] Extent reached_cells() const;

    GridGeometry geometry_;  // of the whole terrain
    double inverse_cell_ = 0, particle_volume_ = 0;
    MapFrame frame_;
    MapScale scale_;

    unsigned tile_columns_ = 0;
    // What is read back changes them.
    mutable std::vector<Tile*> tile_at_;  // by tile position; null: not reached yet
    mutable std::vector<std::unique_ptr<Tile>> tiles_;
    mutable std::mutex new_tile_;
    mutable std::uint64_t adds_ = 0;     // so far
    mutable std::vector<Tile*> active_;  // reached by the last add, the first active_count_
    mutable std::uint32_t active_count_ = 0;
    PlanPoint first_particle_;  // world, for the frame of an empty map

    device::Maps* device_ = nullptr;
    mutable std::mutex reading_;            // several threads may read between two steps
    mutable bool device_is_newer_ = false;  // than the tiles
    bool device_is_older_ = true;
};

template <class Archive>
void MapAccumulator::keep(Archive& archive) {
    read_back();
    device_is_older_ = true;
    std::size_t count = tiles_.size();
    archive(scale_, adds_, count);
    if constexpr (Archive::reading) {
        active_count_ = 0;
    } else {  // threads made them in any order
        std::sort(tiles_.begin(), tiles_.end(), [](const auto& a, const auto& b) {
            return a->row != b->row ? a->row < b->row : a->column < b->column;
        });
    }
    for (std::size_t k = 0; k < count; ++k) {
        unsigned column = 0, row = 0;  // in tiles
        if constexpr (!Archive::reading) {
            column = static_cast<unsigned>(tiles_[k]->column + 1) / tile_size;
            row = static_cast<unsigned>(tiles_[k]->row + 1) / tile_size;
        }
        archive(column, row);
        if constexpr (Archive::reading) {
            const bool on_map = column < tile_columns_ && std::size_t{row} * tile_columns_ + column < tile_at_.size();
            if (!on_map || archive.failed()) return archive.fail();
        }
        Tile& tile = tile_at(column, row);
        archive(tile.added, tile.sums);
        for_each_map_array([&](auto& array) { archive(array); }, tile);
        archive(tile.density);
        if constexpr (Archive::reading) {
            if (tile.added != adds_) continue;
            active_.resize(std::max<std::size_t>(active_.size(), active_count_ + 1));
            active_[active_count_++] = &tile;
        }
    }
}

}  // namespace talus::observe
