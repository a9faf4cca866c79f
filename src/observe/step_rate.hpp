#pragma once

#include <chrono>
#include <cstdint>

namespace talus::observe {

/// Steps per second of wall time, over the last half second.
class StepRate {
  public:
    double update(std::uint64_t steps) {
        const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
        if (elapsed > 0.5) {
            rate_ = static_cast<double>(steps - steps_) / elapsed;
            steps_ = steps;
            start_ = Clock::now();
        } else if (rate_ == 0 && elapsed > 0) {
            return static_cast<double>(steps - steps_) / elapsed;
        }
        return rate_;
    }

  private:
    using Clock = std::chrono::steady_clock;

    Clock::time_point start_ = Clock::now();
    std::uint64_t steps_ = 0;
    double rate_ = 0;
};

}  // namespace talus::observe
