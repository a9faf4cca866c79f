#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "sim/compression.hpp"
#include "sim/device/array.hpp"
#include "sim/device/backend.hpp"
#include "sim/device/pair_kernels.hpp"
#include "sim/device/particle_kernels.hpp"
#include "sim/device/search_kernels.hpp"
#include "sim/device/stress_kernels.hpp"
#include "sim/device/views.hpp"

namespace talus::sim::device {

struct CompressionOf {
    const float *compression{}, *before{};

    TALUS_DEVICE CompressionSum operator()(std::uint32_t i) const {
        CompressionSum own;
        own.add(compression[i], before[i]);
        return own;
    }
};
struct JoinCompression {
    TALUS_DEVICE CompressionSum operator()(const CompressionSum& a, const CompressionSum& b) const { return a + b; }
};
struct IsAwake {
    const std::uint8_t* asleep;

    TALUS_DEVICE std::uint32_t operator()(std::uint32_t i) const { return asleep[i] == 0 ? 1 : 0; }
};
struct CountOf {
    const std::uint32_t* counts;

    TALUS_DEVICE std::uint64_t operator()(std::uint32_t i) const { return counts[i]; }
};
struct Add {
    template <class Number>
    TALUS_DEVICE Number operator()(const Number& a, const Number& b) const {
        return a + b;
    }
};
/// The greater of two; NaN takes precedence, or it would be missed.
struct GreaterOrUnknown {
    TALUS_DEVICE float operator()(float a, float b) const { return a != a || b <= a ? a : b; }
};

/// The stages on what an executor runs (host_executor.hpp has its interface). Lists of neighbours, cells and columns
/// grow when debris needs more than ever before; nothing else is allocated after follow().
template <class Executor>
class BackendOn final : public Backend {
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
    }

    void fetch(State& state) override {
#define TALUS_DOWNLOAD(array, element, name) download(name##_, state.count, state.name);
        TALUS_PARTICLE_ARRAYS(TALUS_DOWNLOAD)
#undef TALUS_DOWNLOAD
    }

    void release_held(const Model&, State& state) override {
        executor_.for_each(state.count, ReleaseHeld{data_, state.time});
    }

    void apply_drag(const Model& model, const Ground&, State& state) override {
        if (!slows_by_speed(model) || state.count == 0) return;
        const ColumnBox box = column_box(model, bounds(state, 0));
        executor_.for_each(static_cast<std::size_t>(box.columns * box.rows), ClearColumns{box});
        executor_.for_each(state.count, CountColumns{data_, box});
        executor_.for_each(state.count, Drag{data_, box, static_cast<float>(state.time_step)});
    }

    void predict_positions(const Model& model, const Ground&, State& state) override {
        executor_.for_each(state.count, ApplyGravity{data_, static_cast<float>(model.gravity * state.time_step)});
    }

    void sort_particles(const Model& model, State& state) override {
        if (state.count == 0) return;
        const auto time_step = static_cast<float>(state.time_step);
        box_ = CellBox(bounds(state, time_step), model.support_radius);
        executor_.for_each(state.count, CellKeys{data_, box_, time_step});
        executor_.sort(data_.work.key, data_.work.key_swap, data_.work.order, data_.work.order_swap, state.count,
                       box_.key_bits + 1);
        reorder(state.count);
    }

    void find_neighbours(const Model& model, State& state) override {
        state.awake = executor_.template reduce<std::uint32_t>(state.count, 0, IsAwake{data_.state.asleep}, Add{});
        if (state.count == 0) return;
        executor_.for_each(state.count,
                           Begin{data_, static_cast<float>(state.time_step), !data_.ground.solids.empty()});
        const Cells cells = list_cells(state);
        const auto radius = static_cast<float>(model.support_radius);
        executor_.for_each(state.awake, CountNeighbours{data_, cells, radius * radius});
        const std::size_t groups = (state.awake + list_width - 1) / list_width;
        executor_.for_each(groups, MeasureLists{data_, list_start_.data(), state.awake});
        const std::uint32_t size = executor_.sum_up(list_start_.data(), groups);
        if (size > neighbour_.size()) neighbour_.reserve(size + size / 8);
        data_.neighbours = {list_start_.data(), data_.work.neighbour_count, neighbour_.data()};
        executor_.for_each(state.awake, WriteLists{data_, cells, radius * radius, neighbour_.data()});
        searched_ = state.awake;
    }

