#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "observe/erosion.hpp"
#include "observe/front_tracker.hpp"
#include "observe/grid_flow.hpp"
#include "observe/grid_observer.hpp"
#include "observe/run_out.hpp"

/// What a GridObserver makes of its records at the end.
namespace talus::observe {
namespace {

/// So many parcels of equal volume stand for the debris where its run-out is measured as that of particles.
constexpr double parcels = 20000;

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
        const float arrived = reached_.arrival_time[cell];
        if (!(chainage_[cell] > covered) || std::isnan(arrived)) continue;
        advances.push_back({arrived, chainage_[cell], {reached_.arrival_speed[cell], arrival_fastest_[cell]}});
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
            if (!(reached_.depth[g.index(column, row)] > 0)) continue;
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
    HazardMaps maps = empty_maps(part);
    for (int row = south; row <= north; ++row) {
        for (int column = west; column <= east; ++column) {
            const std::size_t at = g.index(column, row), k = part.index(column - west, row - south);
            const float depth = solver.depth_at(column, row), speed = reached_.speed[at];
            // Also where it is too thin to count as having come: the map holds all the debris that is there.
            if (depth > 0) maps.deposit_depth.values[k] = depth;
            if (!(reached_.depth[at] > 0)) continue;
            read_cell(reached_, at, static_cast<float>(density_ * speed * speed), depth, maps, k);
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
