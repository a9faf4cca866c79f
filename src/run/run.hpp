#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "core/result.hpp"
#include "observe/observation.hpp"
#include "scene/scene.hpp"
#include "sim/model.hpp"
#include "sim/stage_times.hpp"
#include "sim/state.hpp"

namespace talus {

enum class RunStatus { complete, interrupted, fault };

struct RunResult {
    RunStatus status = RunStatus::complete;
    std::string stop_reason;  ///< "debris came to rest (momentum below 2 % of its peak for 3 s)", the fault, ...
    Observation observation;
    StageTimes stage_times;
    std::uint64_t hash = 0;  ///< of time, ids, positions and velocities at the end, in id order
    std::uint32_t particles = 0;
    std::uint64_t steps = 0;
    double simulated_time = 0, wall_time = 0;  ///< s; wall time of the stepping alone
    double smallest_time_step = 0, largest_time_step = 0;
    double particle_spacing = 0, support_radius = 0, map_cell = 0;
    double viscosity = 0, kinematic_viscosity = 0;  ///< smoothing per 1/60 s; the same thing in m2/s
    int thread_count = 0;
    std::string instruction_set;  ///< that the sums over neighbours ran on

    [[nodiscard]] double real_time_factor() const { return wall_time > 0 ? simulated_time / wall_time : 0; }
};

/// What a watcher is told after a step.
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
    std::function<void(const Progress&)> on_progress;          ///< called after every step
    std::function<void(const Model&, const State&)> on_frame;  ///< called every particle_series_interval
    const std::atomic<bool>* stop_requested = nullptr;         ///< ends the run as interrupted
};

class InflowFeeder;

/// Error: more particles than solver.particle_limit, with those that will come in.
[[nodiscard]] Status check_particles(const Model& model, std::uint32_t seeded, const InflowFeeder& feeder);

/// Threads to compute with: as the scene wants, or all cores.
[[nodiscard]] int thread_count(const SolverSpec& solver);

/// Seeds the releases and steps until debris rests, end_time, a fault, or stop_requested.
/// Errors (before anything ran): more particles than the limit, an empty release.
[[nodiscard]] Result<RunResult> run_scene(const Scene& scene, const RunOptions& options);

}  // namespace talus
