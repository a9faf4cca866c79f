#include "run/stop_rule.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "simd/parallel.hpp"

namespace talus::run {
namespace {

/// So few particles form no front (front_particle_count), however few there are in total.
constexpr std::uint32_t fewest = 5;
/// Debris slower than this times the deposited speed (1 m/s) rises by no more than 5 cm, and can fall only by becoming
/// faster.
constexpr double fast_ratio = 10;
/// Share of the debris that may still be fast: one particle in ten thousand.
constexpr double fast_share = 1e-4;

}  // namespace

Motion motion_of(const sim::State& state, double deposited_speed) {
    const auto slow = static_cast<float>(deposited_speed * deposited_speed);
    const auto fast = static_cast<float>(fast_ratio * fast_ratio) * slow;
    const sim::VectorArray& v = state.velocity;
    return simd::reduce_ranges(
        state.count, 8192, Motion{},
        [&](std::size_t first, std::size_t last, Motion sum) {
            for (std::size_t i = first; i < last; ++i) {
                const float square = v.x[i] * v.x[i] + v.y[i] * v.y[i] + v.z[i] * v.z[i];
                sum.moving += static_cast<std::uint32_t>(square >= slow);
                sum.fast += static_cast<std::uint32_t>(square >= fast);
            }
            return sum;
        },
        [](const Motion& a, const Motion& b) {
            return Motion{a.moving + b.moving, a.fast + b.fast};
        });
}

bool RestDetector::at_rest(const sim::State& state, bool waiting) {
    const double debris = state.count;
    const Motion motion = motion_of(state, deposited_speed_);
    const double enough = std::clamp(share_ * debris, std::min<double>(fewest, debris), debris);
    if (share_ <= 0 || waiting || motion.moving >= enough || motion.fast > fast_share * debris) {
        quiet_since_ = state.time;
        return false;
    }
    return state.time - quiet_since_ >= duration_;
}

std::string RestDetector::reason() const {
    return fmt::format("debris came to rest (less than {:.3g} % of it moving for {:.3g} s)", 100 * share_, duration_);
}

bool still_waiting(const sim::Model& model, const sim::State& state) {
    return std::any_of(model.releases.begin(), model.releases.end(), [&](const sim::ReleaseGroup& release) {
        return state.time <= release.start_time && std::isfinite(release.start_time);
    });
}

std::string end_time_reason(const sim::Model& model, const sim::State& state, double deposited_speed) {
    std::string reached = fmt::format("reached solver.end_time_s = {:.4g}", model.solver.end_time);
    const std::uint32_t moving = motion_of(state, deposited_speed).moving;
    if (moving == 0) return reached;
    return fmt::format("{} with {:.3g} m3 still moving ({:.3g} % of the debris)", reached,
                       moving * model.particle_volume(), 100.0 * moving / state.count);
}

}  // namespace talus::run
