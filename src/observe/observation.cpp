#include "observe/observation.hpp"

#include <algorithm>

namespace talus::observe {
namespace {

/// The value that so many tenths of them stay below. Changes their order.
float tenth(std::vector<float>& values, std::size_t tenths) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(tenths * values.size() / 10);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

Deposit measure_deposit(const Grid<float>& deposit_depth, double least_depth) {
    std::vector<float> depths;
    for (const float depth : deposit_depth.values) {
        if (depth > least_depth) depths.push_back(depth);
    }
    if (depths.empty()) return {};
    const double cell_area = deposit_depth.geometry.cell * deposit_depth.geometry.cell;
    return {cell_area * static_cast<double>(depths.size()), tenth(depths, 9)};
}

Grid<float> normal_to_slope(const Grid<float>& depth, const terrain::Terrain& terrain) {
    Grid<float> thickness = depth;
    for (int r = 0; r < depth.geometry.rows; ++r) {
        for (int c = 0; c < depth.geometry.columns; ++c) {
            thickness.at(c, r) *= static_cast<float>(terrain.slope_cosine_at(depth.geometry.centre(c, r)));
        }
    }
    return thickness;
}

FlowThickness measure_thickness(const Grid<float>& peak_depth, const terrain::Terrain& terrain, double least_depth) {
    const Grid<float> thickness = normal_to_slope(peak_depth, terrain);
    std::vector<float> reached;
    for (std::size_t i = 0; i < thickness.values.size(); ++i) {
        if (peak_depth.values[i] >= least_depth) reached.push_back(thickness.values[i]);
    }
    if (reached.empty()) return {};
    return {tenth(reached, 5), tenth(reached, 1)};
}

FrontSample front_at(const Observation& observation, double chainage) {
    const auto& front = observation.front;
    const FrontSample none{chainage, never, never, never};
    const auto after = std::lower_bound(front.begin(), front.end(), chainage,
                                        [](const FrontSample& s, double c) { return s.chainage < c; });
    if (after == front.end()) return none;
    if (after->chainage == chainage) return *after;
    if (after == front.begin()) return none;
    const FrontSample &a = *(after - 1), &b = *after;
    const double share = (chainage - a.chainage) / (b.chainage - a.chainage);
    const auto between = [&](double low, double high) { return low + share * (high - low); };
    return {chainage, between(a.arrival_time, b.arrival_time), between(a.front_velocity, b.front_velocity),
            between(a.particle_speed, b.particle_speed)};
}

}  // namespace talus::observe
