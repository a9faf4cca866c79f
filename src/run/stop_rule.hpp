#pragma once

#include <string>

#include "observe/observation.hpp"
#include "params/spec.hpp"
#include "sim/model.hpp"
#include "sim/motion.hpp"
#include "sim/state.hpp"

/// When a run is over. The same of both models.
namespace talus::run {

/// What of the debris moves, in particles or m3.
struct MovingDebris {
    double debris = 0;
    double moving = 0;      ///< faster than outputs.deposited_speed
    double fast = 0;        ///< ten times as fast
    double too_little = 0;  ///< less makes no front, however little there is in total
};
[[nodiscard]] MovingDebris moving_particles(const sim::StateSummary& state, const sim::Motion& motion);

/// Decides when moving debris can no longer change a product: for long enough, less than a given share of the debris
/// has moved (with the defaults too little for a front or to be visible on a map), and almost none of that fast enough
/// to climb, fall or hit something. Without debris it is at rest.
class RestDetector {
  public:
    explicit RestDetector(const params::SolverSpec& solver)
        : share_(solver.stop_moving_share), duration_(solver.stop_duration) {}

    /// `now` with the deposited speed. `waiting`: more debris is still to be released or to come in.
    bool at_rest(double time, const MovingDebris& now, bool waiting);
    /// Restarts the rest duration, after something was changed.
    void reset(double time) { quiet_since_ = time; }
    template <class Archive>
    void keep(Archive& archive) {
        archive(quiet_since_);
    }
    /// "debris came to rest (...)".
    [[nodiscard]] std::string reason() const;

  private:
    double share_, duration_;
    double quiet_since_ = 0;
};

/// Decides when a sum over the debris, its kinetic energy or momentum, has been below a share of its peak for long
/// enough; the peak since the last debris started or came in, so that a small late release is not cut off beside a
/// large early one. Other programs end runs so. It is no measure of rest: that of a thousandth of the debris in free
/// fall is small compared with the peak, and so is that of all debris running out slowly.
class DeclineDetector {
  public:
    DeclineDetector(const char* what, double share, double duration)
        : what_(what), share_(share), duration_(duration) {}

    bool declined(double time, double value, bool waiting);
    void reset(double time);
    template <class Archive>
    void keep(Archive& archive) {
        archive(peak_, low_since_);
    }
    /// "its kinetic energy fell below 1 % of its peak (for 3 s)".
    [[nodiscard]] std::string reason() const;

  private:
    const char* what_;
    double share_, duration_;
    double peak_ = 0, low_since_ = 0;
};

/// The rules by which a run is over before solver.end_time, of which each may be switched off.
class StopRule {
  public:
    explicit StopRule(const params::SolverSpec& solver);

    /// After a step. `latest`: of the time series. `waiting`: more debris is still to be released or to come in.
    bool over(double time, const MovingDebris& now, const observe::TimeSample& latest, bool waiting);
    void reset(double time);
    /// Why it is over, and whether by the rest of the debris.
    [[nodiscard]] const std::string& reason() const { return reason_; }
    [[nodiscard]] bool at_rest() const { return at_rest_; }
    template <class Archive>
    void keep(Archive& archive) {
        archive(rest_, energy_, momentum_, reason_, at_rest_);
    }

  private:
    RestDetector rest_;
    DeclineDetector energy_, momentum_;
    std::string reason_;
    bool at_rest_ = false;
};

/// Whether a release has not started yet, or started in the last step, or water still rises in it; one that waits to be
/// triggered does not count.
[[nodiscard]] bool still_waiting(const sim::Model& model, const sim::StateSummary& state);

[[nodiscard]] inline bool reached_end_time(const params::SolverSpec& solver, const sim::StateSummary& state) {
    return state.time >= solver.end_time - 1e-9;
}
/// "reached solver.end_time_s = 120".
[[nodiscard]] std::string end_time_reason(const params::SolverSpec& solver);

inline constexpr const char *no_debris_reason = "there is no debris",
                            *all_left_reason = "all debris has left the terrain";

}  // namespace talus::run
