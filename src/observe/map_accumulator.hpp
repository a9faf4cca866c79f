#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/grid.hpp"
#include "observe/observation.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus {

/// Peak maps, accumulated after every step.
///
/// Every particle spreads its volume, and its volume times its speed, over 3 x 3 map cells with a quadratic B-spline:
/// with cells of about 2.5 spacings, depth over a uniform sheet is even to a few per cent. Weights and speeds are whole
/// numbers (2^-24 of a particle, 2^-10 m/s), so a particle's shares add up to exactly one particle and sums do not
/// depend on their order: the result is the same on any number of threads.
///
/// The map is kept in tiles that exist from when debris first touches them. A step sorts the particles into tiles, and
/// one task per tile adds them up: cost and memory follow the debris, not the terrain.
class MapAccumulator {
  public:
    /// The map's corner is the terrain grid's. `arrival_depth`, `map_cell` in m.
    MapAccumulator(const Model& model, const State& state, double map_cell, double arrival_depth);

    /// Takes the present state into the peaks. Particles of releases that have not started do not count.
    void add(const State& state);

    /// Depth-averaged speed, m/s, at a local position as of the last `add`; 0 where debris is too thin to tell.
    [[nodiscard]] double speed_at(const LocalPoint& p) const;

    /// Volume on the map as of the last `add`, m3: exactly the particles added.
    [[nodiscard]] double volume() const;

    /// The peaks so far, with the depths of the last `add` as deposit, over the cells that debris reached and a margin.
    [[nodiscard]] HazardMaps maps() const;

    /// Debris thinner than this does not count as having reached a cell, m: a tenth of a layer of particles. Without
    /// it, the rim of a lone particle's share would set the peak speed of cells that the particle never entered.
    [[nodiscard]] double thinnest_depth() const { return thinnest_depth_; }

  private:
    static constexpr int tile_size = 8;  // cells along an edge
    static constexpr std::size_t tile_cells = static_cast<std::size_t>(tile_size) * tile_size;

    struct Tile {
        int column = 0, row = 0;                          // of its first cell
        std::array<std::int64_t, tile_cells> volume{};    // 2^-24 of a particle, as of the last add
        std::array<std::int64_t, tile_cells> momentum{};  // the same times 2^-10 m/s
        std::array<float, tile_cells> peak_depth{};       // 0: not reached
        std::array<float, tile_cells> peak_speed{};       // depth-averaged
        std::array<float, tile_cells> arrival_time{};     // NaN: never
    };
    /// The cell that a particle is in; column -1: it does not count.
    struct Cell {
        int column, row;
    };

    [[nodiscard]] Cell cell_of(const LocalPoint& p) const;
    void locate_particles(const State& state);
    /// Calls f(tile position, particles, how many) for particles [first, last): each comes once per tile that its cells
    /// lie in, neighbours in the order of the state together.
    template <class F>
    void for_each_run(std::size_t first, std::size_t last, const F& f) const;
    void sort_into_tiles(const State& state);
    void sum_up(Tile& tile, const State& state, std::size_t first, std::size_t last) const;
    void update_peaks(Tile& tile, double time) const;
    [[nodiscard]] double depth(std::int64_t volume) const { return static_cast<double>(volume) * depth_of_unit_; }
    [[nodiscard]] Extent reached_cells() const;

    GridGeometry geometry_;  // of the whole terrain
    double x_offset_ = 0, y_offset_ = 0, inverse_cell_ = 0;
    double particle_volume_ = 0, rest_density_ = 0;
    double depth_of_unit_ = 0, thinnest_depth_ = 0, arrival_depth_ = 0;

    int tile_columns_ = 0;
    std::vector<std::int32_t> tile_at_;      // index into tiles_ by tile position, -1: not touched yet
    std::vector<std::uint32_t> tile_count_;  // particles of this step by tile position, then where the next one goes
    std::vector<std::unique_ptr<Tile>> tiles_;
    std::vector<std::uint32_t> active_;  // tile positions touched in this step, the first active_count_
    std::uint32_t active_count_ = 0;
    std::vector<Cell> cell_;                  // by particle
    std::vector<std::uint32_t> entry_start_;  // by place in active_
    std::vector<std::uint32_t> entries_;      // particles by tile
    PlanPoint first_particle_;                // world, for the frame of an empty map
};

}  // namespace talus
