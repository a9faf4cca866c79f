#include "observe/grid_observer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "observe/erosion.hpp"
#include "observe/front_tracker.hpp"
#include "observe/grid_flow.hpp"
#include "observe/run_out.hpp"

namespace talus::observe {
namespace {

/// Debris thinner than this share of the arrival depth does not count as having reached a cell.
constexpr double thinnest_share = 0.1;
/// So many parcels of equal volume stand for the debris where its run-out is measured as that of particles.
constexpr double parcels = 20000;
/// Debris this near to a cell is at the front when it arrives there, in cells. The cell's own speed says little: its
/// debris is still thin, and resistance slows a thin layer most.
constexpr int head_cells = 2;

/// Debris as parcels of equal volume at the centres of its cells, on the ground.
sim::State parcels_of(const depth::Solver& solver, const sim::Ground& ground, const Grid<float>& depth, double all,
                      double left) {
    const GridGeometry& g = solver.geometry();
    const double area = g.cell * g.cell, parcel = all / parcels;
    std::vector<LocalPoint> points;
    double due = 0;  // of the cells so far, so that rounding loses nothing
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            due += depth.at(column, row) * area / parcel;
            if (due < 1) continue;
            const PlanPoint p = g.centre(column, row);
            LocalPoint at = ground.terrain.frame().to_local({p.x, p.y, 0});
            at.z = ground.terrain.sample(at.x, at.y).height;
            for (; due >= 1; due -= 1) points.push_back(at);
        }
    }
    sim::State state;
    state.count = static_cast<std::uint32_t>(points.size());
    state.outflow = static_cast<std::uint32_t>(left / parcel);
    state.seeded = state.count + state.outflow;
    state.resize(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i) state.position.set(i, points[i]);
    return state;
}

}  // namespace

GridObserver::GridObserver(const depth::Solver& solver, terrain::FlowPath flow_path, const params::OutputSpec& outputs,
                           GridStructures structures, double held)
    : outputs_(outputs),
      flow_path_(std::move(flow_path)),
      density_(solver.material().rest_density),
      gravity_(solver.material().gravity),
      peak_depth_(solver.geometry()),
      peak_speed_(solver.geometry()),
      arrival_time_(solver.geometry(), std::numeric_limits<float>::quiet_NaN()),
      arrival_speed_(arrival_time_),
      arrival_fastest_(solver.geometry().size(), 0),
      released_(solver.geometry()),
      chainage_(solver.geometry().size(), std::numeric_limits<float>::quiet_NaN()),
      structures_(std::move(structures)),
      energy_(solver.material().gravity) {
    const GridGeometry& g = solver.geometry();
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
    const auto measure = [&](std::size_t cell, float depth, float speed) {
        if (!(depth > thinnest)) return;
        peak_depth_.values[cell] = std::max(peak_depth_.values[cell], depth);
        peak_speed_.values[cell] = std::max(peak_speed_.values[cell], speed);
        if (depth > arrives && std::isnan(arrival_time_.values[cell])) {
            arrival_time_.values[cell] = time;
            const FrontRecord::Head head = head_at(solver, cell);
            arrival_speed_.values[cell] = static_cast<float>(head.mean);
            arrival_fastest_[cell] = static_cast<float>(head.fastest);
        }
    };
    if (solver.steps() == 0 || !solver.active()) {
        for (int row = 0; row < g.rows; ++row) {
            for (int column = 0; column < g.columns; ++column) {
                measure(g.index(column, row), solver.depth_at(column, row), 0);
            }
        }
        return;
    }
    solver.for_each_active_row([&](const depth::ActiveRow& row) {
        const std::size_t first = g.index(row.first, row.row);
        for (int k = 0; k < row.last - row.first; ++k) {
            measure(first + static_cast<std::size_t>(k), row.depth[k], speed_of(row, k));
        }
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
    const GridGeometry& g = solver.geometry();
    for (std::size_t cell = 0; cell < g.size(); ++cell) {
        if (!std::isnan(arrival_time_.values[cell]) && !(chainage_[cell] <= front_)) {
            front_ = std::isnan(chainage_[cell]) ? front_ : double{chainage_[cell]};
        }
    }
    add_row(solver, held, steps_per_second);
}

double GridObserver::fastest(const depth::Solver& solver) const {
    const auto thinnest = static_cast<float>(thinnest_depth());
    float fastest = 0;
    solver.for_each_active_row_in_turn([&](const depth::ActiveRow& row) {
        for (int k = 0; k < row.last - row.first; ++k) {
            if (row.depth[k] < thinnest) continue;
            fastest = std::max(fastest, speed_of(row, k));
        }
    });
    return fastest;
}

double GridObserver::thinnest_depth() const {
    return thinnest_share * outputs_.arrival_depth;
}

MapAccumulator::Present GridObserver::present(const depth::Solver& solver) const {
    const GridGeometry& g = solver.geometry();
    int west = g.columns, east = -1, south = g.rows, north = -1;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            if (!(solver.depth_at(column, row) > 0)) continue;
            west = std::min(west, column);
            east = std::max(east, column);
            south = std::min(south, row);
            north = row;
        }
    }
    MapAccumulator::Present present;
    if (east < 0) return present;
    present.first_column = west;
    present.first_row = south;
    const GridGeometry part{g.x_min + west * g.cell, g.y_min + south * g.cell, g.cell, east - west + 1,
                            north - south + 1};
    present.depth = present.speed = Grid<float>(part);
    for (int row = south; row <= north; ++row) {
        for (int column = west; column <= east; ++column) {
            const float depth = solver.depth_at(column, row);
            if (!(depth > 0)) continue;
            present.depth.at(column - west, row - south) = depth;
            if (depth < thinnest_depth()) continue;
            present.speed.at(column - west, row - south) = speed_of(solver, column, row);
        }
    }
    return present;
}

