#include "twin/depth_averaged.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/hash.hpp"
#include "core/hazard_maps.hpp"
#include "core/try.hpp"
#include "run/depth_run.hpp"
#include "run/verdict.hpp"
#include "run/words.hpp"
#include "scene/grid_cell.hpp"
#include "twin/gauges_json.hpp"
#include "twin/json_keys.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr double most_moments = 150, shortest_interval = 0.5;  // s

/// Of this thread, s: a run has one. A page knows the clock on the wall alone.
double processor_time() {
    timespec now{};
    if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now) != 0) clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double cells_of(const scene::Scene& scene, double cell) {
    const Extent e = scene.terrain.elevation().geometry.extent();
    return e.width() * e.height() / (cell * cell);
}

Grid<float> known_only(Grid<float> depth) {
    for (float& value : depth.values) {
        if (!(value > 0)) value = std::numeric_limits<float>::quiet_NaN();
    }
    return depth;
}

}  // namespace

messages::DepthAveragedResult DepthAveragedRun::message() const {
    const std::vector<observe::FrontSample>& samples = result.observation.front;
    return {.end_s = result.simulated_time,
            .complete = result.status == run::RunStatus::complete,
            .stop_reason = result.stop_reason,
            .verdict = json(verdict_json(judge(result))),
            .wall_time_s = result.wall_time,
            .processor_time_s = processor_time,
            .grid_cell_m = result.grid_cell,
            .hash = to_hex(result.hash),
            .notes = notes,
            .front = {.chainage_m = column(samples, &observe::FrontSample::chainage),
                      .arrival_time_s = column(samples, &observe::FrontSample::arrival_time),
                      .front_velocity_mps = column(samples, &observe::FrontSample::front_velocity)}};
}

Result<Grid<float>> DepthAveragedRun::layer(const std::string& name, std::optional<double> time) const {
    const auto map_names = map_keys("depth");
    if (std::find(map_names.begin(), map_names.end(), name) == map_names.end()) {
        return Error{fmt::format("layer = {}: must be one of {}", shown(json(name)), fmt::join(map_names, ", "))};
    }
    const HazardMaps& maps = result.observation.maps;
    if (name == "depth") {
        if (!time) return known_only(maps.deposit_depth);
        auto after =
            std::find_if(moments.begin(), moments.end(), [&](const Moment& m) { return m.time > *time + 1e-6; });
        if (after != moments.begin()) --after;
        return known_only(after->depth);
    }
    const NamedMap& named = *find_map(name);
    Grid<float> layer = maps.*named.grid;
    if (named.kind == MapKind::arrival && time) {
        for (float& value : layer.values) {
            if (value > *time) value = std::numeric_limits<float>::quiet_NaN();
        }
    }
    return layer;
}

Result<scene::Scene> for_depth_averaged(scene::Scene scene, const DepthAveragedLimits& limits) {
    if (const auto lacking = scene::depth_averaged_lacks(scene)) {
        return Error{fmt::format("The depth-averaged model {}.", lacking->why)};
    }
    params::SolverSpec& solver = scene.spec.solver;
    solver.model = params::ModelChoice::depth_averaged;
    solver.thread_count = 1;
    const double cell = scene::grid_cell(scene);
    double coarse = cell;
    while (cells_of(scene, coarse) > limits.most_cells) coarse *= 2;
    solver.grid_cell = coarse;
    scene.notes = scene::depth_averaged_notes(scene);
    if (coarse > cell) {
        scene.notes.push_back(fmt::format(
            "cells of {:.4g} m in place of {:.4g} m, which talus run has: this terrain is large", coarse, cell));
    }
    for (const terrain::Release& release : scene.releases) {
        if (std::isfinite(release.spec.start_time)) continue;
        scene.notes.push_back(fmt::format("release \"{}\" waits to be started, so it takes no part", release.name));
    }
    scene.spec.outputs.series_interval = std::max(shortest_interval, solver.end_time / most_moments);
    // Chainages are along the scene's path, as those of the live run.
    scene.flow_path_origin = scene::PathOrigin::file;
    return scene;
}

