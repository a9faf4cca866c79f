#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "observe/device/kernels.hpp"
#include "observe/device/particles.hpp"
#include "sim/device/resident.hpp"

namespace talus::observe::device {

/// The tiles of a map in the memory of an executor. They grow as debris reaches new ground.
template <class Executor>
class MapsOn final : public Maps {
  public:
    explicit MapsOn(const sim::device::Resident<Executor>& particles)
        : particles_(particles), executor_(particles.executor()) {}

    [[nodiscard]] bool own_densities() const override { return !particles_.data().state.density_of_id.empty(); }

    void send(const Tiles& from, std::size_t positions, unsigned tile_columns) override {
        positions_ = positions;
        arrays_.tile_columns = tile_columns;
        count_ = static_cast<std::uint32_t>(from.position.size());
        std::vector<std::uint32_t> index_at(positions, 0);
        for (std::uint32_t t = 0; t < count_; ++t) index_at[from.position[t]] = t + 1;
        index_at_.upload(index_at);
        active_.reserve(positions);
        missing_.reserve(1);
        index_.reserve(positions + 1);
        position_of_.upload(from.position);
        for_each_array([&](auto& array, const auto& values) { array.upload(values); }, from);
        point_at_arrays();
    }

    void add(const MapFrame& map, const MapScale& scale, std::uint32_t count, double time) override {
        make_tiles(map, count);
        const sim::device::Data& d = particles_.data();
        if (own_densities()) {
            executor_.for_each(cells(), ClearSum{arrays_});
            executor_.for_each(count, SpreadOnMap{d, map, arrays_, scale.rest_density});
            executor_.for_each(cells(), KeepDensity{arrays_, scale});
        }
        executor_.for_each(cells(), ClearSum{arrays_});
        executor_.for_each(count, SpreadOnMap{d, map, arrays_, 0});
        executor_.for_each(cells(), UpdateCell{arrays_, scale, time, own_densities()});
    }

    void read(Tiles& to) override {
        to.resize(count_);
        position_of_.download(to.position);
        active_by_index_.reserve(count_);
        executor_.for_each(count_, ActiveByIndex{arrays_, position_of_.data(), active_by_index_.data()});
        active_by_index_.download(to.active);
        for_each_array([](const auto& array, auto& values) { array.download(values); }, to);
    }

    [[nodiscard]] MapSum sum_at(std::size_t position, std::size_t cell) override {
        std::uint32_t index = 0;
        executor_.download(&index, arrays_.index_at + position, sizeof index);
        if (index == 0) return {};
        WholeSum sum{};
        executor_.download(&sum, arrays_.sum + (index - 1) * map_tile_cells + cell, sizeof sum);
        return sum.sum();
    }

  private:
    template <class T>
    using Memory = sim::device::Array<T, Executor>;

    [[nodiscard]] std::size_t cells() const { return count_ * map_tile_cells; }

    /// f(array here, the same of `tiles`) for what there is by cell.
    template <class F, class AnyTiles>
    void for_each_array(const F& f, AnyTiles& tiles) {
        f(sum_, tiles.sum);
        for_each_map_array(f, kept_, tiles);
        f(density_, tiles.density);
    }

    void point_at_arrays() {
        arrays_ = {{},          index_at_.data(), active_.data(), missing_.data(), arrays_.tile_columns,
                   sum_.data(), density_.data()};
        for_each_map_array([](float*& to, Memory<float>& from) { to = from.data(); }, arrays_, kept_);
    }

    /// Makes the tiles that debris reaches for the first time.
    void make_tiles(const MapFrame& map, std::uint32_t particles) {
        executor_.for_each(positions_, ClearByte{active_.data()});
        executor_.for_each(1, ClearByte{missing_.data()});
        executor_.for_each(particles, MarkTiles{particles_.data(), map, arrays_});
        std::uint8_t missing = 0;
        executor_.download(&missing, missing_.data(), sizeof missing);
        if (missing == 0) return;
        executor_.for_each(positions_, CountMissing{arrays_, index_.data()});
        const std::uint32_t made = executor_.sum_up(index_.data(), positions_);
        grow(count_ + made);
        executor_.for_each(positions_, GiveTiles{arrays_, index_.data(), position_of_.data(), count_});
        executor_.for_each(made * map_tile_cells, ClearCell{arrays_, static_cast<std::uint32_t>(cells())});
        count_ += made;
    }

    /// Room for so many tiles, and half as many more.
    void grow(std::size_t tiles) {
        if (tiles <= position_of_.size()) return;
        const std::size_t room = tiles + tiles / 2;
        enlarge(position_of_, count_, room);
        enlarge(sum_, cells(), room * map_tile_cells);
        for_each_map_array([&](auto& array) { enlarge(array, cells(), room * map_tile_cells); }, kept_);
        enlarge(density_, cells(), room * map_tile_cells);
        point_at_arrays();
    }
    /// Keeps the first `kept` elements.
    template <class T>
    void enlarge(Memory<T>& array, std::size_t kept, std::size_t room) {
        Memory<T> before(executor_);
        before.reserve(kept);
        executor_.copy(before.data(), array.data(), kept * sizeof(T));
        array.reserve(room);
        executor_.copy(array.data(), before.data(), kept * sizeof(T));
    }