double GridObserver::volume_faster_than(const depth::Solver& solver, double limit) const {
    const GridGeometry& g = solver.geometry();
    double depth = 0;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            if (!(solver.depth_at(column, row) > 0)) continue;
            const double speed = speed_of(solver, column, row);
            if (speed >= limit) depth += solver.depth_at(column, row);
        }
    }
    return depth * g.cell * g.cell;
}

TimeSample GridObserver::sample(const depth::Solver& solver, double held, double steps_per_second) const {
    TimeSample s;
    const GridGeometry& g = solver.geometry();
    const double area = g.cell * g.cell;
    double front = never;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const double depth = solver.depth_at(column, row);
            if (!(depth > 0)) continue;
            if (depth > outputs_.arrival_depth) front = std::fmax(front, chainage_[g.index(column, row)]);
            const double speed = speed_of(solver, column, row);
            const double volume = depth * area;
            (speed < outputs_.deposited_speed ? s.volume_deposited : s.volume_moving) += volume;
            s.kinetic_energy += density_ * volume * speed * speed / 2;
            s.momentum += density_ * volume * speed;
            s.potential_energy += density_ * volume * solver.material().gravity *
                                  (solver.bed_at(column, row) + depth / 2 + solver.height_at(column, row));
            s.largest_speed = std::max(s.largest_speed, speed);
        }
    }
    s.time = solver.time();
    s.volume_held = held;
    if (solver.steps() == 0) {  // nothing has been let go yet
        s.volume_held += s.volume_moving + s.volume_deposited;
        s.volume_moving = s.volume_deposited = 0;
    }
    s.volume_left = solver.volume_left();
    s.volume_released = volume_released_ + held;
    s.volume_entrained = volume_entrained_;
    s.front_chainage = front;
    s.mean_compression = s.max_compression = s.overcompressed_share = never;
    s.time_step = solver.time_step();
    s.steps_per_second = steps_per_second;
    return s;
}

FrontRecord GridObserver::front_record() const {
    FrontRecord record;
    const double cell_size = released_.geometry.cell;
    record.interval = outputs_.chainage_interval;
    record.resolution = resolved_cells * cell_size;
    record.window = std::max(outputs_.front_velocity_window, record.resolution);
    if (flow_path_.empty()) return record;
    record.arrival.assign(static_cast<std::size_t>(flow_path_.length() / record.interval) + 1, never);
    record.head.assign(record.arrival.size(), {});
    double covered = -1;  // what the release covers is no arrival
    for (std::size_t cell = 0; cell < chainage_.size(); ++cell) {
        if (released_.values[cell] > 0 && chainage_[cell] > covered) covered = chainage_[cell];
    }
    // Where the front came to, cell by cell.
    struct Advance {
        float time, chainage;
        FrontRecord::Head head;
    };
    std::vector<Advance> advances;
    for (std::size_t cell = 0; cell < chainage_.size(); ++cell) {
        if (!(chainage_[cell] > covered) || std::isnan(arrival_time_.values[cell])) continue;
        advances.push_back(
            {arrival_time_.values[cell], chainage_[cell], {arrival_speed_.values[cell], arrival_fastest_[cell]}});
    }
    std::sort(advances.begin(), advances.end(), [](const Advance& a, const Advance& b) {
        return std::pair(a.time, -a.chainage) < std::pair(b.time, -b.chainage);
    });
    const Advance* before = nullptr;
    for (const Advance& now : advances) {
        if (before != nullptr && now.chainage <= before->chainage) continue;
        for (auto bin = before == nullptr ? record.arrival.size()
                                          : static_cast<std::size_t>(before->chainage / record.interval) + 1;
             bin < record.arrival.size() && static_cast<double>(bin) * record.interval <= now.chainage; ++bin) {
            const double share = (static_cast<double>(bin) * record.interval - before->chainage) /
                                 (static_cast<double>(now.chainage) - before->chainage);
            record.arrival[bin] = before->time + share * (static_cast<double>(now.time) - before->time);
            record.head[bin] = {now.head.mean, std::max(now.head.fastest, before->head.fastest)};
        }
        before = &now;
    }
    return record;
}

