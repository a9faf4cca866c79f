#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/device/array.hpp"
#include "sim/device/backend.hpp"
#include "sim/device/reductions.hpp"
#include "sim/device/search_kernels.hpp"
#include "sim/device/views.hpp"

// clang-format off
/// What a fault is explained with: X(element, name).
#define TALUS_KEPT_ARRAYS(X)                                                                                           \
    X(LocalPoint, position)                                                                                            \
    X(LocalPoint, velocity)                                                                                            \
    X(std::uint32_t, id)                                                                                               \
    X(std::uint8_t, held)                                                                                              \
    X(std::uint8_t, asleep)
// clang-format on

namespace talus::sim::device {

/// What lies on the device: model, ground and particles, and the work arrays of a step. Measurements read it as the
/// stages do, with the same executor.
template <class Executor>
class Resident : public Backend {
  public:
    void follow(const Model& model, const Ground& ground, const State& state) override {
        follow_model(model);
        follow_ground(ground);
        reserve(needs_of(model, ground), state.room());
#define TALUS_UPLOAD(array, element, name) upload(state.name, state.count, name##_);
        TALUS_PARTICLE_ARRAYS(TALUS_UPLOAD)
#undef TALUS_UPLOAD
        density_of_id_.upload(state.density_of_id);
        data_.state.density_of_id = {density_of_id_.data(), state.density_of_id.size()};
        entry_of_id_.upload(state.entry_of_id);
        data_.state.entry_of_id = {entry_of_id_.data(), state.entry_of_id.size()};
        soil_of_id_.upload(state.soil_of_id);
        data_.state.soil_of_id = {soil_of_id_.data(), state.soil_of_id.size()};
    }

    void fetch(State& state) override {
#define TALUS_DOWNLOAD(array, element, name) download(name##_, state.count, state.name);
        TALUS_PARTICLE_ARRAYS(TALUS_DOWNLOAD)
#undef TALUS_DOWNLOAD
        if (!state.soil_of_id.empty()) soil_of_id_.download(state.soil_of_id);
    }

    void keep(const StateSummary& state) override {
#define TALUS_KEEP(element, name) executor_.copy(kept_##name##_.data(), name##_.data(), state.count * sizeof(element));
        TALUS_KEPT_ARRAYS(TALUS_KEEP)
#undef TALUS_KEEP
    }
    void fetch_kept(State& state) override {
#define TALUS_DOWNLOAD(element, name) download(kept_##name##_, state.count, state.name);
        TALUS_KEPT_ARRAYS(TALUS_DOWNLOAD)
#undef TALUS_DOWNLOAD
    }

    [[nodiscard]] Motion count_motion(const StateSummary& state, const MotionCount& fast) const override {
        return executor_.template reduce<Motion>(state.count, Motion{}, MotionOf{data_, fast}, Add{});
    }

    [[nodiscard]] PlaceSum sum_places(const StateSummary& state, std::uint32_t first,
                                      std::uint32_t last) const override {
        return executor_.template reduce<PlaceSum>(state.count, PlaceSum{}, PlaceOf{data_, first, last}, Add{});
    }

    [[nodiscard]] std::string name() const override {
        return executor_.name();
    }
    [[nodiscard]] std::size_t bytes() const override {
        return executor_.bytes();
    }
    [[nodiscard]] Traffic traffic() const override {
        return executor_.traffic();
    }

    [[nodiscard]] Executor& executor() const {
        return executor_;
    }
    [[nodiscard]] const Data& data() const {
        return data_;
    }

  protected:
    template <class T>
    using Memory = Array<T, Executor>;

    /// What only some runs need.
    struct Needs {
        bool stress = true, resistance = false, walls = false;
    };
    static Needs needs_of(const Model& model, const Ground& ground) {
        return {model.solver.internal_friction == params::InternalFriction::stress, resists_by_particle(model),
                !ground.solids.empty()};
    }

    /// Takes over what changes in every step.
    void follow_water(const StateSummary& state) {
        if (!state.water_of_release.empty()) water_of_release_.upload(state.water_of_release);
        data_.state.water_of_release = {water_of_release_.data(), state.water_of_release.size()};
    }

    /// Puts the first `count` particles of `order` first, in that order.
    void reorder(std::size_t count) {
        gathered_.reserve(count * sizeof(Deviator<float>));
#define TALUS_GATHER(array, element, name) gather(name##_, count);
        TALUS_PARTICLE_ARRAYS(TALUS_GATHER)
#undef TALUS_GATHER
    }
    [[nodiscard]] Bounds bounds(const State& state, float time_step) const {
        return executor_.template reduce<Bounds>(state.count, Bounds{}, BoundsOf{data_, time_step}, JoinBounds{});
    }

    mutable Executor executor_;  // reading a sum takes memory of the device
    Data data_{};
    Needs needs_;
    Memory<std::uint32_t> list_start_{executor_};