    const sim::device::Resident<Executor>& particles_;
    Executor& executor_;
    std::size_t positions_ = 0;
    std::uint32_t count_ = 0;  // of tiles
    TileArrays arrays_{};
    Memory<std::uint32_t> index_at_{executor_}, index_{executor_}, position_of_{executor_};
    Memory<std::uint8_t> active_{executor_}, missing_{executor_}, active_by_index_{executor_};
    Memory<WholeSum> sum_{executor_};
    MapArrays<Memory<float>> kept_ = made_map_arrays([this] { return Memory<float>(executor_); });
    Memory<float> density_{executor_};
};

template <class Executor>
class ParticlesOn final : public Particles {
  public:
    explicit ParticlesOn(const sim::device::Resident<Executor>& particles)
        : particles_(particles), executor_(particles.executor()), maps_(particles) {}

    void forget_walls() override { walls_known_ = false; }

    [[nodiscard]] ParticleSums sums(const sim::StateSummary& state, double deposited_speed) override {
        return executor_.template reduce<ParticleSums>(state.count, ParticleSums{},
                                                       SumsOf{particles_.data(), deposited_speed}, sim::device::Add{});
    }

    void find_on_path(const sim::StateSummary& state, const terrain::FlowPath& path, const PlanPoint& origin,
                      double from, Debris::OnPath& result) override {
        if (path_.segments == nullptr) send(path);
        result.held =
            executor_.template reduce<std::uint32_t>(state.count, 0, IsHeld{particles_.data()}, sim::device::Add{});
        find(state.count, OnPathBeyond{particles_.data(), {path_, origin, from}}, on_path_, result.found);
        result.count = static_cast<std::uint32_t>(result.found.size());
    }

    void find_beside_walls(const sim::StateSummary& state, const WallPatches& patches,
                           std::vector<WallParticle>& found) override {
        if (!walls_known_) {
            walls_ = patches.bins().view();
            wall_starts_.upload(patches.bins().starts());
            wall_items_.upload(patches.bins().items());
            walls_.start = wall_starts_.data();
            walls_.items = wall_items_.data();
            walls_known_ = true;
        }
        find(state.count, BesideWalls{particles_.data(), walls_}, beside_walls_, found);
    }

    void find_inside(const sim::StateSummary& state, const PlanRectangle& rectangle, bool released,
                     std::vector<PlacedParticle>& found) override {
        find(state.count, Inside{particles_.data(), rectangle, released}, inside_, found);
    }

    [[nodiscard]] Maps& maps() override { return maps_; }

  private:
    template <class T>
    using Memory = sim::device::Array<T, Executor>;

    /// Brings over what a choice takes, in the order of the particles.
    template <class Choice, class Item>
    void find(std::size_t count, const Choice& choice, Memory<Item>& chosen, std::vector<Item>& found) {
        executor_.for_each(count, Mark<Choice>{choice});
        found.resize(count == 0 ? 0 : executor_.sum_up(particles_.data().work.index, count));
        if (found.empty()) return;
        if (found.size() > chosen.size()) chosen.reserve(found.size() + found.size() / 2);
        executor_.for_each(count, Take<Choice>{choice, chosen.data()});
        chosen.download(found);
    }

    void send(const terrain::FlowPath& path) {
        path_ = path.field();
        const auto keep = [](auto& memory, auto*& array, std::size_t size) {
            memory.upload({array, size});
            array = memory.data();
        };
        const std::size_t points = path.points().size();
        keep(segments_, path_.segments, points - 1);
        keep(chainage_, path_.chainage, points);
        keep(around_, path_.around, points - 1);
        keep(nearest_, path_.nearest, path_.cells());
        keep(bound_, path_.bound, path_.cells());
    }

    const sim::device::Resident<Executor>& particles_;
    Executor& executor_;
    MapsOn<Executor> maps_;
    terrain::PathField path_;
    Memory<terrain::PathSegment> segments_{executor_};
    Memory<double> chainage_{executor_};
    Memory<terrain::SegmentRange> around_{executor_};
    Memory<std::int32_t> nearest_{executor_};
    Memory<float> bound_{executor_};
    terrain::PlanBinItems walls_;
    bool walls_known_ = false;
    Memory<std::uint32_t> wall_starts_{executor_}, wall_items_{executor_};
    Memory<PathParticle> on_path_{executor_};
    Memory<WallParticle> beside_walls_{executor_};
    Memory<PlacedParticle> inside_{executor_};
};

/// For a backend whose executor is this one; nullptr for others.
template <class Executor>
[[nodiscard]] std::unique_ptr<Particles> particles_on(const sim::device::Backend& backend) {
    const auto* const particles = dynamic_cast<const sim::device::Resident<Executor>*>(&backend);
    return particles != nullptr ? std::make_unique<ParticlesOn<Executor>>(*particles) : nullptr;
}

}  // namespace talus::observe::device
