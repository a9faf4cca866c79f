#include "observe/followed_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "observe/erosion.hpp"
#include "observe/front_tracker.hpp"
#include "observe/trail.hpp"

namespace talus::observe {
namespace {

constexpr double band_cells = 3;       ///< length of a band of the trail, in map cells
constexpr double shortest_cells = 10;  ///< a shorter trail has no line
constexpr double reach_cells = 2;      ///< from a place on the line to the map cells whose arrivals count there

PlanPoint centre_of(const GridGeometry& g, std::size_t k) {
    const auto columns = static_cast<std::size_t>(g.columns);
    return g.centre(static_cast<int>(k % columns), static_cast<int>(k / columns));
}

/// The cells of the band [from, to) of the trail that are connected with `first`. `taken`: by cell, of earlier bands.
std::vector<std::size_t> connected_cells(const TrailDistances& ways, const GridGeometry& g, std::size_t first,
                                         double from, double to, std::vector<std::uint8_t>& taken) {
    std::vector<std::size_t> cells{first};
    taken[first] = 1;
    for (std::size_t next = 0; next < cells.size(); ++next) {
        const auto columns = static_cast<std::size_t>(g.columns);
        const auto column = static_cast<int>(cells[next] % columns), row = static_cast<int>(cells[next] / columns);
        for (int r = std::max(0, row - 1); r <= std::min(g.rows - 1, row + 1); ++r) {
            for (int c = std::max(0, column - 1); c <= std::min(g.columns - 1, column + 1); ++c) {
                const std::size_t k = g.index(c, r);
                const double way = ways.at(k);
                if (taken[k] != 0 || !(way >= from && way < to)) continue;
                taken[k] = 1;
                cells.push_back(k);
            }
        }
    }
    return cells;
}

PlanPoint centroid(const std::vector<std::size_t>& cells, const HazardMaps& maps) {
    double sum = 0, x = 0, y = 0;
    for (const std::size_t k : cells) {
        const PlanPoint p = centre_of(maps.peak_depth.geometry, k);
        // Ground that debris hardly moved over counts a little.
        const double weight =
            static_cast<double>(maps.peak_depth.values[k]) * (static_cast<double>(maps.peak_speed.values[k]) + 0.01);
        sum += weight;
        x += weight * p.x;
        y += weight * p.y;
    }
    return {x / sum, y / sum};
}

/// From the crown to the toe, a point per band.
std::vector<PlanPoint> find_course(const HazardMaps& maps, const RunOut& run_out) {
    const GridGeometry& g = maps.peak_depth.geometry;
    const TrailDistances ways(maps.peak_depth, run_out.crown);
    const double band = band_cells * g.cell;
    std::vector<PlanPoint> middles{run_out.crown};
    std::vector<std::uint8_t> taken(g.size(), 0);
    for (double from = band; from + band < run_out.along_flow; from += band) {
        const std::optional<std::size_t> k = ways.cell_on_way(run_out.toe, from + band / 2);
        if (!k || !(ways.at(*k) >= from && ways.at(*k) < from + band)) continue;
        middles.push_back(centroid(connected_cells(ways, g, *k, from, from + band, taken), maps));
    }
    middles.push_back(run_out.toe);

    std::vector<PlanPoint> course{middles.front()};
    for (std::size_t i = 1; i + 1 < middles.size(); ++i) {
        const PlanPoint &a = middles[i - 1], &m = middles[i], &b = middles[i + 1];
        course.push_back({(a.x + 2 * m.x + b.x) / 4, (a.y + 2 * m.y + b.y) / 4});
    }
    course.push_back(middles.back());
    return course;
}

/// Of the map cells around a place: the first arrival and the speed then. NaN: none.
struct Arrival {
    double time = never, speed = never;
};

Arrival first_arrival(const HazardMaps& maps, const PlanPoint& p) {
    const GridGeometry& g = maps.arrival_time.geometry;
    const double u = (p.x - g.x_min) / g.cell, v = (p.y - g.y_min) / g.cell;
    Arrival first;
    for (int row = std::max(0, static_cast<int>(v - reach_cells)); row < std::min<double>(g.rows, v + reach_cells);
         ++row) {
        for (int column = std::max(0, static_cast<int>(u - reach_cells));
             column < std::min<double>(g.columns, u + reach_cells); ++column) {
            if (std::hypot(column + 0.5 - u, row + 0.5 - v) > reach_cells) continue;
            const std::size_t k = g.index(column, row);
            const double time = maps.arrival_time.values[k];
            if (!(time < first.time || (std::isnan(first.time) && !std::isnan(time)))) continue;
            first = {time, static_cast<double>(maps.arrival_speed.values[k])};
        }
    }
    return first;
}

/// The front along the path, to the last place with an arrival; 0 where the releases lay.
FrontRecord record_front(const HazardMaps& maps, const terrain::FlowPath& path, const params::OutputSpec& outputs) {
    FrontRecord front;
    front.interval = outputs.chainage_interval;
    front.resolution = resolved_cells * maps.arrival_time.geometry.cell;
    front.window = std::max(outputs.front_velocity_window, front.resolution);
    for (std::size_t k = 0; static_cast<double>(k) * front.interval <= path.length(); ++k) {
        const Arrival arrival = first_arrival(maps, path.point_at(static_cast<double>(k) * front.interval));
        front.arrival.push_back(arrival.time);
        front.head.push_back({arrival.speed, arrival.speed});
    }
    while (!front.arrival.empty() && std::isnan(front.arrival.back())) front.arrival.pop_back();
    front.head.resize(front.arrival.size());
    // The front is at a place when debris is there or beyond.
    for (std::size_t k = front.arrival.size(); k-- > 1;) {
        if (front.arrival[k - 1] <= front.arrival[k]) continue;
        front.arrival[k - 1] = front.arrival[k];
        front.head[k - 1] = front.head[k];
    }
    return front;
}

/// The chainage of the front in every row.
void tell_front(const FrontRecord& front, std::vector<TimeSample>& timeseries) {
    for (TimeSample& row : timeseries) {
        const auto next = std::upper_bound(front.arrival.begin(), front.arrival.end(), row.time);
        row.front_chainage = next == front.arrival.begin()
                                 ? never
                                 : front.interval * static_cast<double>(next - front.arrival.begin() - 1);
    }
}

/// Takes a path, with the front along it by the maps.
void take_path(const terrain::FlowPath& path, const params::OutputSpec& outputs, Observation& observation) {
    FrontRecord front = record_front(observation.maps, path, outputs);
    tell_front(front, observation.timeseries);
    observation.run_out.front_chainage =
        front.arrival.empty() ? never : front.interval * static_cast<double>(front.arrival.size() - 1);
    // What the releases cover is no arrival.
    for (double& time : front.arrival) time = time > 0 ? time : never;
    observation.front = front.samples();
    observation.followed_path = path;
}

}  // namespace

void follow_debris(const sim::Ground& ground, double corridor_width, const params::OutputSpec& outputs,
                   Observation& observation) {
    const HazardMaps& maps = observation.maps;
    const RunOut& run_out = observation.run_out;
    const double cell = maps.peak_depth.geometry.cell;
    if (!(run_out.along_flow > shortest_cells * cell)) return;
    const terrain::FlowPath path(find_course(maps, run_out), corridor_width);
    take_path(path, outputs, observation);
    observation.erosion = measure_erosion(ground, path, outputs.chainage_interval);
}

void measure_along(const terrain::FlowPath& path, const params::OutputSpec& outputs, Observation& observation) {
    take_path(path, outputs, observation);
    if (observation.erosion.chainage.empty()) return;  // no bed
    set_upstream_volumes(path, outputs.chainage_interval, observation.erosion);
}

}  // namespace talus::observe