  private:
    void follow_model(const Model& model) {
        std::vector<ReleaseView> releases;
        for (const ReleaseGroup& release : model.releases) {
            releases.push_back({release.start_time, release.first_particle, release.last_particle,
                                release.pore_pressure_ratio, release.solid_fraction});
        }
        releases_.upload(releases);
        const BoundaryNodes tables = model.boundary.nodes();
        const auto keep = [](Memory<Quad>& memory, const Quad* from, int count) {
            memory.upload({from, static_cast<std::size_t>(count)});
            return memory.data();
        };
        static_cast<ModelValues&>(data_.model) = model;
        data_.model.releases = {releases_.data(), releases.size()};
        data_.model.boundary = tables;
        data_.model.boundary.nodes = keep(boundary_nodes_, tables.nodes, tables.node_count);
        data_.model.boundary.by_slope = keep(by_slope_, tables.by_slope, tables.by_slope_count);
        data_.model.boundary.sticking = keep(sticking_, tables.sticking, tables.sticking_count);
        data_.model.cover = model.cover.field();
        if (!model.cover.empty()) {
            cover_.upload(model.cover.cells());
            data_.model.cover.cells = cover_.data();
        }
    }

    void follow_ground(const Ground& ground) {
        data_.ground.terrain = ground.terrain.field();
        terrain_.upload({ground.terrain.field().nodes, ground.terrain.elevation().values.size()});
        data_.ground.terrain.nodes = terrain_.data();
        terrain::SolidWalls walls = ground.solids.walls();
        if (!ground.solids.empty()) {
            edges_.upload(ground.solids.edges());
            solids_.upload(ground.solids.solids());
            bin_starts_.upload(ground.solids.bins().starts());
            bin_items_.upload(ground.solids.bins().items());
        }
        walls.edges = edges_.data();
        walls.solids = solids_.data();
        walls.bins.start = bin_starts_.data();
        walls.bins.items = bin_items_.data();
        data_.ground.solids = walls;
    }

    void reserve(const Needs& needs, std::size_t room) {
        needs_ = needs;
#define TALUS_RESERVE(array, element, name) \
    name##_.reserve(room);                  \
    data_.state.name = name##_.data();
        TALUS_PARTICLE_ARRAYS(TALUS_RESERVE)
#undef TALUS_RESERVE
#define TALUS_RESERVE(element, name, when)      \
    if (when) work_##name##_.reserve(room + 1); \
    data_.work.name = work_##name##_.data();
        TALUS_DEVICE_ARRAYS(TALUS_RESERVE)
#undef TALUS_RESERVE
        list_start_.reserve(room / list_width + 2);
#define TALUS_RESERVE(element, name) kept_##name##_.reserve(room);
        TALUS_KEPT_ARRAYS(TALUS_RESERVE)
#undef TALUS_RESERVE
    }

    template <class T, class From>
    void upload(const From& from, std::size_t count, Memory<T>& to) {
        staging_.resize(count * sizeof(T));
        T* const packed = reinterpret_cast<T*>(staging_.data());
        for (std::size_t i = 0; i < count; ++i) {
            if constexpr (
                requires { from.at(i); } && !requires { from.data(); }) {
                packed[i] = from.at(i);
            } else {
                packed[i] = from[i];
            }
        }
        executor_.upload(to.data(), packed, count * sizeof(T));
    }
    template <class T, class To>
    void download(const Memory<T>& from, std::size_t count, To& to) {
        staging_.resize(count * sizeof(T));
        const T* const packed = reinterpret_cast<const T*>(staging_.data());
        executor_.download(staging_.data(), from.data(), count * sizeof(T));
        for (std::size_t i = 0; i < count; ++i) {
            if constexpr (requires { to.set(i, packed[i]); }) {
                to.set(i, packed[i]);
            } else {
                to[i] = packed[i];
            }
        }
    }

    template <class T>
    void gather(Memory<T>& memory, std::size_t count) {
        static_assert(sizeof(T) <= sizeof(Deviator<float>));
        T* const to = reinterpret_cast<T*>(gathered_.data());
        executor_.for_each(count, Gather<T>{memory.data(), to, data_.work.order});
        executor_.copy(memory.data(), to, count * sizeof(T));
    }

    std::vector<std::byte> staging_;

#define TALUS_MEMBER(array, element, name) Memory<element> name##_{executor_};
    TALUS_PARTICLE_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
#define TALUS_MEMBER(element, name, when) Memory<element> work_##name##_{executor_};
    TALUS_DEVICE_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
#define TALUS_MEMBER(element, name) Memory<element> kept_##name##_{executor_};
    TALUS_KEPT_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
    Memory<float> density_of_id_{executor_};
    Memory<Entry> entry_of_id_{executor_};
    Memory<Soil<float>> soil_of_id_{executor_};
    Memory<Water> water_of_release_{executor_};
    Memory<ReleaseView> releases_{executor_};
    Memory<Quad> boundary_nodes_{executor_}, by_slope_{executor_}, sticking_{executor_};
    Memory<Quad> cover_{executor_}, terrain_{executor_};
    Memory<terrain::WallEdge> edges_{executor_};
    Memory<terrain::WallSolid> solids_{executor_};
    Memory<std::uint32_t> bin_starts_{executor_}, bin_items_{executor_};
    Memory<std::byte> gathered_{executor_};
};

}  // namespace talus::sim::device
