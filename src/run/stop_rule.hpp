#pragma once

#include <algorithm>
#include <string>

#include "params/spec.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

/// When a run is over.
namespace talus {

/// Decides when debris has come to rest: its momentum stayed below a share of its peak for long enough.
class RestDetector {
  public:
    explicit RestDetector(const SolverSpec& solver)
        : fraction_(solver.stop_momentum_fraction), duration_(solver.stop_duration) {}

    /// `momentum`: total_momentum(); it needs no direction. `waiting`: a release has yet to start.
    bool at_rest(double time, double momentum, bool waiting) {
        peak_ = std::max(peak_, momentum);
        if (fraction_ <= 0 || waiting || momentum > fraction_ * peak_) {
            quiet_since_ = time;
            return false;
        }
        return time - quiet_since_ >= duration_;
    }
    /// Something was changed: debris is at rest only when it stays quiet from now on.
    void stir(double time) { quiet_since_ = time; }
    /// Debris was set free: what moved before no longer counts.
    void begin_anew(double time) {
        peak_ = 0;
        quiet_since_ = time;
    }
    /// "debris came to rest (...)".
    [[nodiscard]] std::string reason() const;

  private:
    double fraction_, duration_;
    double peak_ = 0, quiet_since_ = 0;
};

/// Sum of m |v|, kg m/s.
[[nodiscard]] double total_momentum(const Model& model, const State& state);

/// Whether a release has its start yet to come, or began with the last step; one that waits for a word does not count.
[[nodiscard]] bool still_waiting(const Model& model, const State& state);

[[nodiscard]] inline bool reached_end_time(const SolverSpec& solver, const State& state) {
    return state.time >= solver.end_time - 1e-9;
}
[[nodiscard]] std::string end_time_reason(const SolverSpec& solver);

inline constexpr const char* no_debris_reason = "all debris has left the terrain";

}  // namespace talus
