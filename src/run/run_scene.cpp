#include "run/run_scene.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/decimals.hpp"
#include "core/phases.hpp"
#include "core/try.hpp"
#include "run/depth_run.hpp"
#include "run/forecast.hpp"
#include "run/run.hpp"
#include "run/saved_state.hpp"
#include "run/zoom.hpp"

namespace talus::run {
namespace {

Outlook look_at(const scene::Scene& scene, const Run& run) {
    Outlook outlook = outlook_of(run.simulation(), scene.spec.outputs.deposited_speed);
    for (const terrain::Inflow& inflow : scene.inflows) {
        outlook.wait = std::max(outlook.wait, inflow.hydrograph.back().time - run.summary().time);
    }
    return outlook;
}

Progress progress_of(const scene::Scene& scene, const Run& run, const RunClock& clock) {
    const sim::StateSummary& state = run.summary();
    Progress progress{};
    progress.time = state.time;
    progress.end_time = run.model().solver.end_time;
    progress.real_time_factor = run.wall_time() > 0 ? state.time / run.wall_time() : 0;
    progress.front_chainage = run.observer().front_chainage();
    progress.path_length = scene.flow_path.empty() ? 0 : scene.flow_path.length();
    progress.share_done = clock.share_done();
    progress.wall_remaining = clock.wall_remaining();
    progress.step = state.step;
    progress.particles = state.count;
    return progress;
}

Result<RunResult> run_zoomed(const scene::Scene& scene, const RunOptions& options) {
    TALUS_ASSIGN(ZoomedScene zoomed, zoom_in(scene, options));
    TALUS_ASSIGN(RunResult result, run_scene(zoomed.scene, options));
    result.zoom = std::move(zoomed.record);
    return Result<RunResult>(std::move(result));
}

}  // namespace

Result<RunResult> run_scene(const scene::Scene& scene, const RunOptions& options) {
    if (options.on_state || !options.start_from.empty()) {
        const Status can = check_state_can_be_saved(scene);
        if (!can) return Error{scene.file.string() + ": " + can.error().message};
    }
    if (scene.spec.solver.model == params::ModelChoice::depth_averaged) return run_depth_averaged(scene, options);
    if (scene.zoom) return run_zoomed(scene, options);
    const StopWatch seeding;
    const auto started = Run::start(scene);
    if (!started) return Error{scene.file.string() + ": " + started.error().message};
    Run& run = **started;
    if (options.on_state) TALUS_TRY(check_run_can_be_saved(run));
    if (!options.start_from.empty()) {
        const Status restored = restore_state(scene, run, options.start_from);
        if (!restored) return Error{options.start_from_file + ": " + restored.error().message};
    }
    const double seed_time = seeding.seconds();
    StateClock state_clock(options);
    const auto look_at_state = [&](bool at_end = false) -> Status {
        const double time = run.summary().time;
        if (!state_clock.due(time, at_end)) return {};
        TALUS_ASSIGN(const std::string state, save_state(scene, run));
        options.on_state(state, time);
        return {};
    };
    FrameClock clock(scene, options);
    const auto show_frame = [&](bool at_end = false) {
        if (!clock.due(run.summary().time, at_end)) return;
        const observe::MapAccumulator& maps = run.observer().maps();
        options.on_frame(
            {run.summary().time, maps.present(), maps.thinnest_depth(), &run.ground().terrain.frame(), &run.state()});
    };
    const auto stopped = [&] { return options.stop_requested && options.stop_requested->load(); };
    RunClock run_clock(scene.spec.solver);
    show_frame();
    TALUS_TRY(look_at_state());
    while (!stopped() && run.advance()) {
        TALUS_TRY(look_at_state());
        show_frame();
        if (!options.on_progress) continue;
        run_clock.tick(run.wall_time(), run.summary().time, [&] { return look_at(scene, run); });
        options.on_progress(progress_of(scene, run, run_clock));
    }
    if (run.phase() != RunPhase::fault) {
        TALUS_TRY(look_at_state(true));
        show_frame(true);
    }
    const StopWatch finishing;
    RunResult result = run.result();
    result.seed_time = seed_time;
    result.finish_time = finishing.seconds();
    return Result<RunResult>(std::move(result));
}

void take_followed_path(scene::Scene& scene, const RunResult& result) {
    if (!result.observation.followed_path) return;
    scene.flow_path = *result.observation.followed_path;
    scene.flow_path_origin = scene::PathOrigin::followed;
    scene.notes.push_back(
        fmt::format("flow path: chainages are along the path that debris followed, {:.{}f} m from the "
                    "crown to the farthest deposit; the traced one was a first guess",
                    scene.flow_path.length(), decimals_for(scene.flow_path.length(), 0)));
}

}  // namespace talus::run
