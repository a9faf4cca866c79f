#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace talus::session {

using Clock = std::chrono::steady_clock;

/// Says when the next step is due so that simulated time passes `factor` times as fast as wall time.
class Pace {
  public:
    /// Empty: as fast as possible.
    void set_factor(std::optional<double> factor);
    [[nodiscard]] std::optional<double> factor() const { return factor_; }
    /// Starts again from now, regardless of the past.
    void restart() { anchored_ = false; }
    /// Wall time at which the step from simulated `time`, s, is due. Slow steps do not accumulate a delay that would be
    /// caught up later.
    [[nodiscard]] Clock::time_point due(double time, Clock::time_point now);

  private:
    std::optional<double> factor_ = 1.0;
    bool anchored_ = false;
    Clock::time_point wall_{};
    double time_ = 0;
};

/// Steps and simulated seconds per second of wall time, over the last half second or so.
class RateMeter {
  public:
    void restart();
    void count(double time_step, Clock::time_point now);
    [[nodiscard]] double steps_per_second() const { return steps_per_second_; }
    [[nodiscard]] double real_time_factor() const { return real_time_factor_; }

  private:
    std::optional<Clock::time_point> since_;
    std::uint64_t steps_ = 0;
    double simulated_ = 0;
    bool measured_ = false;
    double steps_per_second_ = 0, real_time_factor_ = 0;
};

}  // namespace talus::session
