#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "depth/solver.hpp"
#include "observe/map_accumulator.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::run {

/// Progress after a step.
struct Progress {
    double time, end_time;  ///< s
    double real_time_factor;
    double front_chainage;  ///< m, farthest so far along the scene's path; NaN: none
    double path_length;     ///< m, of that path; 0: none
    double share_done;      ///< 0 to 1
    double wall_remaining;  ///< s, estimate; NaN: too little is done to say
    std::uint64_t step;
    std::uint32_t particles;
};

/// The debris at one moment.
struct Frame {
    double time = 0;                          ///< s
    observe::MapAccumulator::Present debris;  ///< over the map's cells
    double thinnest_depth = 0;                ///< m; thinner debris has no speed
    const LocalFrame* frame = nullptr;        ///< of the particles
    const sim::State* particles = nullptr;    ///< null: depth-averaged
};

struct RunOptions {
    std::function<void(const Progress&)> on_progress;  ///< called after every step
    /// Called at the start, every outputs.series_interval_s and at the end, unless that is a fault.
    std::function<void(const Frame&)> on_frame;
    std::function<void(const depth::Solver&)> on_grid_step = {};  ///< called after every step of that model
    const std::atomic<bool>* stop_requested = nullptr;            ///< ends the run as interrupted
    std::string_view start_from = {};                             ///< a saved state (saved_state.hpp); empty: none
    std::string start_from_file = {};                             ///< where it was read, in errors
    /// Called once with the state, and the time of the run then, after the step that reaches `save_time`, s; if none
    /// does, or it is absent, at the end, unless that is a fault. Depth-averaged: at solver.end_time, which cuts the
    /// last step short, before that step, so that a run to a later end is the one that was not interrupted.
    std::function<void(const std::string& state, double time)> on_state = {};
    std::optional<double> save_time = {};
};

/// Says when a frame is due.
class FrameClock {
  public:
    FrameClock(const scene::Scene& scene, const RunOptions& options)
        : interval_(scene.spec.outputs.series_interval), wanted_(options.on_frame != nullptr) {}

    /// Whether one is due at `time`, s; at the end of the run, whether there is none at that time.
    [[nodiscard]] bool due(double time, bool at_end = false) {
        if (!wanted_ || time <= latest_ || (!at_end && time < next_ - 1e-9)) return false;
        while (next_ <= time + 1e-9) next_ += interval_;
        latest_ = time;
        return true;
    }

  private:
    double interval_, next_ = 0, latest_ = -1;
    bool wanted_;
};

/// Says when the state is to be saved.
class StateClock {
  public:
    explicit StateClock(const RunOptions& options) : time_(options.save_time), wanted_(options.on_state != nullptr) {}

    /// Whether it still is to be, sooner or later.
    [[nodiscard]] bool wanted() const { return wanted_; }
    /// Whether it is due at `time`, s; true once.
    [[nodiscard]] bool due(double time, bool at_end = false) {
        if (!wanted_ || (!at_end && (!time_ || time < *time_ - 1e-9))) return false;
        wanted_ = false;
        return true;
    }

  private:
    std::optional<double> time_;
    bool wanted_;
};

/// Runs a scene from beginning to end: until debris rests, end_time, a fault, or stop_requested. With a zoom: the
/// depth-averaged model first, then particles in its area.
/// Errors (before anything ran): as Run::start(), with the scene's file; a state that is not one of this scene.
[[nodiscard]] Result<RunResult> run_scene(const scene::Scene& scene, const RunOptions& options);

/// The scene with the path that debris followed, if the result's chainages are along that.
void take_followed_path(scene::Scene& scene, const RunResult& result);

}  // namespace talus::run
