#include "run/run_scene.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "run/depth_run.hpp"
#include "run/run.hpp"

namespace talus::run {
namespace {

Progress progress_of(const Run& run) {
    const sim::State& state = run.state();
    Progress progress{};
    progress.time = state.time;
    progress.end_time = run.model().solver.end_time;
    progress.real_time_factor = run.wall_time() > 0 ? state.time / run.wall_time() : 0;
    progress.front_chainage = run.observer().front_chainage();
    progress.share_done = std::min(1.0, state.time / progress.end_time);
    progress.wall_remaining =
        progress.real_time_factor > 0 ? (progress.end_time - state.time) / progress.real_time_factor : 0;
    progress.step = state.step;
    progress.particles = state.count;
    return progress;
}

}  // namespace

Result<RunResult> run_scene(const scene::Scene& scene, const RunOptions& options) {
    if (scene.spec.solver.model == params::ModelChoice::depth_averaged) return run_depth_averaged(scene, options);
    const auto started = Run::start(scene);
    if (!started) return Error{scene.file.string() + ": " + started.error().message};
    Run& run = **started;
    const double frame_interval = scene.spec.outputs.particle_series_interval;
    double next_frame = 0;
    const auto show_frame = [&] {
        if (!options.on_frame || frame_interval <= 0 || run.state().time < next_frame - 1e-9) return;
        options.on_frame(run.ground().terrain.frame(), run.state());
        next_frame += frame_interval;
    };
    const auto stopped = [&] { return options.stop_requested && options.stop_requested->load(); };
    show_frame();
    while (!stopped() && run.advance()) {
        show_frame();
        if (options.on_progress) options.on_progress(progress_of(run));
    }
    return run.result();
}

void take_followed_path(scene::Scene& scene, const RunResult& result) {
    if (!result.observation.followed_path) return;
    scene.flow_path = *result.observation.followed_path;
    scene.flow_path_origin = scene::PathOrigin::followed;
    scene.notes.push_back(
        fmt::format("flow path: chainages are along the path that debris followed, {:.0f} m from the "
                    "crown to the farthest deposit; the traced one was a first guess",
                    scene.flow_path.length()));
}

}  // namespace talus::run
