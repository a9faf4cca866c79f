#include "run/second_opinion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

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

/// The mean of a map over each cell; what it does not know counts as 0, and NaN is where that is all.
Grid<float> on_cells(const Grid<float>& map, const GridGeometry& cells) {
    constexpr int parts = 4;
    Grid<float> result(cells, std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < cells.rows; ++row) {
        for (int column = 0; column < cells.columns; ++column) {
            const PlanPoint centre = cells.centre(column, row);
            double sum = 0;
            for (int k = 0; k < parts * parts; ++k) {
                const int east = k % parts, north = k / parts;
                const float value = value_at(map, {centre.x + ((east + 0.5) / parts - 0.5) * cells.cell,
                                                   centre.y + ((north + 0.5) / parts - 0.5) * cells.cell});
                if (value > 0) sum += value;
            }
            if (sum > 0) result.at(column, row) = static_cast<float>(sum / (parts * parts));
        }
    }
    return result;
}

float zero_if_none(float value) {
    return std::isnan(value) ? 0 : value;
}

LargestDifference largest_depth_difference(const SecondOpinion& opinion) {
    LargestDifference found;
    const GridGeometry& g = opinion.difference.geometry;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const double size = std::abs(opinion.difference.at(column, row));
            if (std::isnan(size) || (found.known() && size <= std::abs(found.size()))) continue;
            found.particles = zero_if_none(opinion.particles.at(column, row));
            found.depth_averaged = zero_if_none(opinion.depth_averaged.at(column, row));
            found.at = g.centre(column, row);
        }
    }
    return found;
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

SecondOpinion second_opinion(const scene::Scene& scene, const RunResult& particles, const RunResult& depth_averaged) {
    const Grid<float>&a = particles.observation.maps.peak_depth, &b = depth_averaged.observation.maps.peak_depth;
    const GridGeometry cells = common_cells(scene, a.geometry, b.geometry);
    SecondOpinion opinion;
    opinion.particles = on_cells(a, cells);
    opinion.depth_averaged = on_cells(b, cells);
    opinion.difference = opinion.particles;
    for (std::size_t i = 0; i < opinion.difference.values.size(); ++i) {
        const float p = opinion.particles.values[i], d = opinion.depth_averaged.values[i];
        if (!std::isnan(p) || !std::isnan(d)) opinion.difference.values[i] = zero_if_none(d) - zero_if_none(p);
    }
    opinion.area = area_agreement(opinion.particles, opinion.depth_averaged, scene.spec.outputs.arrival_depth);
    opinion.depth = largest_depth_difference(opinion);
    opinion.arrival = largest_arrival_difference(particles, depth_averaged);
    return opinion;
}

}  // namespace talus::run
