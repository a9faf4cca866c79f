#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "core/phases.hpp"

namespace talus::run {

/// What happens in a step of the depth-averaged model, in order.
enum class GridStage {
    keep_good,        ///< a copy of the state now and then, by which a fault is explained
    advance_cells,    ///< inflows, and the step of all tiles with debris
    resist_inside,    ///< friction inside the debris, where particles are fed
    entrain_bed,      ///< entrainment of the bed
    observe,          ///< maps, gauges, front, structures, time series
    release_held,     ///< debris whose start time is reached
    check_and_judge,  ///< whether the step can be trusted, and whether the run is over
};
inline constexpr std::array grid_stage_names = {"keep_good", "advance_cells", "resist_inside",  "entrain_bed",
                                                "observe",   "release_held",  "check_and_judge"};

/// Wall time by stage: one look at the clock per stage.
class GridStageTimes {
  public:
    void begin() { last_ = std::chrono::steady_clock::now(); }
    /// The time since begin() or the last end() was that of a stage.
    void end(GridStage stage) {
        const auto now = std::chrono::steady_clock::now();
        seconds_.at(static_cast<std::size_t>(stage)) += std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }
    [[nodiscard]] double of(GridStage stage) const { return seconds_.at(static_cast<std::size_t>(stage)); }
    [[nodiscard]] std::vector<Phase> all() const {
        std::vector<Phase> all;
        for (std::size_t k = 0; k < seconds_.size(); ++k) all.push_back({grid_stage_names.at(k), seconds_.at(k)});
        return all;
    }

  private:
    std::array<double, grid_stage_names.size()> seconds_{};
    std::chrono::steady_clock::time_point last_;
};

}  // namespace talus::run