    void prepare_particles(const Model& model, const Ground&, State& state) override {
        if (!needs_.resistance) return;
        const double before = state.previous_time_step;  // multipliers are still those of the last step
        executor_.for_each(state.awake,
                           Resist{data_, static_cast<float>(strength_per_pascal(model, state.time_step)),
                                  static_cast<float>(before > 0 ? -1 / (before * before) : 0), state.time});
    }

    void warm_start(const Model& model, const Ground&, State& state) override {
        with_pairs(model, [&]<class Smoothing>(const PairKernel<Smoothing>& pair) {
            if (needs_.stress) {
                const double ratio = state.previous_time_step > 0 ? state.time_step / state.previous_time_step : 0;
                const auto scale = static_cast<float>(ratio * ratio);
                const std::uint32_t asleep = state.count - state.awake;
                executor_.for_each(state.awake, Linearise<Smoothing>{data_, pair, softness(model), scale});
                executor_.for_each(asleep, PressAsleep{data_, scale, state.awake});
                executor_.for_each(state.awake, ApplyStress<Smoothing>{data_, pair});
                executor_.for_each(asleep, ClearAsleep{data_, state.awake});
            } else {
                const double undone = model.solver.depenetration_speed * state.time_step / model.particle_spacing;
                executor_.for_each(state.awake, FindTolerated<Smoothing>{data_, pair, static_cast<float>(undone)});
            }
        });
        state.previous_time_step = state.time_step;
    }

    void solve_density(const Model& model, const Ground&, State& state) override {
        const auto factor = static_cast<float>(jacobi_factor(model.solver.under_relaxation, model.kernel));
        with_pairs(model, [&]<class Smoothing>(const PairKernel<Smoothing>& pair) {
            if (needs_.stress) {
                const auto cohesion = static_cast<float>(internal_strength(model, state.time_step));
                const auto grain_size =
                    static_cast<float>(model.inertial_friction.grain_size / model.kernel.gradient_moment);
                executor_.for_each(
                    state.awake, SolveStress<Smoothing>{data_, pair, factor, cohesion, grain_size, needs_.resistance});
                executor_.for_each(state.awake, ApplyStress<Smoothing>{data_, pair});
            } else {
                const auto cap = static_cast<float>(pair_friction_cap(model.internal_friction_coefficient));
                executor_.for_each(state.awake, UpdateMultipliers<Smoothing>{data_, pair, softness(model), factor});
                executor_.for_each(state.awake, ApplyPairs<Smoothing>{data_, pair, cap});
            }
        });
    }

    void solve_contacts(const Model&, const Ground&, State& state) override {
        executor_.for_each(state.awake, Contacts{data_, needs_.resistance, !needs_.stress});
    }

    void measure_compression(const Model&, State& state) override {
        const CompressionOf of{data_.work.compression, data_.work.tolerated_compression};
        executor_.template reduce<CompressionSum>(state.awake, {}, of, JoinCompression{}).write(state, state.count);
    }

    void undo_overlaps(const Model& model, const Ground&, State& state) override {
        if (needs_.stress) {
            const auto factor = static_cast<float>(jacobi_factor(model.solver.under_relaxation, model.kernel));
            const auto share = static_cast<float>(spreading_share(state.time_step));
            executor_.for_each(state.awake, FindSpread{data_, factor, share});
            with_pairs(model, [&]<class Smoothing>(const PairKernel<Smoothing>& pair) {
                executor_.for_each(state.awake, Spread<Smoothing>{data_, pair});
            });
        }
        executor_.for_each(state.awake, UndoOverlaps{data_, needs_.stress});
    }

    void enforce_boundaries(const Model&, const Ground&, State& state) override {
        executor_.for_each(state.awake, Finish{data_, static_cast<float>(1 / state.time_step)});
    }

