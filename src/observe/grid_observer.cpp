#include "observe/grid_observer.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "observe/erosion.hpp"
#include "observe/front_tracker.hpp"
#include "observe/grid_flow.hpp"
#include "observe/run_out.hpp"
#include "simd/parallel.hpp"

namespace talus::observe {
namespace {

/// Debris thinner than this share of the arrival depth does not count as having reached a cell.
constexpr double thinnest_share = 0.1;
/// Debris this near to a cell is at the front when it arrives there, in cells. The cell's own speed says little: its
/// debris is still thin, and resistance slows a thin layer most.
constexpr int head_cells = 2;

constexpr std::size_t rows_per_task = 16;  // fixed: sums must not depend on the number of threads

double total(const StripSums::Places& places) {
    return std::accumulate(places.begin(), places.end(), 0.0);
}

/// Shared by threads; a number that is not one raises nothing.
void raise(float& largest, float number) {
    const std::atomic_ref shared(largest);
    float before = shared.load(std::memory_order_relaxed);
    while (number > before && !shared.compare_exchange_strong(before, number, std::memory_order_relaxed)) {
    }
}

}  // namespace

GridObserver::GridObserver(const depth::Solver& solver, terrain::FlowPath flow_path, const params::OutputSpec& outputs,
                           GridStructures structures, double held)
    : outputs_(outputs),
      flow_path_(std::move(flow_path)),
      density_(solver.material().rest_density),
      gravity_(solver.material().gravity),
      arrival_fastest_(solver.geometry().size(), 0),
      released_(solver.geometry()),
      chainage_(solver.geometry().size(), std::numeric_limits<float>::quiet_NaN()),
      structures_(std::move(structures)),
      energy_(solver.material().gravity) {
    const GridGeometry& g = solver.geometry();
    for_each_map_array([&](std::vector<float>& map) { map.assign(g.size(), 0); }, reached_);
    reached_.arrival_time.assign(g.size(), std::numeric_limits<float>::quiet_NaN());
    reached_.pressure = {};
    for (int row = 0; row < g.rows && !flow_path_.empty(); ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const auto at = flow_path_.locate(g.centre(column, row));
            if (at) chainage_[g.index(column, row)] = static_cast<float>(at->chainage);
        }
    }
    add_row(solver, held, 0);
}

void GridObserver::add_row(const depth::Solver& solver, double held, double steps_per_second) {
    timeseries_.push_back(sample(solver, held, steps_per_second));
    const TimeSample& row = timeseries_.back();
    energy_.add(row, density_ * (row.volume_moving + row.volume_deposited), density_);
}

void GridObserver::note_inflow(double volume, double highest) {
    volume_released_ += volume;
    if (!(volume > 0)) return;
    const double mass = density_ * volume;
    energy_.bring(mass, mass * gravity_ * highest, highest, 0);
}

void GridObserver::note_release(const depth::Solver& solver, const Grid<float>& depth, double volume, double held) {
    volume_released_ += volume;
    const GridGeometry& g = solver.geometry();
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const std::size_t cell = g.index(column, row);
            const double added = depth.values[cell];
            if (!(added > 0) || !solver.known(column, row)) continue;
            released_.values[cell] += depth.values[cell];
            // On top of what lies there.
            const double all = solver.depth_at(column, row), bed = solver.bed_at(column, row);
            const double mass = density_ * added * g.cell * g.cell;
            energy_.bring(mass, mass * gravity_ * (bed + all - added / 2), bed + all, all);
        }
    }
    measure_cells(solver);
    if (timeseries_.back().time < solver.time()) return;
    const double rate = timeseries_.back().steps_per_second;
    timeseries_.pop_back();
    add_row(solver, held, rate);
}

void GridObserver::watch(const depth::Solver& solver, const std::vector<terrain::Gauge>& gauges) {
    gauges_ = GaugeRecorder(gauges, outputs_.arrival_depth);
    read_gauges(solver, true);
}

void GridObserver::watch(const depth::Solver& solver, const terrain::Terrain& terrain,
                         const std::vector<terrain::CrossSection>& sections) {
    sections_ = GridSections(solver, terrain, sections, structures_.faces().size());
}

std::vector<depth::Face> GridObserver::faces() const {
    std::vector<depth::Face> all = structures_.faces();
    all.insert(all.end(), sections_.faces().begin(), sections_.faces().end());
    return all;
}

