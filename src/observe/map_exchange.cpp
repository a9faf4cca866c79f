// The tiles of a MapAccumulator on a device and back.
#include <algorithm>

#include "observe/device/maps.hpp"
#include "observe/map_accumulator.hpp"
#include "sim/device/backend.hpp"

namespace talus::observe {

void MapAccumulator::send_tiles() {
    device::Tiles tiles;
    tiles.resize(tiles_.size());
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
        const Tile& tile = *tiles_[t];
        tiles.position[t] = static_cast<std::uint32_t>((tile.row + 1) / static_cast<int>(tile_size)) * tile_columns_ +
                            static_cast<std::uint32_t>((tile.column + 1) / static_cast<int>(tile_size));
        const auto at = static_cast<std::ptrdiff_t>(t * tile_cells);
        for_each_map_array([&](const auto& from, auto& to) { std::copy(from.begin(), from.end(), to.begin() + at); },
                           tile, tiles);
        std::fill_n(tiles.density.begin() + at, tile_cells, static_cast<float>(scale_.rest_density));
        std::copy(tile.density.begin(), tile.density.end(), tiles.density.begin() + at);
    }
    device_->send(tiles, tile_at_.size(), tile_columns_);
    device_is_older_ = false;
}

void MapAccumulator::add(device::Maps& device, const sim::StateSummary& state) {
    if (device.own_densities() && !scale_.keeps_pressures) {
        read_back();
        keep_pressures();
        device_is_older_ = true;
    }
    if (device_ != &device || device_is_older_) {
        read_back();
        device_ = &device;
        send_tiles();
    }
    device.add(frame_, scale_, state.count, state.time);
    device_is_newer_ = true;
}

void MapAccumulator::read_back() const {
    const std::scoped_lock lock(reading_);
    if (!device_is_newer_) return;
    device_is_newer_ = false;
    device::Tiles tiles;
    try {
        device_->read(tiles);
    } catch (const sim::device::DeviceFailure&) {
        return;
    }
    ++adds_;
    active_count_ = 0;
    active_.resize(std::max(active_.size(), tiles.position.size()));
    for (std::size_t t = 0; t < tiles.position.size(); ++t) {
        Tile& tile = tile_at(tiles.position[t] % tile_columns_, tiles.position[t] / tile_columns_);
        const auto at = static_cast<std::ptrdiff_t>(t * tile_cells);
        for (std::size_t cell = 0; cell < tile_cells; ++cell) {
            const MapSum sum = tiles.sum[t * tile_cells + cell].sum();
            tile.sums[cell].pair = CellSum::Pair{sum.volume, sum.weighted};
        }
        for_each_map_array([&](const auto& from, auto& to) { std::copy_n(from.begin() + at, tile_cells, to.begin()); },
                           tiles, tile);
        if (device_->own_densities()) {
            tile.density.assign(tiles.density.begin() + at, tiles.density.begin() + at + tile_cells);
        }
        tile.added = adds_;
        if (tiles.active[t] != 0) active_[active_count_++] = &tile;
    }
}

MapSum MapAccumulator::sum_at(std::size_t position, std::size_t cell) const {
    {
        const std::scoped_lock lock(reading_);
        if (device_is_newer_) return device_->sum_at(position, cell);
    }
    const Tile* tile = tile_at_[position];
    return tile != nullptr ? sum_of(*tile, cell).sum() : MapSum{};
}

}  // namespace talus::observe
