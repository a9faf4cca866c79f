#include "scene/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "core/lanes.hpp"
#include "observe/observer.hpp"
#include "sim/cpu/parallel.hpp"
#include "sim/seed.hpp"
#include "sim/simulation.hpp"

namespace talus {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Decides when debris has come to rest: its momentum stayed below a share of its peak for long enough.
class RestDetector {
  public:
    explicit RestDetector(const SolverSpec& solver)
        : fraction_(solver.stop_momentum_fraction), duration_(solver.stop_duration) {}

    /// `momentum`: root mean square stands in for it, it needs no direction. `waiting`: a release has yet to start.
    bool at_rest(double time, double momentum, bool waiting) {
        peak_ = std::max(peak_, momentum);
        if (fraction_ <= 0 || waiting || momentum > fraction_ * peak_) {
            quiet_since_ = time;
            return false;
        }
        return time - quiet_since_ >= duration_;
    }

  private:
    double fraction_, duration_;
    double peak_ = 0, quiet_since_ = 0;
};

/// Sum of m |v|, kg m/s: floats side by side over a group of particles, doubles over the groups.
double total_momentum(const Model& model, const State& state) {
    using L = Lanes<4>;
    constexpr std::size_t group = 64;
    const VectorArray& v = state.velocity;
    const auto add_speeds = [&](std::size_t first, std::size_t last, double sum) {
        std::size_t i = first;
        for (; i + group <= last; i += group) {
            L speeds(0);
            for (std::size_t k = i; k < i + group; k += L::size) {
                const L vx = L::load(&v.x[k]), vy = L::load(&v.y[k]), vz = L::load(&v.z[k]);
                speeds += sqrt(vx * vx + vy * vy + vz * vz);
            }
            for (int lane = 0; lane < L::size; ++lane) sum += speeds.at(lane);
        }
        for (; i < last; ++i) sum += length(state.velocity.at(i));
        return sum;
    };
    return model.particle_mass() *
           cpu::reduce_ranges(state.count, 8192, 0.0, add_speeds, [](double a, double b) { return a + b; });
}

/// Steps per second of wall time, over the last half second.
class RateMeter {
  public:
    double update(std::uint64_t steps) {
        const double elapsed = seconds_since(start_);
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
    Clock::time_point start_ = Clock::now();
    std::uint64_t steps_ = 0;
    double rate_ = 0;
};

struct Run {
    const Scene& scene;
    const RunOptions& options;
    RunResult result;

    void step_until_done(Simulation& simulation, Observer& observer);
    void report_progress(const Simulation& simulation, const Observer& observer, double wall_time) const;
};

void Run::report_progress(const Simulation& simulation, const Observer& observer, double wall_time) const {
    if (!options.on_progress) return;
    const State& state = simulation.state();
    const double end_time = scene.spec.solver.end_time;
    Progress progress{};
    progress.time = state.time;
    progress.end_time = end_time;
    progress.real_time_factor = wall_time > 0 ? state.time / wall_time : 0;
    progress.front_chainage = observer.front_chainage();
    progress.share_done = std::min(1.0, state.time / end_time);
    progress.wall_remaining = progress.real_time_factor > 0 ? (end_time - state.time) / progress.real_time_factor : 0;
    progress.step = state.step;
    progress.particles = state.count;
    options.on_progress(progress);
}

void Run::step_until_done(Simulation& simulation, Observer& observer) {
    const SolverSpec& solver = scene.spec.solver;
    const Model& model = simulation.model();
    const State& state = simulation.state();
    const double frame_interval = scene.spec.outputs.particle_series_interval;
    double next_frame = 0;
    const auto show_frame = [&] {
        if (!options.on_frame || frame_interval <= 0 || state.time < next_frame - 1e-9) return;
        options.on_frame(model, state);
        next_frame += frame_interval;
    };
    const double last_start =
        std::max_element(model.releases.begin(), model.releases.end(), [](const auto& a, const auto& b) {
            return a.start_time < b.start_time;
        })->start_time;

    RestDetector rest(solver);
    RateMeter rate;
    result.smallest_time_step = solver.end_time;
    show_frame();
    const Clock::time_point start = Clock::now();
    char text[160];
    while (true) {
        if (options.stop_requested && options.stop_requested->load()) {
            result.status = RunStatus::interrupted;
            std::snprintf(text, sizeof text, "stopped by the user at t = %.4g s", state.time);
            result.stop_reason = text;
            break;
        }
        if (state.time >= solver.end_time - 1e-9) {
            std::snprintf(text, sizeof text, "reached solver.end_time_s = %.4g", solver.end_time);
            result.stop_reason = text;
            break;
        }
        if (state.count == 0) {
            result.stop_reason = "all debris has left the terrain";
            break;
        }
        const auto fault = simulation.advance();
        result.smallest_time_step = std::min(result.smallest_time_step, state.time_step);
        result.largest_time_step = std::max(result.largest_time_step, state.time_step);
        if (fault) {
            result.status = RunStatus::fault;
            result.stop_reason = *fault;
            break;
        }
        {
            const StageTimer timer(simulation.stage_times(), Stage::observe);
            observer.after_step(model, state, rate.update(state.step));
        }
        show_frame();
        report_progress(simulation, observer, seconds_since(start));
        if (rest.at_rest(state.time, total_momentum(model, state), state.time <= last_start)) {
            std::snprintf(text, sizeof text, "debris came to rest (momentum below %.3g %% of its peak for %.3g s)",
                          100 * solver.stop_momentum_fraction, solver.stop_duration);
            result.stop_reason = text;
            break;
        }
    }
    result.wall_time = seconds_since(start);
}

Result<RunResult> run_in_arena(const Scene& scene, const RunOptions& options, int thread_count) {
    double volume = 0;
    for (const Release& release : scene.releases) volume += release.volume;
    const SceneSpec& spec = scene.spec;
    const double spacing = choose_particle_spacing(spec.solver, volume);
    Model model = make_model(spec.material, spec.solver, scene.terrain, scene.buildings, spacing);
    Result<State> seeded = seed_releases(model, scene.releases);
    if (!seeded) return Error{scene.file.string() + ": " + seeded.error().message};

    Run run{scene, options, {}};
    RunResult& result = run.result;
    result.particle_spacing = spacing;
    result.support_radius = model.support_radius;
    result.viscosity = model.viscosity;
    result.kinematic_viscosity = model.kinematic_viscosity;
    result.map_cell = spec.outputs.map_cell.value_or(default_map_cell(scene.terrain.cell(), spacing));
    result.thread_count = thread_count;
    result.particles = seeded->seeded;

    Simulation simulation(std::move(model), *std::move(seeded));
    Observer observer(simulation.model(), simulation.state(), scene.flow_path, spec.outputs, result.map_cell);
    run.step_until_done(simulation, observer);
    result.observation = observer.finish(simulation.model(), simulation.state());
    result.stage_times = simulation.stage_times();
    result.instruction_set = simulation.backend().instruction_set();
    result.hash = hash_state(simulation.state());
    result.steps = simulation.state().step;
    result.simulated_time = simulation.state().time;
    return std::move(result);
}

}  // namespace

Result<RunResult> run_scene(const Scene& scene, const RunOptions& options) {
    const int wanted = scene.spec.solver.thread_count;
    const int threads = wanted > 0 ? wanted : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute([&] { return run_in_arena(scene, options, threads); });
}

}  // namespace talus
