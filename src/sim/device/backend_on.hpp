#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/device/pair_kernels.hpp"
#include "sim/device/particle_kernels.hpp"
#include "sim/device/reductions.hpp"
#include "sim/device/resident.hpp"
#include "sim/device/search_kernels.hpp"
#include "sim/device/smoothing.hpp"
#include "sim/device/stress_kernels.hpp"

namespace talus::sim::device {

/// The stages on what an executor runs (host_executor.hpp has its interface). Lists of neighbours, cells and columns
/// grow when debris needs more than ever before; nothing else is allocated after follow().
template <class Executor>
class BackendOn final : public Resident<Executor> {
    using Here = Resident<Executor>;
    using Here::bounds, Here::data_, Here::executor_, Here::list_start_, Here::follow_water, Here::needs_,
        Here::reorder;
    template <class T>
    using Memory = Array<T, Executor>;

  public:
    void begin_step(const Model& model, const State& state) override {
        data_.step = StepConstants(model, state);
        data_.time = state.time;
        follow_water(state);
    }

    void release_held(const Model&, State& state) override { executor_.for_each(state.count, ReleaseHeld{data_}); }

    void apply_drag(const Model& model, const Ground&, State& state) override {
        const bool slows = slows_by_speed(model);
        if ((!slows && !model.evolving_pressure.on) || state.count == 0) return;
        const ColumnBox box = column_box(model, bounds(state, 0));
        executor_.for_each(static_cast<std::size_t>(box.columns * box.rows), ClearColumns{box});
        executor_.for_each(state.count, CountColumns{data_, box});
        executor_.for_each(state.count, Drag{data_, box, slows});
    }

    void predict_positions(const Model&, const Ground&, State& state) override {
        executor_.for_each(state.count, ApplyGravity{data_});
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
        data_.count = state.count;
        data_.awake = state.awake;
        executor_.for_each(state.count, Begin{data_});
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

    void prepare_particles(const Model&, const Ground&, State& state) override {
        if (needs_.resistance) executor_.for_each(state.awake, Resist{data_});
    }

    void warm_start(const Model& model, const Ground&, State& state) override {
        with_kernel_of_pairs(model, [&]<class Smoothing>(const stages::PairKernel<Smoothing>& kernel) {
            if (needs_.stress) {
                const std::uint32_t asleep = state.count - state.awake;
                executor_.for_each(state.awake, Linearise<Smoothing>{data_, kernel});
                executor_.for_each(asleep, PressAsleep{data_});
                executor_.for_each(state.awake, ApplyStress<Smoothing>{data_, kernel});
                executor_.for_each(asleep, ClearAsleep{data_});
            } else {
                executor_.for_each(state.awake, FindTolerated<Smoothing>{data_, kernel});
            }
        });
        state.previous_time_step = state.time_step;
    }

    void solve_density(const Model& model, const Ground&, State& state) override {
        with_kernel_of_pairs(model, [&]<class Smoothing>(const stages::PairKernel<Smoothing>& kernel) {
            if (needs_.stress) {
                executor_.for_each(state.awake, SolveStress<Smoothing>{data_, kernel});
                executor_.for_each(state.awake, ApplyStress<Smoothing>{data_, kernel});
            } else {
                executor_.for_each(state.awake, UpdateMultipliers<Smoothing>{data_, kernel});
                executor_.for_each(state.awake, ApplyPairs<Smoothing>{data_, kernel});
            }
        });
    }

    void solve_contacts(const Model&, const Ground&, State& state) override {
        executor_.for_each(state.awake, Contacts{data_});
    }

    void measure_compression(const Model&, State& state) override {
        const CompressionOf of{data_.work.compression, data_.work.tolerated_compression};
        executor_.template reduce<CompressionSum>(state.awake, {}, of, Add{}).write(state, state.count);
    }

    void resolve_penetration(const Model& model, const Ground&, State& state) override {
        if (needs_.stress) {
            executor_.for_each(state.awake, FindSpread{data_});
            with_kernel_of_pairs(model, [&]<class Smoothing>(const stages::PairKernel<Smoothing>& kernel) {
                executor_.for_each(state.awake, Spread<Smoothing>{data_, kernel});
            });
        }
        executor_.for_each(state.awake, ResolvePenetration{data_});
    }

    void enforce_boundaries(const Model&, const Ground&, State& state) override {
        executor_.for_each(state.awake, Finish{data_});
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
        with_kernel_of_pairs(model, [&]<class Smoothing>(const stages::PairKernel<Smoothing>& kernel) {
            executor_.for_each(state.awake, ApplyViscosity<Smoothing>{data_, kernel});
        });
    }

    void update_sleep(const Model& model, const Ground&, State& state) override {
        if (model.solver.rest_duration > 0) executor_.for_each(state.awake, UpdateSleep{data_});
    }

    void remove_outflow(const Model&, const Ground&, State& state) override {
        executor_.for_each(state.count, MarkInside{data_});
        const std::uint32_t kept = executor_.sum_up(data_.work.index, state.count);
        if (kept == state.count) return;
        if (!state.building_contacts.empty()) renumber(state.building_contacts);
        executor_.for_each(state.count, ListMarked{data_, state.count});
        reorder(kept);
        state.outflow += state.count - kept;
        state.count = kept;
    }

    [[nodiscard]] double mean_neighbours() const override {
        if (searched_ == 0) return 0;
        return static_cast<double>(
                   executor_.template reduce<std::uint64_t>(searched_, 0, CountOf{data_.work.neighbour_count}, Add{})) /
               searched_;
    }

  private:
    /// Calls f with the kernel of pairs.
    template <class F>
    static void with_kernel_of_pairs(const Model& model, const F& f) {
        const PairScale scale(model.kernel);
        if (model.kernel.choice == params::KernelChoice::wendland_c2) {
            f(stages::PairKernel<kernels::WendlandC2>{{}, scale});
        } else {
            f(stages::PairKernel<ChosenSmoothing>{{model.kernel.choice}, scale});
        }
    }

    [[nodiscard]] ColumnBox column_box(const Model& model, const Bounds& all) {
        ColumnBox box{};
        box.inverse_width = 1 / column_width(model);
        const auto along = [&](float low, float high, std::int64_t& first, std::int64_t& size) {
            first = floor_to_int(low * box.inverse_width - 0.5);
            size = floor_to_int(high * box.inverse_width - 0.5) + 2 - first;
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
    void renumber(std::vector<BuildingContact>& contacts) {
        executor_.for_each(contacts.size(), RenumberImpacts{data_, impacts_.data()});
        impacts_.download(contacts);
        std::erase_if(contacts, [](const BuildingContact& c) { return c.particle == RenumberImpacts::gone; });
    }

    CellBox box_{Bounds{0, 0, 0, 0, 0, 0}, 1};
    std::uint32_t searched_ = 0;
    Memory<std::uint64_t> cell_key_{executor_};
    Memory<std::uint32_t> cell_start_{executor_};
    Memory<CellRows> cell_rows_{executor_};
    Memory<std::uint32_t> neighbour_{executor_};
    Memory<std::uint32_t> columns_{executor_};
    Memory<BuildingContact> impacts_{executor_};
};

}  // namespace talus::sim::device
