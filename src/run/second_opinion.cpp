#include "run/second_opinion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "observe/followed_path.hpp"

namespace talus::run {
namespace {

/// Cells of the terrain's corner that cover both maps.
GridGeometry common_cells(const scene::Scene& scene, const GridGeometry& a, const GridGeometry& b) {
    const Extent terrain = scene.terrain.elevation().geometry.extent();
    const double cell = std::max(a.cell, b.cell);
    Extent both = a.extent();
    both.include({b.extent().x_min, b.extent().y_min});
    both.include({b.extent().x_max, b.extent().y_max});
    // A hundredth of a cell: rounding of coordinates.
    const auto first = [&](double from, double origin) { return std::floor((from - origin) / cell + 0.01); };
    const auto last = [&](double to, double origin) { return std::ceil((to - origin) / cell - 0.01); };
    const double west = first(both.x_min, terrain.x_min), south = first(both.y_min, terrain.y_min);
    return {terrain.x_min + west * cell, terrain.y_min + south * cell, cell,
            std::max(1, static_cast<int>(last(both.x_max, terrain.x_min) - west)),
            std::max(1, static_cast<int>(last(both.y_max, terrain.y_min) - south))};
}

/// What the mean over a cell is of.
enum class MeanOf {
    cell,     ///< all of it, ground without debris counting as 0: a depth keeps its volume
    covered,  ///< the ground that debris covered
};

/// The mean of a map over each cell; NaN: no debris.
Grid<float> on_cells(const Grid<float>& map, const GridGeometry& cells, MeanOf of) {
    constexpr int parts = 4;
    Grid<float> result(cells, std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < cells.rows; ++row) {
        for (int column = 0; column < cells.columns; ++column) {
            const PlanPoint centre = cells.centre(column, row);
            double sum = 0;
            int covered = 0;
            for (int k = 0; k < parts * parts; ++k) {
                const int east = k % parts, north = k / parts;
                const float value = value_at(map, {centre.x + ((east + 0.5) / parts - 0.5) * cells.cell,
                                                   centre.y + ((north + 0.5) / parts - 0.5) * cells.cell});
                if (std::isnan(value)) continue;
                sum += value;
                ++covered;
            }
            if (covered == 0) continue;
            result.at(column, row) = static_cast<float>(sum / (of == MeanOf::cell ? parts * parts : covered));
        }
    }
    return result;
}

float zero_if_none(float value) {
    return std::isnan(value) ? 0 : value;
}

LargestDifference largest_on(const MapPair& maps) {
    LargestDifference found;
    const GridGeometry& g = maps.difference.geometry;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const double size = std::abs(maps.difference.at(column, row));
            if (std::isnan(size) || (found.known() && size <= std::abs(found.size()))) continue;
            found.particles = zero_if_none(maps.particles.at(column, row));
            found.depth_averaged = zero_if_none(maps.depth_averaged.at(column, row));
            found.at = g.centre(column, row);
        }
    }
    return found;
}

MapPair compare_maps(const Grid<float>& particles, const Grid<float>& depth_averaged, const GridGeometry& cells,
                     MeanOf of) {
    MapPair maps;
    maps.peak_particles = observe::peak_of(particles);
    maps.peak_depth_averaged = observe::peak_of(depth_averaged);
    maps.particles = on_cells(particles, cells, of);
    maps.depth_averaged = on_cells(depth_averaged, cells, of);
    maps.difference = Grid<float>(cells, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const float p = maps.particles.values[i], d = maps.depth_averaged.values[i];
        if (std::isnan(p) && std::isnan(d)) continue;
        maps.difference.values[i] = zero_if_none(d) - zero_if_none(p);
    }
    maps.largest = largest_on(maps);
    return maps;
}

