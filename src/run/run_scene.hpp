#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "core/result.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::run {

/// Progress after a step.
struct Progress {
    double time, end_time;  ///< s
    double real_time_factor;
    double front_chainage;  ///< m; NaN: none
    double share_done;      ///< 0 to 1
    double wall_remaining;  ///< s, estimate
    std::uint64_t step;
    std::uint32_t particles;
};

struct RunOptions {
    std::function<void(const Progress&)> on_progress;                    ///< called after every step
    std::function<void(const LocalFrame&, const sim::State&)> on_frame;  ///< called every particle_series_interval
    const std::atomic<bool>* stop_requested = nullptr;                   ///< ends the run as interrupted
};

/// Runs a scene from beginning to end: until debris rests, end_time, a fault, or stop_requested.
/// Errors (before anything ran): as Run::start(), with the scene's file.
[[nodiscard]] Result<RunResult> run_scene(const scene::Scene& scene, const RunOptions& options);

/// The scene with the path that debris followed, if the result's chainages are along that.
void take_followed_path(scene::Scene& scene, const RunResult& result);

}  // namespace talus::run