    void update_velocities(const Model&, const Ground&, State& state) override {
        state.max_speed =
            std::sqrt(executor_.template reduce<float>(state.awake, 0, SpeedSquare{data_}, GreaterOrUnknown{}));
    }

    void measure_impacts(const Model&, const Ground&, State& state) override {
        state.building_contacts.clear();
        if (!needs_.walls) return;
        executor_.for_each(state.awake, CountImpacts{data_});
        const std::uint32_t count = executor_.sum_up(data_.work.index, state.awake);
        if (count == 0) return;
        impacts_.reserve(count);
        executor_.for_each(state.awake, WriteImpacts{data_, state.time_step, impacts_.data()});
        state.building_contacts.assign(count, BuildingContact{0, -1, 0});
        impacts_.download(state.building_contacts);
    }

    void apply_viscosity(const Model& model, const Ground&, State& state) override {
        if (!(model.viscosity > 0)) return;
        const auto smoothing = static_cast<float>(step_smoothing(model.viscosity, state.time_step));
        with_pairs(model, [&]<class Smoothing>(const PairKernel<Smoothing>& pair) {
            executor_.for_each(state.awake, ApplyViscosity<Smoothing>{data_, pair, smoothing});
        });
    }

    void update_sleep(const Model& model, const Ground&, State& state) override {
        if (!(model.solver.rest_duration > 0)) return;
        // A hundredth of the speed of a fall through its own size; waking takes twice that.
        const double sleep = 0.01 * std::sqrt(model.gravity * model.particle_spacing), wake = 2 * sleep;
        executor_.for_each(
            state.awake, UpdateSleep{data_, static_cast<float>(state.time_step),
                                     static_cast<float>(model.solver.rest_duration), static_cast<float>(sleep * sleep),
                                     static_cast<float>(wake * wake), state.awake, state.awake < state.count});
    }

    void remove_outflow(const Model&, const Ground&, State& state) override {
        executor_.for_each(state.count, MarkInside{data_, state.awake});
        const std::uint32_t kept = executor_.sum_up(data_.work.index, state.count);
        if (kept == state.count) return;
        if (!state.building_contacts.empty()) renumber(state.building_contacts, state.count);
        executor_.for_each(state.count, ListMarked{data_, state.count});
        reorder(kept);
        state.outflow += state.count - kept;
        state.count = kept;
    }

    [[nodiscard]] std::string name() const override {
        return executor_.name();
    }
    [[nodiscard]] std::size_t bytes() const override {
        return executor_.bytes();
    }
    [[nodiscard]] double mean_neighbours() const override {
        if (searched_ == 0) return 0;
        return static_cast<double>(
                   executor_.template reduce<std::uint64_t>(searched_, 0, CountOf{data_.work.neighbour_count}, Add{})) /
               searched_;
    }

  private:
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

    static float softness(const Model& model) {
        return static_cast<float>(model.solver.constraint_relaxation * model.kernel.rest_gradient_sum);
    }

    /// Calls f with the kernel of pairs.
    template <class F>
    static void with_pairs(const Model& model, const F& f) {
        const PairScale scale(model.kernel);
        if (model.kernel.choice == params::KernelChoice::wendland_c2) {
            f(PairKernel<kernels::WendlandC2>{{}, scale});
        } else {
            f(PairKernel<ChosenSmoothing>{{model.kernel.choice}, scale});
        }
    }

