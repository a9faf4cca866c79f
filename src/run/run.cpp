#include "run/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "observe/observer.hpp"
#include "run/stop_rule.hpp"
#include "sim/inflow.hpp"
#include "sim/seed.hpp"
#include "sim/simulation.hpp"

namespace talus {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

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
    RestDetector rest(solver);
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
        if (reached_end_time(solver, state)) {
            result.stop_reason = end_time_reason(solver);
            break;
        }
        if (state.count == 0 && simulation.inflow().to_come() == 0) {
            result.stop_reason = no_debris_reason;
            break;
        }
        const auto fault = simulation.advance(&observer);
        result.smallest_time_step = std::min(result.smallest_time_step, state.time_step);
        result.largest_time_step = std::max(result.largest_time_step, state.time_step);
        if (fault) {
            result.status = RunStatus::fault;
            result.stop_reason = *fault;
            break;
        }
        if (!observer.failed_buildings().empty()) rest.stir(state.time);
        show_frame();
        report_progress(simulation, observer, seconds_since(start));
        if (rest.at_rest(state.time, total_momentum(model, state),
                         still_waiting(model, state) || simulation.inflow().to_come() > 0)) {
            result.stop_reason = rest.reason();
            break;
        }
    }
    result.wall_time = seconds_since(start);
}

Result<RunResult> run_in_arena(const Scene& scene, const RunOptions& options, int thread_count) {
    const SceneSpec& spec = scene.spec;
    const double spacing = choose_particle_spacing(spec.solver, total_volume(scene));
    Model model = make_model(spec.material, spec.solver, scene.terrain, scene.buildings, spacing);
    model.cover = scene.cover;
    model.bed = scene.bed;
    Result<State> seeded = seed_releases(model, scene.releases);
    if (!seeded) return Error{scene.file.string() + ": " + seeded.error().message};
    InflowFeeder feeder(model, scene.inflows);
    if (Status s = check_particles(model, seeded->count, feeder); !s) {
        return Error{scene.file.string() + ": " + s.error().message};
    }

    Run run{scene, options, {}};
    RunResult& result = run.result;
    result.particle_spacing = spacing;
    result.support_radius = model.support_radius;
    result.viscosity = model.viscosity;
    result.kinematic_viscosity = model.kinematic_viscosity;
    result.map_cell = spec.outputs.map_cell.value_or(default_map_cell(scene.terrain.cell(), spacing));
    result.thread_count = thread_count;

    Simulation simulation(std::move(model), *std::move(seeded), std::move(feeder));
    Observer observer(simulation.model(), simulation.state(), scene.flow_path, spec.outputs, result.map_cell);
    observer.expect(simulation.state().seeded + simulation.inflow().to_come());
    run.step_until_done(simulation, observer);
    result.particles = simulation.state().seeded;
    result.observation = observer.finish(simulation.model(), simulation.state());
    result.stage_times = simulation.stage_times();
    result.instruction_set = simulation.backend().instruction_set();
    result.hash = hash_state(simulation.state());
    result.steps = simulation.state().step;
    result.simulated_time = simulation.state().time;
    return std::move(result);
}

}  // namespace

Status check_particles(const Model& model, std::uint32_t seeded, const InflowFeeder& feeder) {
    const double particles = static_cast<double>(seeded) + feeder.to_come();
    if (particles <= model.solver.particle_limit) return {};
    return Error{
        fmt::format("releases and inflows need {:.0f} particles of solver.particle_spacing_m = {:.4g}, more "
                    "than solver.particle_limit = {}; a larger spacing needs fewer",
                    particles, model.particle_spacing, model.solver.particle_limit)};
}

int thread_count(const SolverSpec& solver) {
    if (solver.thread_count > 0) return solver.thread_count;
    return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

Result<RunResult> run_scene(const Scene& scene, const RunOptions& options) {
    const int threads = thread_count(scene.spec.solver);
    // It is for more threads than cores, which an arena alone does not get. Of several such limits in a program the
    // least holds: with fewer threads the arena must do, or this run would slow another one beside it.
    std::optional<tbb::global_control> limit;
    if (static_cast<unsigned>(threads) > std::thread::hardware_concurrency()) {
        limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    }
    tbb::task_arena arena(threads);
    return arena.execute([&] { return run_in_arena(scene, options, threads); });
}

}  // namespace talus
