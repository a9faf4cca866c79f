#include "run/stop_rule.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace talus::run {
namespace {

/// So few particles form no front (front_particle_count), however few there are in total.
constexpr std::uint32_t fewest = 5;
/// Share of the debris that may still be fast: one particle in ten thousand.
constexpr double fast_share = 1e-4;

}  // namespace

bool RestDetector::at_rest(const sim::StateSummary& state, const sim::Motion& motion, bool waiting) {
    const double debris = state.count;
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

bool still_waiting(const sim::Model& model, const sim::StateSummary& state) {
    return std::any_of(model.releases.begin(), model.releases.end(), [&](const sim::ReleaseGroup& release) {
        return state.time <= release.start_time && std::isfinite(release.start_time);
    });
}

std::string end_time_reason(const sim::Model& model, const sim::StateSummary& state, const sim::Motion& motion) {
    std::string reached = fmt::format("reached solver.end_time_s = {:.4g}", model.solver.end_time);
    const std::uint32_t moving = motion.moving;
    if (moving == 0) return reached;
    return fmt::format("{} with {:.3g} m3 still moving ({:.3g} % of the debris)", reached,
                       moving * model.particle_volume(), 100.0 * moving / state.count);
}

}  // namespace talus::run
