#include "session/pace.hpp"

namespace talus::session {
namespace {

using Seconds = std::chrono::duration<double>;
constexpr Seconds longest_debt{0.1};
constexpr Seconds longest_wait{5};  // more than the longest step takes at the slowest speed
constexpr Seconds window{0.5};

}  // namespace

void Pace::set_factor(std::optional<double> factor) {
    factor_ = factor;
    restart();
}

Clock::time_point Pace::due(double time, Clock::time_point now) {
    if (!factor_) return now;
    if (anchored_) {
        const Seconds after((time - time_) / *factor_);
        const auto when = wall_ + std::chrono::duration_cast<Clock::duration>(after);
        if (when >= now - longest_debt && when <= now + longest_wait) return when;
    }
    anchored_ = true;
    wall_ = now;
    time_ = time;
    return now;
}

void RateMeter::restart() {
    *this = RateMeter();
}

void RateMeter::count(double time_step, Clock::time_point now) {
    if (!since_) {
        since_ = now;  // the step that ends now began before anything was measured
        return;
    }
    ++steps_;
    simulated_ += time_step;
    const double elapsed = Seconds(now - *since_).count();
    if (elapsed <= 0 || (measured_ && elapsed < window.count())) return;
    steps_per_second_ = static_cast<double>(steps_) / elapsed;
    real_time_factor_ = simulated_ / elapsed;
    if (elapsed < window.count()) return;
    measured_ = true;
    since_ = now;
    steps_ = 0;
    simulated_ = 0;
}

}  // namespace talus::session
