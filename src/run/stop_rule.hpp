#pragma once

#include <string>

#include "params/spec.hpp"
#include "sim/model.hpp"
#include "sim/motion.hpp"
#include "sim/state.hpp"

/// When a run is over.
namespace talus::run {

/// Decides when moving debris can no longer change a product: for long enough, less than a given share of the debris
/// has moved (with the defaults too little for a front or to be visible on a map), and almost none of that fast enough
/// to climb, fall or hit something. Momentum is no criterion: that of a thousandth of the debris in free fall is small
/// compared with its peak, and so is that of all debris running out slowly.
class RestDetector {
  public:
    explicit RestDetector(const params::SolverSpec& solver)
        : share_(solver.stop_moving_share), duration_(solver.stop_duration) {}

    /// `motion` with the deposited speed. `waiting`: more debris is still to be released.
    bool at_rest(const sim::StateSummary& state, const sim::Motion& motion, bool waiting);
    /// Restarts the rest duration, after something was changed.
    void stir(double time) { quiet_since_ = time; }
    /// "debris came to rest (...)".
    [[nodiscard]] std::string reason() const;

  private:
    double share_, duration_;
    double quiet_since_ = 0;
};

/// Whether a release has not started yet, or started in the last step; one that waits to be triggered does not count.
[[nodiscard]] bool still_waiting(const sim::Model& model, const sim::StateSummary& state);

[[nodiscard]] inline bool reached_end_time(const params::SolverSpec& solver, const sim::StateSummary& state) {
    return state.time >= solver.end_time - 1e-9;
}
/// "reached solver.end_time_s = 120", with the debris that still moved.
[[nodiscard]] std::string end_time_reason(const sim::Model& model, const sim::StateSummary& state,
                                          const sim::Motion& motion);

inline constexpr const char* no_debris_reason = "all debris has left the terrain";

}  // namespace talus::run