void GridObserver::read_gauges(const depth::Solver& solver, bool row) {
    const GridGeometry& g = solver.geometry();
    gauges_.after_step(solver.time(), row, [&](const PlanPoint& place) -> FlowAt {
        const double east = std::floor((place.x - g.x_min) / g.cell), north = std::floor((place.y - g.y_min) / g.cell);
        if (!(east >= 0 && north >= 0 && east < g.columns && north < g.rows)) return {};
        const int c = static_cast<int>(east), r = static_cast<int>(north);
        FlowAt flow{solver.depth_at(c, r)};
        if (flow.depth < thinnest_depth()) return flow;
        flow.speed = speed_of(solver, c, r);
        return flow;
    });
}

void GridObserver::measure_cells(const depth::Solver& solver) {
    const auto thinnest = static_cast<float>(thinnest_depth());
    const auto arrives = static_cast<float>(outputs_.arrival_depth);
    const auto time = static_cast<float>(solver.time());
    const GridGeometry& g = solver.geometry();
    const auto arrive = [&](const depth::CellRow& row) {
        const std::size_t west = g.index(row.first, row.row);
        const float* const reached_at = &reached_.arrival_time[west];
        depth::for_each_of_few(
            row.last - row.first, [&](int k) { return row.depth[k] > arrives && !(reached_at[k] >= 0); },
            [&](int k) {
                const std::size_t cell = west + static_cast<std::size_t>(k);
                reached_.arrival_time[cell] = time;
                const FrontRecord::Head head = head_at(solver, cell);
                reached_.arrival_speed[cell] = static_cast<float>(head.mean);
                arrival_fastest_[cell] = static_cast<float>(head.fastest);
                raise(farthest_arrival_, chainage_[cell]);
            });
    };
    if (solver.steps() == 0 || !solver.active()) {
        for (int r = 0; r < g.rows; ++r) {
            const depth::CellRow row = solver.row(r);
            depth::for_each_deeper(row, thinnest, [&](int k) {
                float& peak = reached_.depth[g.index(k, r)];
                peak = std::max(peak, row.depth[k]);
            });
            arrive(row);
        }
        return;
    }
    solver.for_each_active_row([&](const depth::CellRow& row) {
        const std::size_t west = g.index(row.first, row.row);
        raise_peaks_(row, thinnest, &reached_.depth[west], &reached_.speed[west]);
        arrive(row);
    });
}

FrontRecord::Head GridObserver::head_at(const depth::Solver& solver, std::size_t cell) const {
    const GridGeometry& g = solver.geometry();
    if (solver.steps() == 0) return {0, 0};
    const auto columns = static_cast<std::size_t>(g.columns);
    const auto column = static_cast<int>(cell % columns), row = static_cast<int>(cell / columns);
    double depths = 0, sum = 0, fastest = 0;
    for (int r = std::max(0, row - head_cells); r <= std::min(g.rows - 1, row + head_cells); ++r) {
        for (int c = std::max(0, column - head_cells); c <= std::min(g.columns - 1, column + head_cells); ++c) {
            const double depth = solver.depth_at(c, r);
            if (!(depth > thinnest_depth())) continue;
            const double speed = speed_of(solver, c, r);
            depths += depth;
            sum += depth * speed;
            fastest = std::max(fastest, speed);
        }
    }
    return {depths > 0 ? sum / depths : 0, fastest};
}

void GridObserver::after_step(const depth::Solver& solver, double held, double steps_per_second) {
    measure_cells(solver);
    const bool row = solver.time() >= timeseries_.back().time + outputs_.sample_interval - 1e-9;
    structures_.after_step(solver, row);
    sections_.after_step(solver);
    read_gauges(solver, row);
    if (!row) return;
    if (farthest_arrival_ > std::numeric_limits<float>::lowest()) front_ = farthest_arrival_;
    add_row(solver, held, steps_per_second);
}

double GridObserver::fastest(const depth::Solver& solver) const {
    const auto thinnest = static_cast<float>(thinnest_depth());
    float fastest = 0;
    solver.for_each_active_row_in_turn([&](const depth::CellRow& row) {
        depth::for_each_deeper(row, thinnest, [&](int k) { fastest = std::max(fastest, speed_of(row, k)); });
    });
    return fastest;
}

double GridObserver::thinnest_depth() const {
    return thinnest_share * outputs_.arrival_depth;
}