HazardMaps GridObserver::maps(const depth::Solver& solver) const {
    const GridGeometry& g = solver.geometry();
    int west = g.columns, east = -1, south = g.rows, north = -1;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            if (!(peak_depth_.at(column, row) > 0)) continue;
            west = std::min(west, column);
            east = std::max(east, column);
            south = std::min(south, row);
            north = std::max(north, row);
        }
    }
    if (east < 0) west = east = south = north = 0;
    constexpr int margin = 2;
    west = std::max(0, west - margin);
    south = std::max(0, south - margin);
    east = std::min(g.columns - 1, east + margin);
    north = std::min(g.rows - 1, north + margin);
    const GridGeometry part{g.x_min + west * g.cell, g.y_min + south * g.cell, g.cell, east - west + 1,
                            north - south + 1};
    const Grid<float> unknown(part, std::numeric_limits<float>::quiet_NaN());
    HazardMaps maps{unknown, unknown, unknown, unknown, unknown, unknown};
    for (int row = south; row <= north; ++row) {
        for (int column = west; column <= east; ++column) {
            const int c = column - west, r = row - south;
            // Also where it is too thin to count as having come: the map holds all the debris that is there.
            if (solver.depth_at(column, row) > 0) maps.deposit_depth.at(c, r) = solver.depth_at(column, row);
            if (!(peak_depth_.at(column, row) > 0)) continue;
            const float speed = peak_speed_.at(column, row);
            maps.peak_depth.at(c, r) = peak_depth_.at(column, row);
            maps.peak_speed.at(c, r) = speed;
            maps.peak_pressure.at(c, r) = static_cast<float>(density_ * speed * speed);
            maps.arrival_time.at(c, r) = arrival_time_.at(column, row);
            maps.arrival_speed.at(c, r) = arrival_speed_.at(column, row);
            maps.deposit_depth.at(c, r) = solver.depth_at(column, row);
        }
    }
    return maps;
}

Energy GridObserver::measure_energy(const depth::Solver& solver, const HazardMaps& hazard) const {
    const GridGeometry &all = solver.geometry(), &g = hazard.peak_speed.geometry;
    const int west = static_cast<int>(std::lround((g.x_min - all.x_min) / all.cell));
    const int south = static_cast<int>(std::lround((g.y_min - all.y_min) / all.cell));
    Grid<float> ground(g, std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            if (!solver.known(west + column, south + row)) continue;
            ground.at(column, row) = solver.bed_at(west + column, south + row);
        }
    }
    return energy_.measure(hazard, ground, 0);
}

Observation GridObserver::finish(const depth::Solver& solver, const sim::Ground& ground, double held) const {
    Observation o;
    o.maps = maps(solver);
    o.energy = measure_energy(solver, o.maps);
    o.thickness = measure_thickness(o.maps.peak_depth, ground.terrain, outputs_.arrival_depth);
    o.deposit = measure_deposit(o.maps.deposit_depth, outputs_.arrival_depth);
    const FrontRecord front = front_record();
    o.front = front.samples();
    o.timeseries = timeseries_;
    if (o.timeseries.back().time < solver.time())
        o.timeseries.push_back(sample(solver, held, timeseries_.back().steps_per_second));
    o.gauges = gauges_.records();
    o.cross_sections = sections_.records(solver.time());
    o.buildings = structures_.impacts(solver);
    o.volume_released = volume_released_ + held;
    o.erosion = measure_erosion(ground, flow_path_, outputs_.chainage_interval);
    o.volume_rounding = 1e-6;

    Grid<float> depth(solver.geometry());
    for (int row = 0; row < depth.geometry.rows; ++row) {
        for (int column = 0; column < depth.geometry.columns; ++column) {
            depth.at(column, row) = solver.depth_at(column, row);
        }
    }
    if (!(volume_released_ > 0)) return o;
    double farthest = front_;
    for (const FrontSample& s : o.front) farthest = std::isnan(farthest) ? s.chainage : std::max(farthest, s.chainage);
    double start = 0;
    for (const float h : released_.values) start += h;
    start *= depth.geometry.cell * depth.geometry.cell;
    const ReleasedMass released = measure_release(ground, parcels_of(solver, ground, released_, start, 0));
    o.run_out = measure_run_out(
        ground, parcels_of(solver, ground, depth, volume_released_ + volume_entrained_, solver.volume_left()),
        o.maps.peak_depth, released, farthest);
    return o;
}

}  // namespace talus::observe
