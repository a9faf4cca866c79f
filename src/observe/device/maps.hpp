#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "observe/map_shares.hpp"

namespace talus::observe::device {

/// The sums of a cell as a device adds them: whole numbers, in any order.
struct WholeSum {
    unsigned long long volume, weighted;

    [[nodiscard]] TALUS_DEVICE MapSum sum() const {
        return {static_cast<double>(volume), static_cast<double>(weighted)};
    }
};

/// Tiles as they are copied: those of a MapAccumulator in any order, the cells of each one after another.
struct Tiles : MapArrays<std::vector<float>> {
    std::vector<std::uint32_t> position;  ///< of each tile
    std::vector<WholeSum> sum;            ///< of the last step
    std::vector<float> density;
    std::vector<std::uint8_t> active;  ///< by tile: the last step reached it

    void resize(std::size_t tiles) {
        position.resize(tiles);
        active.resize(tiles);
        sum.resize(tiles * map_tile_cells);
        density.resize(tiles * map_tile_cells);
        for_each_map_array([&](auto& values) { values.resize(tiles * map_tile_cells); }, *this);
    }
};

/// The tiles of a MapAccumulator on a device.
class Maps {
  public:
    Maps() = default;
    Maps(const Maps&) = delete;
    Maps& operator=(const Maps&) = delete;
    virtual ~Maps() = default;

    /// Whether particles have densities of their own.
    [[nodiscard]] virtual bool own_densities() const = 0;
    /// Takes the tiles over. `positions`: how many there can be.
    virtual void send(const Tiles& tiles, std::size_t positions, unsigned tile_columns) = 0;
    /// Updates them with the particles that are on the device.
    virtual void add(const MapFrame& frame, const MapScale& scale, std::uint32_t count, double time) = 0;
    /// Copies all of them back.
    virtual void read(Tiles& tiles) = 0;
    /// The sums of one cell after the last step.
    [[nodiscard]] virtual MapSum sum_at(std::size_t position, std::size_t cell) = 0;
};

}  // namespace talus::observe::device