MapAccumulator::Present GridObserver::present(const depth::Solver& solver) const {
    const GridGeometry& g = solver.geometry();
    int west = g.columns, east = -1, south = g.rows, north = -1;
    for (int r = 0; r < g.rows; ++r) {
        depth::for_each_deeper(solver.row(r), 0, [&](int column) {
            west = std::min(west, column);
            east = std::max(east, column);
            south = std::min(south, r);
            north = r;
        });
    }
    MapAccumulator::Present present;
    if (east < 0) return present;
    present.first_column = west;
    present.first_row = south;
    const GridGeometry part{g.x_min + west * g.cell, g.y_min + south * g.cell, g.cell, east - west + 1,
                            north - south + 1};
    present.depth = present.speed = Grid<float>(part);
    for (int r = south; r <= north; ++r) {
        const depth::CellRow row = solver.row(r);
        depth::for_each_deeper(row, 0, [&](int column) {
            present.depth.at(column - west, r - south) = row.depth[column];
            if (row.depth[column] < thinnest_depth()) return;
            present.speed.at(column - west, r - south) = speed_of(row, column);
        });
    }
    return present;
}

double GridObserver::volume_faster_than(const depth::Solver& solver, double limit) const {
    const GridGeometry& g = solver.geometry();
    double depth = 0;
    for (int r = 0; r < g.rows; ++r) {
        const depth::CellRow row = solver.row(r);
        depth::for_each_deeper(row, 0, [&](int column) {
            if (speed_of(row, column) >= limit) depth += row.depth[column];
        });
    }
    return depth * g.cell * g.cell;
}

void GridObserver::add_row_to(StripSums& sums, const depth::Solver& solver, int r) const {
    const GridGeometry& g = solver.geometry();
    const depth::CellRow row = solver.row(r);
    const double area = g.cell * g.cell;
    for (int first = 0; first < g.columns; first += strip_cells) {
        const int count = std::min(strip_cells, g.columns - first);
        int wet = 0;
        for (int k = first; k < first + count; ++k) wet += row.depth[k] > 0 ? 1 : 0;
        if (wet == 0) continue;
        StripSums::Places volume{}, speed{}, height{};
        for (int k = 0; k < count; ++k) {
            const auto at = static_cast<std::size_t>(k);
            const double depth = row.depth[first + k];
            volume[at] = depth > 0 ? depth * area : 0;
            speed[at] = depth > 0 ? speed_of(row, first + k) : 0;
            height[at] = depth > 0 ? solver.bed_at(first + k, r) + depth / 2 : 0;
        }
        for (int k = 0; solver.flies() && k < count; ++k) {
            height[static_cast<std::size_t>(k)] += solver.height_at(first + k, r);
        }
        for (std::size_t k = 0; k < strip_cells; ++k) {
            const bool deposited = speed[k] < outputs_.deposited_speed;
            sums.deposited[k] += deposited ? volume[k] : 0;
            sums.moving[k] += deposited ? 0 : volume[k];
            sums.kinetic[k] += volume[k] * speed[k] * speed[k];
            sums.momentum[k] += volume[k] * speed[k];
            sums.potential[k] += volume[k] * height[k];
            sums.fastest[k] = std::max(sums.fastest[k], speed[k]);
        }
        const float* const chainage = &chainage_[g.index(first, r)];
        for (int k = 0; k < count; ++k) {
            if (row.depth[first + k] > outputs_.arrival_depth && chainage[k] > sums.front) sums.front = chainage[k];
        }
    }
}

TimeSample GridObserver::sample(const depth::Solver& solver, double held, double steps_per_second) const {
    const auto rows = static_cast<std::size_t>(solver.geometry().rows);
    const StripSums sums = simd::reduce_ranges(
        rows, rows_per_task, StripSums{},
        [&](std::size_t first, std::size_t last, StripSums sum) {
            for (std::size_t r = first; r < last; ++r) add_row_to(sum, solver, static_cast<int>(r));
            return sum;
        },
        [](const StripSums& x, const StripSums& y) { return x + y; });
    TimeSample s;
    s.volume_deposited = total(sums.deposited);
    s.volume_moving = total(sums.moving);
    s.kinetic_energy = density_ * total(sums.kinetic) / 2;
    s.momentum = density_ * total(sums.momentum);
    s.potential_energy = density_ * gravity_ * total(sums.potential);
    s.largest_speed = *std::max_element(sums.fastest.begin(), sums.fastest.end());
    s.time = solver.time();
    s.volume_held = held;
    if (solver.steps() == 0) {  // nothing has been let go yet
        s.volume_held += s.volume_moving + s.volume_deposited;
        s.volume_moving = s.volume_deposited = 0;
    }
    s.volume_left = solver.volume_left();
    s.volume_released = volume_released_ + held;
    s.volume_entrained = volume_entrained_;
    s.front_chainage = sums.front > std::numeric_limits<float>::lowest() ? sums.front : never;
    s.mean_compression = s.max_compression = s.overcompressed_share = never;
    s.time_step = solver.time_step();
    s.steps_per_second = steps_per_second;
    return s;
}

}  // namespace talus::observe