/// Keeps depths over time within a number of bytes.
class Moments {
  public:
    explicit Moments(std::size_t most_bytes) : most_bytes_(most_bytes) {}

    void add(const run::Frame& frame) {
        if (count_++ % every_ != 0) return;
        kept_.push_back({frame.time, frame.debris.depth});
        bytes_ += kept_.back().depth.values.size() * sizeof(float);
        while (bytes_ > most_bytes_ && kept_.size() > 2) thin();
    }
    [[nodiscard]] std::vector<DepthAveragedRun::Moment> take() { return std::move(kept_); }

  private:
    void thin() {
        every_ *= 2;
        std::vector<DepthAveragedRun::Moment> some;
        bytes_ = 0;
        for (std::size_t k = 0; k < kept_.size(); k += 2) {
            bytes_ += kept_[k].depth.values.size() * sizeof(float);
            some.push_back(std::move(kept_[k]));
        }
        kept_ = std::move(some);
    }

    std::size_t most_bytes_, bytes_ = 0;
    std::size_t count_ = 0, every_ = 1;
    std::vector<DepthAveragedRun::Moment> kept_;
};

struct DepthAveragedSteps::Parts {
    Parts(const scene::Scene& scene_, const DepthAveragedLimits& limits_)
        : scene(scene_), limits(limits_), moments(limits_.depth_bytes) {
        options.on_frame = [this](const run::Frame& frame) { moments.add(frame); };
        options.on_grid_step = [this](const depth::Solver& solver) { time = solver.time(); };
    }
    /// Counts the time that `work` takes.
    template <class Action>
    decltype(auto) measure(Action&& action) {
        const struct Counted {
            double& used;
            double begun = processor_time();
            ~Counted() { used += processor_time() - begun; }
        } counted{used};
        return action();
    }

    const scene::Scene& scene;
    DepthAveragedLimits limits;
    Moments moments;
    run::RunOptions options;
    double time = 0, used = 0;  ///< s; of processor time
    bool cut = false;           ///< it took too long
    std::optional<run::DepthRun> run;
};

DepthAveragedSteps::DepthAveragedSteps(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
DepthAveragedSteps::DepthAveragedSteps(DepthAveragedSteps&&) noexcept = default;
DepthAveragedSteps& DepthAveragedSteps::operator=(DepthAveragedSteps&&) noexcept = default;
DepthAveragedSteps::~DepthAveragedSteps() = default;

Result<DepthAveragedSteps> DepthAveragedSteps::start(const scene::Scene& scene, const DepthAveragedLimits& limits) {
    auto parts = std::make_unique<Parts>(scene, limits);
    TALUS_ASSIGN(auto run, parts->measure([&] { return run::DepthRun::start(scene, parts->options); }));
    parts->run = std::move(run);
    return DepthAveragedSteps(std::move(parts));
}

bool DepthAveragedSteps::advance() {
    parts_->cut = parts_->used > parts_->limits.longest;
    return !parts_->cut && parts_->measure([&] { return parts_->run->advance(); });
}

double DepthAveragedSteps::share() const {
    return parts_->time / parts_->scene.spec.solver.end_time;
}

DepthAveragedRun DepthAveragedSteps::finish() {
    DepthAveragedRun made;
    made.result = parts_->measure([&] { return parts_->run->finish(); });
    made.moments = parts_->moments.take();
    for (const std::string& note : parts_->scene.notes) made.notes.push_back(run::capitalised(note) + ".");
    made.processor_time = parts_->used;
    if (parts_->cut) {
        made.result.stop_reason = fmt::format(
            "ended after {:.0f} s of computing, the most that it may take beside a live run, at t = {:.4g} s",
            parts_->limits.longest, made.result.simulated_time);
    }
    return made;
}

Result<DepthAveragedRun> run_depth_averaged(const scene::Scene& scene, const std::atomic<bool>& stop,
                                            const std::function<void(double share)>& progress,
                                            const DepthAveragedLimits& limits) {
    TALUS_ASSIGN(DepthAveragedSteps steps, DepthAveragedSteps::start(scene, limits));
    while (!stop && steps.advance()) {
        if (progress) progress(steps.share());
    }
    return steps.finish();
}

}  // namespace talus::twin
