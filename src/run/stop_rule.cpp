#include "run/stop_rule.hpp"

#include <cmath>

#include <fmt/format.h>

#include "simd/lanes.hpp"
#include "simd/parallel.hpp"

namespace talus {

std::string RestDetector::reason() const {
    return fmt::format("debris came to rest (momentum below {:.3g} % of its peak for {:.3g} s)", 100 * fraction_,
                       duration_);
}

/// Floats side by side over a group of particles, doubles over the groups.
double total_momentum(const Model& model, const State& state) {
    using L = simd::Lanes<4>;
    constexpr std::size_t group = 64;
    const VectorArray& v = state.velocity;
    const auto add_speeds = [&](std::size_t first, std::size_t last, double sum) {
        std::size_t i = first;
        for (; i + group <= last; i += group) {
            L speeds(0);
            for (std::size_t k = i; k < i + group; k += L::size) {
                const L vx = L::load(&v.x[k]), vy = L::load(&v.y[k]), vz = L::load(&v.z[k]);
                speeds += sqrt(vx * vx + vy * vy + vz * vz);
            }
            for (int lane = 0; lane < L::size; ++lane) sum += speeds.at(lane);
        }
        for (; i < last; ++i) sum += length(state.velocity.at(i));
        return sum;
    };
    return model.particle_mass() *
           simd::reduce_ranges(state.count, 8192, 0.0, add_speeds, [](double a, double b) { return a + b; });
}

bool still_waiting(const Model& model, const State& state) {
    return std::any_of(model.releases.begin(), model.releases.end(), [&](const ReleaseGroup& release) {
        return state.time <= release.start_time && std::isfinite(release.start_time);
    });
}

std::string end_time_reason(const SolverSpec& solver) {
    return fmt::format("reached solver.end_time_s = {:.4g}", solver.end_time);
}

}  // namespace talus
