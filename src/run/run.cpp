#include "run/run.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "observe/followed_path.hpp"
#include "scene/particle_spacing.hpp"
#include "sim/backend_choice.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/map_cell.hpp"

namespace talus::run {
namespace {

constexpr std::uint64_t steps_between_good_states = 16;  // a copy costs less than a hundredth of a step

std::vector<Initiation> initiations_of(const sim::Model& model, const sim::StateSummary& state) {
    std::vector<Initiation> all;
    for (std::size_t r = 0; r < model.releases.size(); ++r) {
        if (model.releases[r].water.empty()) continue;
        Initiation initiation{.release = model.releases[r].name};
        if (r < state.water_of_release.size() && state.water_of_release[r].started != 0) {
            const sim::Water& water = state.water_of_release[r];
            initiation.ratio = water.ratio;
            if (water.failed != 0) initiation.failed_at = water.failed_at;
        }
        all.push_back(std::move(initiation));
    }
    return all;
}

}  // namespace

Result<std::unique_ptr<Run>> Run::start(const scene::Scene& scene, std::optional<double> particle_spacing,
                                        const sim::Progress& progress) {
    const params::SceneSpec& spec = scene.spec;
    if (spec.solver.model != params::ModelChoice::particles) {
        return Error{"solver.model = \"depth_averaged\" is refused; this needs particles, talus run has both models"};
    }
    TALUS_TRY(sim::check_backend(spec.solver.backend));
    const double spacing = particle_spacing.value_or(scene::particle_spacing(scene));
    TALUS_TRY(sim::check_particle_count(scene.releases, scene.inflows, spec.solver, spacing));
    return Threads(spec.solver.thread_count).execute([&]() -> Result<std::unique_ptr<Run>> {
        sim::Model model = sim::make_model(spec.material, spec.solver, spacing, scene.cover);
        sim::Ground ground(scene.terrain, scene.buildings, model.support_radius, scene.bed);
        TALUS_ASSIGN(sim::State state, seed_releases(model, ground, scene.releases, progress));
        sim::InflowFeeder inflow(model, ground.terrain.frame(), scene.inflows);
        RunStart start{std::move(model), std::move(ground), std::move(state), std::move(inflow),
                       scene.flow_path,  spec.outputs,      scene.gauges,     scene.cross_sections};
        if (follows_debris(scene)) start.followed_corridor_width = spec.flow_path.corridor_width;
        return std::make_unique<Run>(std::move(start));
    });
}

Run::Run(RunStart start)
    : threads_(start.model.solver.thread_count),
      simulation_(std::move(start.model), std::move(start.ground), std::move(start.state), std::move(start.inflow)),
      observer_(model(), ground(), state(), start.flow_path, start.outputs,
                start.outputs.map_cell.value_or(
                    terrain::default_map_cell(ground().terrain.cell(), model().particle_spacing))),
      stop_rule_(model().solver),
      outputs_(start.outputs),
      followed_corridor_width_(start.followed_corridor_width),
      endless_(start.endless),
      measured_(start.measured),
      smallest_time_step_(std::numeric_limits<double>::infinity()) {
    observer_.watch(start.gauges);
    observer_.watch(model(), ground(), state(), start.cross_sections);
    observer_.expect(summary().seeded + simulation_.inflow().remaining());
    if (no_debris()) stop(RunPhase::at_rest, no_debris_reason);
}

void Run::stop(RunPhase phase, std::string why) {
    phase_ = phase;
    stop_reason_ = std::move(why);
}

bool Run::advance() {
    if (endless_) {
        stop(RunPhase::ready, "");
    } else if (phase_ != RunPhase::ready || over()) {
        return false;
    }
    const auto start = std::chrono::steady_clock::now();
    if (summary().step % steps_between_good_states == 0) simulation_.keep();
    threads_.execute([&] { take_step(); });
    wall_time_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return phase_ != RunPhase::fault;
}

StillMoving Run::moving_now() const {
    return still_moving(observer_.timeseries(), observer_.sample(model(), state()));
}

bool Run::over() {
    if (reached_end_time(model().solver, summary())) {
        stop(RunPhase::ended, with_what_moved(end_time_reason(model().solver), moving_now()));
    } else if (no_debris()) {
        stop(RunPhase::at_rest, all_left_reason);
    }
    return phase_ != RunPhase::ready;
}

void Run::take_step() {
    const Status stepped = simulation_.advance(watcher());
    smallest_time_step_ = std::min(smallest_time_step_, summary().time_step);
    largest_time_step_ = std::max(largest_time_step_, summary().time_step);
    if (!stepped) {
        // A run that continues all the same needs gapless measurements.
        if (endless_ && measured_) observer_.observe(model(), ground(), state());
        if (!fault_) fault_ = record_fault(model(), ground(), simulation_.kept(), state(), stepped.error().message);
        return stop(RunPhase::fault, stepped.error().message);
    }
    if (endless_) return;
    if (!observer_.failed_buildings().empty()) stop_rule_.reset(summary().time);
    const bool waiting = still_waiting(model(), summary()) || inflow_to_come();
    const MovingDebris now = moving_particles(summary(), simulation_.motion(outputs_.deposited_speed));
    if (stop_rule_.over(summary().time, now, observer_.latest(), waiting)) {
        stop(RunPhase::at_rest,
             stop_rule_.at_rest() ? stop_rule_.reason() : with_what_moved(stop_rule_.reason(), moving_now()));
    } else {
        (void)over();
    }
}

void Run::change(const std::function<std::uint32_t(sim::Model&, sim::Ground&, sim::State&)>& edit) {
    std::uint32_t first_new_id = 0;
    simulation_.change(
        [&](sim::Model& model, sim::Ground& ground, sim::State& state) { first_new_id = edit(model, ground, state); });
    if (measured_) observer_.follow(model(), ground(), state(), first_new_id);
    simulation_.keep();
    stop_rule_.reset(summary().time);
    if (phase_ == RunPhase::at_rest) stop(RunPhase::ready, "");
}

void Run::follow_gauge(std::size_t inflow, const std::vector<params::InflowSample>& hydrograph) {
    threads_.execute([&] { simulation_.follow_gauge(inflow, hydrograph); });
    observer_.expect(summary().seeded + simulation_.inflow().remaining());
    stop_rule_.reset(summary().time);
}

void Run::save(ArchiveWriter& archive) {
    simulation_.save(archive);
    observer_.save(archive);
    archive(stop_rule_, phase_, stop_reason_, smallest_time_step_, largest_time_step_);
}

void Run::restore(ArchiveReader& archive) {
    threads_.execute([&] { simulation_.restore(archive); });
    observer_.restore(archive);
    archive(stop_rule_, phase_, stop_reason_, smallest_time_step_, largest_time_step_);
    if (archive.failed()) return;
    observer_.expect(summary().seeded + simulation_.inflow().remaining());
    if (phase_ == RunPhase::ended) stop(RunPhase::ready, "");
}

RunStatus Run::status() const {
    return phase_ == RunPhase::fault   ? RunStatus::fault
           : phase_ == RunPhase::ready ? RunStatus::interrupted
                                       : RunStatus::complete;
}

RunVerdict Run::verdict() const {
    RunResult seen;
    seen.status = status();
    seen.particle_spacing = model().particle_spacing;
    seen.observation = threads_.execute([&] { return observer_.checked(model(), ground(), state()); });
    return judge(seen);
}

RunResult Run::result(const std::string& unfinished) const {
    RunResult result;
    result.status = status();
    result.stop_reason =
        phase_ == RunPhase::ready ? fmt::format("{} at t = {:.4g} s", unfinished, summary().time) : stop_reason_;
    if (phase_ == RunPhase::fault) {
        result.fault = fault_;
        result.stop_reason += fault_->sentence;
    }
    result.observation = threads_.execute([&] { return observer_.finish(model(), ground(), state()); });
    if (followed_corridor_width_ > 0) {
        observe::follow_debris(ground(), followed_corridor_width_, outputs_, result.observation);
    }
    result.initiations = initiations_of(model(), summary());
    result.stage_times = simulation_.stage_times();
    result.hash = hash_state(state());
    result.particles = summary().released();
    result.steps = summary().step;
    result.simulated_time = summary().time;
    result.wall_time = wall_time_;
    result.smallest_time_step = std::min(smallest_time_step_, largest_time_step_);
    result.largest_time_step = largest_time_step_;
    result.particle_spacing = model().particle_spacing;
    result.support_radius = model().support_radius;
    result.map_cell = observer_.maps().geometry().cell;
    result.viscosity = model().viscosity;
    result.kinematic_viscosity = model().kinematic_viscosity;
    result.thread_count = threads_.count();
    result.backend = sim::backend_name(simulation_.backend());
    result.instruction_set = simulation_.instruction_set();
    return result;
}

}  // namespace talus::run
