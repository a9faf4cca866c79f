#include "observe/observation.hpp"

#include <algorithm>

namespace talus {

Deposit measure_deposit(const Grid<float>& deposit_depth, double least_depth) {
    std::vector<float> depths;
    for (const float depth : deposit_depth.values) {
        if (depth > least_depth) depths.push_back(depth);
    }
    if (depths.empty()) return {};
    const double cell_area = deposit_depth.geometry.cell * deposit_depth.geometry.cell;
    const auto high = depths.begin() + static_cast<std::ptrdiff_t>(9 * depths.size() / 10);
    std::nth_element(depths.begin(), high, depths.end());
    return {cell_area * static_cast<double>(depths.size()), *high};
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

}  // namespace talus
