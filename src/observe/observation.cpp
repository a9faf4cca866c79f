#include "observe/observation.hpp"

#include <algorithm>

namespace talus {

bool within_compression_limits(const Observation& observation) {
    return observation.worst_mean_compression <= mean_compression_limit &&
           observation.worst_max_compression <= max_compression_limit;
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
