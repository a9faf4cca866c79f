#include "run/stop_rule.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace talus::run {
namespace {

/// So few particles form no front (front_particle_count).
constexpr std::uint32_t fewest = 5;
/// Share of the debris that may still be fast: one particle in ten thousand.
constexpr double fast_share = 1e-4;

}  // namespace

MovingDebris moving_particles(const sim::StateSummary& state, const sim::Motion& motion) {
    return {static_cast<double>(state.count), static_cast<double>(motion.moving), static_cast<double>(motion.fast),
            static_cast<double>(fewest)};
}

bool RestDetector::at_rest(double time, const MovingDebris& now, bool waiting) {
    const double enough = std::clamp(share_ * now.debris, std::min(now.too_little, now.debris), now.debris);
    const bool moves = now.debris > 0 && (now.moving >= enough || now.fast > fast_share * now.debris);
    if (share_ <= 0 || waiting || moves) {
        quiet_since_ = time;
        return false;
    }
    return time - quiet_since_ >= duration_;
}

std::string RestDetector::reason() const {
    return fmt::format("debris came to rest (less than {:.3g} % of it moving for {:.3g} s)", 100 * share_, duration_);
}

bool DeclineDetector::declined(double time, double value, bool waiting) {
    peak_ = waiting ? value : std::max(peak_, value);
    if (share_ <= 0 || waiting || !(peak_ > 0) || value >= share_ * peak_) {
        low_since_ = time;
        return false;
    }
    return time - low_since_ >= duration_;
}

void DeclineDetector::reset(double time) {
    low_since_ = time;
    peak_ = 0;
}

std::string DeclineDetector::reason() const {
    return fmt::format("{} fell below {:.3g} % of its peak (for {:.3g} s)", what_, 100 * share_, duration_);
}

StopRule::StopRule(const params::SolverSpec& solver)
    : rest_(solver),
      energy_("kinetic energy", solver.stop_energy_share, solver.stop_duration),
      momentum_("momentum", solver.stop_momentum_share, solver.stop_duration) {}

bool StopRule::over(double time, const MovingDebris& now, const observe::TimeSample& latest, bool waiting) {
    // All of them see every step.
    at_rest_ = rest_.at_rest(time, now, waiting);
    const bool slow = energy_.declined(latest.time, latest.kinetic_energy, waiting);
    const bool weak = momentum_.declined(latest.time, latest.momentum, waiting);
    if (!(at_rest_ || slow || weak)) return false;
    reason_ = at_rest_ ? rest_.reason() : slow ? energy_.reason() : momentum_.reason();
    return true;
}

void StopRule::reset(double time) {
    rest_.reset(time);
    energy_.reset(time);
    momentum_.reset(time);
}

bool still_waiting(const sim::Model& model, const sim::StateSummary& state) {
    if (water_to_come(model, state)) return true;
    return std::any_of(model.releases.begin(), model.releases.end(), [&](const sim::ReleaseGroup& release) {
        return state.time <= release.start_time && std::isfinite(release.start_time);
    });
}

std::string end_time_reason(const params::SolverSpec& solver) {
    return fmt::format("reached solver.end_time_s = {:.4g}", solver.end_time);
}

}  // namespace talus::run