    void follow_model(const Model& model) {
        std::vector<ReleaseView> releases;
        for (const ReleaseGroup& release : model.releases) {
            releases.push_back(
                {release.start_time, release.first_particle, release.last_particle, release.pore_pressure_ratio});
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

    /// Puts the first `count` particles of `order` first, in that order.
    void reorder(std::size_t count) {
        gathered_.reserve(count * sizeof(Deviator<float>));
#define TALUS_GATHER(array, element, name) gather(name##_, count);
        TALUS_PARTICLE_ARRAYS(TALUS_GATHER)
#undef TALUS_GATHER
    }
    template <class T>
    void gather(Memory<T>& memory, std::size_t count) {
        static_assert(sizeof(T) <= sizeof(Deviator<float>));
        T* const to = reinterpret_cast<T*>(gathered_.data());
        executor_.for_each(count, Gather<T>{memory.data(), to, data_.work.order});
        executor_.copy(memory.data(), to, count * sizeof(T));
    }

    [[nodiscard]] Bounds bounds(const State& state, float time_step) const {
        return executor_.template reduce<Bounds>(state.count, Bounds{}, BoundsOf{data_, time_step}, JoinBounds{});
    }

    [[nodiscard]] ColumnBox column_box(const Model& model, const Bounds& all) {
        ColumnBox box{};
        box.inverse_width = 1 / column_width(model);
        const auto along = [&](float low, float high, std::int64_t& first, std::int64_t& size) {
            first = whole_below(low * box.inverse_width - 0.5);
            size = whole_below(high * box.inverse_width - 0.5) + 2 - first;
        };
        along(all.x_min, all.x_max, box.first_column, box.columns);
        along(all.y_min, all.y_max, box.first_row, box.rows);
        if (static_cast<double>(box.columns) * static_cast<double>(box.rows) >
            static_cast<double>(std::numeric_limits<std::int32_t>::max())) {
            throw DeviceFailure(
                "debris is spread so far that the columns in which its thickness is counted do not fit: use --backend "
                "cpu");
        }
        columns_.reserve(static_cast<std::size_t>(box.columns * box.rows));
        box.units = columns_.data();
        return box;
    }

    /// The occupied cells and the particles around each.
    [[nodiscard]] Cells list_cells(const State& state) {
        executor_.for_each(state.count, MarkFirst{data_});
        const std::uint32_t count = executor_.sum_up(data_.work.index, state.count);
        if (count > cell_key_.size()) {
            const std::size_t room = count + count / 8;
            cell_key_.reserve(room);
            cell_start_.reserve(room + 1);
            cell_rows_.reserve(room);
        }
        const Cells cells{cell_key_.data(), cell_start_.data(), cell_rows_.data(), count};
        executor_.for_each(state.count, ListCells{data_, cells, state.count});
        executor_.for_each(count, FindRows{cells, box_, state.awake < state.count});
        return cells;
    }

    /// Contacts of particles that stay get their new indices, as `index` has them; the others are dropped.
    void renumber(std::vector<BuildingContact>& contacts, std::uint32_t count) {
        std::vector<std::uint32_t> index(count + std::size_t{1});
        executor_.download(index.data(), data_.work.index, index.size() * sizeof(std::uint32_t));
        std::erase_if(contacts, [&](const BuildingContact& c) { return index[c.particle + 1] == index[c.particle]; });
        for (BuildingContact& contact : contacts) contact.particle = index[contact.particle];
    }

    mutable Executor executor_;  // reading a sum takes memory of the device
    Data data_{};
    Needs needs_;
    CellBox box_{Bounds{0, 0, 0, 0, 0, 0}, 1};
    std::uint32_t searched_ = 0;
    std::vector<std::byte> staging_;

#define TALUS_MEMBER(array, element, name) Memory<element> name##_{executor_};
    TALUS_PARTICLE_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
#define TALUS_MEMBER(element, name, when) Memory<element> work_##name##_{executor_};
    TALUS_DEVICE_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
    Memory<float> density_of_id_{executor_};
    Memory<ReleaseView> releases_{executor_};
    Memory<Quad> boundary_nodes_{executor_}, by_slope_{executor_}, sticking_{executor_};
    Memory<Quad> cover_{executor_}, terrain_{executor_};
    Memory<terrain::WallEdge> edges_{executor_};
    Memory<terrain::WallSolid> solids_{executor_};
    Memory<std::uint32_t> bin_starts_{executor_}, bin_items_{executor_};
    Memory<std::byte> gathered_{executor_};
    Memory<std::uint64_t> cell_key_{executor_};
    Memory<std::uint32_t> cell_start_{executor_};
    Memory<CellRows> cell_rows_{executor_};
    Memory<std::uint32_t> list_start_{executor_}, neighbour_{executor_};
    Memory<std::uint32_t> columns_{executor_};
    Memory<BuildingContact> impacts_{executor_};
};

}  // namespace talus::sim::device
