#pragma once

#include <array>
#include <chrono>
#include <string_view>

namespace talus {

/// The stages of a step, in order.
enum class Stage {
    predict_positions,
    find_neighbours,
    warm_start,
    solve_density,
    solve_contacts,
    undo_overlaps,
    enforce_boundaries,
    update_velocities,
    apply_viscosity,
    remove_left,
    entrain,
    observe,
};
inline constexpr int stage_count = 12;
inline constexpr std::array<std::string_view, stage_count> stage_names = {
    "predict_positions",  "find_neighbours",   "warm_start",      "solve_density", "solve_contacts", "undo_overlaps",
    "enforce_boundaries", "update_velocities", "apply_viscosity", "remove_left",   "entrain",        "observe"};

/// Wall seconds spent per stage since the start.
struct StageTimes {
    std::array<double, stage_count> seconds{};
};

/// Adds the time from construction to destruction to a stage.
class StageTimer {
  public:
    StageTimer(StageTimes& times, Stage stage) : times_(times), stage_(stage) {}
    ~StageTimer() {
        const auto elapsed = std::chrono::steady_clock::now() - start_;
        times_.seconds[static_cast<std::size_t>(stage_)] += std::chrono::duration<double>(elapsed).count();
    }
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

  private:
    StageTimes& times_;
    Stage stage_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace talus