double median_of(const Grid<float>& map, const std::vector<std::size_t>& cells) {
    if (cells.empty()) return observe::never;
    std::vector<float> values;
    values.reserve(cells.size());
    for (const std::size_t i : cells) values.push_back(map.values[i]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The medians over the ground that both covered deeper than `least`.
void set_medians(SecondOpinion& opinion, double least) {
    std::vector<std::size_t> shared;
    for (std::size_t i = 0; i < opinion.depth.difference.values.size(); ++i) {
        if (opinion.depth.particles.values[i] > least && opinion.depth.depth_averaged.values[i] > least) {
            shared.push_back(i);
        }
    }
    for (MapPair* maps : {&opinion.depth, &opinion.speed, &opinion.pressure}) {
        maps->median_particles = median_of(maps->particles, shared);
        maps->median_depth_averaged = median_of(maps->depth_averaged, shared);
    }
}

LargestDifference largest_arrival_difference(const RunResult& particles, const RunResult& depth_averaged) {
    LargestDifference found;
    for (const observe::FrontSample& front : particles.observation.front) {
        const double other = front_at(depth_averaged.observation, front.chainage).arrival_time;
        const double size = std::abs(other - front.arrival_time);
        if (std::isnan(size) || (found.known() && size <= std::abs(found.size()))) continue;
        found.particles = front.arrival_time;
        found.depth_averaged = other;
        found.chainage = front.chainage;
    }
    return found;
}

}  // namespace

double AreaAgreement::intersection_over_union() const {
    const double either = both + only_first + only_second;
    return either > 0 ? both / either : observe::never;
}

AreaAgreement area_agreement(const Grid<float>& first, const Grid<float>& second, double least) {
    assert(first.geometry == second.geometry);
    const double cell_area = first.geometry.cell * first.geometry.cell;
    AreaAgreement areas;
    for (std::size_t i = 0; i < first.values.size(); ++i) {
        const bool in_first = first.values[i] > least, in_second = second.values[i] > least;
        if (!in_first && !in_second) continue;
        (in_first && in_second ? areas.both : in_first ? areas.only_first : areas.only_second) += cell_area;
    }
    return areas;
}

void take_one_path(scene::Scene& scene, RunResult& particles, scene::Scene& grid_scene, RunResult& depth_averaged) {
    observe::Observation &p = particles.observation, &d = depth_averaged.observation;
    if (!p.followed_path && !d.followed_path) return;  // both are along the scene's
    const bool along_particles = p.followed_path && !(d.followed_path && d.run_out.along_flow > p.run_out.along_flow);
    const terrain::FlowPath path = along_particles ? *p.followed_path : *d.followed_path;
    observe::Observation& other = along_particles ? d : p;
    measure_along(path, scene.spec.outputs, other);
    for (scene::Scene* each : {&scene, &grid_scene}) {
        each->flow_path = path;
        each->flow_path_origin = scene::PathOrigin::followed;
        each->notes.push_back(fmt::format(
            "flow path: chainages of both models are along the path that debris followed {}, {:.0f} m from the crown "
            "to the farthest deposit; the traced one was a first guess",
            along_particles ? "with particles" : "in the depth-averaged model", path.length()));
    }
}

SecondOpinion second_opinion(const scene::Scene& scene, const RunResult& particles, const RunResult& depth_averaged) {
    const HazardMaps &p = particles.observation.maps, &d = depth_averaged.observation.maps;
    const GridGeometry cells = common_cells(scene, p.peak_depth.geometry, d.peak_depth.geometry);
    SecondOpinion opinion;
    opinion.depth = compare_maps(p.peak_depth, d.peak_depth, cells, MeanOf::cell);
    opinion.speed = compare_maps(p.peak_speed, d.peak_speed, cells, MeanOf::covered);
    opinion.pressure = compare_maps(p.peak_pressure, d.peak_pressure, cells, MeanOf::covered);
    const double least = scene.spec.outputs.arrival_depth;
    opinion.area = area_agreement(opinion.depth.particles, opinion.depth.depth_averaged, least);
    set_medians(opinion, least);
    opinion.arrival = largest_arrival_difference(particles, depth_averaged);
    return opinion;
}

}  // namespace talus::run
