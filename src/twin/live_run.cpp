#include "twin/live_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "sim/inflow.hpp"
#include "sim/seed.hpp"

namespace talus::twin {

Result<std::unique_ptr<LiveRun>> LiveRun::start(const Scene& scene, const Setup& setup, double spacing,
                                                const ScenarioOptions& options) {
    const int threads = thread_count(scene.spec.solver);
    std::vector<Building> buildings;
    for (const BuildingSetup& building : setup.buildings) buildings.push_back(*building.body);
    for (const BarrierSetup& barrier : setup.barriers) buildings.push_back(*barrier.body);
    std::vector<Release> releases;
    for (const ReleaseSetup& release : setup.releases) releases.push_back(*release.body);
    tbb::task_arena arena(threads);
    return arena.execute([&]() -> Result<std::unique_ptr<LiveRun>> {
        Model model = make_model(setup.material, scene.spec.solver, scene.terrain, std::move(buildings), spacing);
        model.cover = lay_zones(bodies_of(setup.zones), scene.terrain).cover;
        model.bed = lay_bed(bodies_of(setup.beds), scene.terrain);
        Result<State> state = seed_releases(model, releases);
        if (!state) return state.error();
        InflowFeeder inflow(model, bodies_of(setup.inflows));
        if (Status s = check_particles(model, state->count, inflow); !s) return s.error();
        return std::unique_ptr<LiveRun>(
            new LiveRun(scene, setup, options, std::move(model), *std::move(state), std::move(inflow), threads));
    });
}

LiveRun::LiveRun(const Scene& scene, Setup setup, const ScenarioOptions& options, Model model, State state,
                 InflowFeeder inflow, int threads)
    : scene_(scene),
      begun_with_(std::move(setup)),
      setup_(begun_with_),
      thread_limit_(std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                          static_cast<std::size_t>(threads))),
      arena_(threads),
      threads_(threads),
      simulation_(std::move(model), std::move(state), std::move(inflow)),
      recording_(options.frame_interval, options.recording_bytes),
      rest_(scene.spec.solver),
      smallest_time_step_(scene.spec.solver.end_time) {
    for (const ReleaseSetup& release : setup_.releases) groups_.push_back({release.id, false});
    for (const BuildingSetup& building : setup_.buildings) obstacles_.push_back({building.id, building.body});
    for (const BarrierSetup& barrier : setup_.barriers) obstacles_.push_back({barrier.id, barrier.body, true});
    const OutputSpec& outputs = scene.spec.outputs;
    const double map_cell =
        outputs.map_cell.value_or(default_map_cell(scene.terrain.cell(), this->model().particle_spacing));
    observer_ = std::make_unique<Observer>(this->model(), this->state(), scene.flow_path, outputs, map_cell);
    observer_->expect(this->state().seeded + simulation_.inflow().to_come());
    slots_ = this->state().seeded;
    if (this->state().count == 0 && simulation_.inflow().to_come() == 0) stop(Phase::at_rest, "there is no debris");
    record();
}

bool LiveRun::has_begun(const std::string& release_id) const {
    const Group* group = find_id(groups_, release_id);
    return group != nullptr && group->begun;
}

double LiveRun::start_time_of(const std::string& release_id) const {
    const Group* group = find_id(groups_, release_id);
    return model().releases[static_cast<std::size_t>(group - groups_.data())].start_time;
}

bool LiveRun::not_converged() const {
    return state().mean_compression > mean_compression_limit || state().max_compression > max_compression_limit;
}

FramePtr LiveRun::frame(unsigned stride, unsigned flags) const {
    auto frame = std::make_shared<Frame>(make_frame(state(), observer_->maps().present(), slots_, stride,
                                                    flags | (not_converged() ? frame_not_converged : 0)));
    frame->rest_density = model().rest_density;
    return frame;
}

void LiveRun::record() {
    if (!recording_.due(state().time)) return;
    recording_.add(frame(1, 0));
    record_impacts();
    erosion_history_.add(state().time, state().entrained, model().bed.eroded);
}

void LiveRun::record_impacts() {
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
        const bool untouched = !observer_->impacts()[k].hit && !obstacles_[k].barrier;
        if (obstacles_[k].stands && !untouched) impact_history_.add(k, state().time, impact_now(k));
    }
}

void LiveRun::stop(Phase phase, std::string why) {
    phase_ = phase;
    message_ = std::move(why);
}

void LiveRun::advance() {
    if (phase_ != Phase::ready) return;
    if (reached_end_time(scene_.spec.solver, state())) return stop(Phase::ended, end_time_reason(scene_.spec.solver));
    if (state().count == 0 && simulation_.inflow().to_come() == 0) return stop(Phase::at_rest, no_debris_reason);
    const auto start = std::chrono::steady_clock::now();
    arena_.execute([&] { take_step(); });
    wall_time_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void LiveRun::take_step() {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        groups_[g].begun = groups_[g].begun || model().releases[g].start_time <= state().time;
    }
    const auto fault = simulation_.advance(observer_.get());
    slots_ = std::max(slots_, state().seeded);  // debris came in, or was picked up from the bed
    smallest_time_step_ = std::min(smallest_time_step_, state().time_step);
    largest_time_step_ = std::max(largest_time_step_, state().time_step);
    if (fault) return stop(Phase::fault, *fault);
    mark_failed();
    record();
    if (rest_.at_rest(state().time, total_momentum(model(), state()),
                      still_waiting(model(), state()) || simulation_.inflow().to_come() > 0)) {
        stop(Phase::at_rest, rest_.reason());
    } else if (reached_end_time(scene_.spec.solver, state())) {
        stop(Phase::ended, end_time_reason(scene_.spec.solver));
    } else if (state().count == 0 && simulation_.inflow().to_come() == 0) {
        stop(Phase::at_rest, no_debris_reason);
    }
}

BuildingImpact LiveRun::impact_now(std::size_t obstacle) const {
    BuildingImpact impact = observer_->impacts()[obstacle];
    if (const Overtopping* crossings = observer_->overtopping(obstacle)) {
        impact.held_volume = crossings->filling(state()).volume;
    }
    return impact;
}

BuildingImpact LiveRun::impact_on(const std::string& obstacle_id, std::optional<double> time) const {
    const auto k = static_cast<std::size_t>(find_id(obstacles_, obstacle_id) - obstacles_.data());
    if (!time) return impact_now(k);
    BuildingImpact impact = impact_history_.at(k, *time);
    impact.name = observer_->impacts()[k].name;
    return impact;
}

std::vector<float> LiveRun::eroded(std::optional<double> time) const {
    if (state().entrained == 0) return {};
    return time ? erosion_history_.at(*time) : model().bed.eroded;
}

std::vector<LiveRun::Removed> LiveRun::removed() const {
    std::vector<Removed> removed;
    for (const Obstacle& obstacle : obstacles_) {
        if (obstacle.stands || obstacle.until_step <= obstacle.since_step) continue;
        removed.push_back({obstacle.id, obstacle.body, obstacle.barrier, obstacle.last});
    }
    return removed;
}

void LiveRun::mark_failed() {
    if (observer_->failed_buildings().empty()) return;
    for (const std::size_t k : observer_->failed_buildings()) {
        obstacles_[k].stands = false;
        obstacles_[k].failed = true;
        impact_history_.add(k, state().time, impact_now(k));
    }
    rest_.stir(state().time);
}

RunResult LiveRun::result() const {
    RunResult result;
    result.status = phase_ == Phase::fault   ? RunStatus::fault
                    : phase_ == Phase::ready ? RunStatus::interrupted
                                             : RunStatus::complete;
    char text[80];
    std::snprintf(text, sizeof text, "written while running, at t = %.4g s", state().time);
    result.stop_reason = phase_ == Phase::ready ? text : message_;
    result.observation = arena_.execute([&] { return observer_->finish(model(), state()); });
    std::vector<BuildingImpact> standing;
    const auto take = [&](const auto& entries) {
        for (const auto& entry : entries) {
            const auto k = static_cast<std::size_t>(find_id(obstacles_, entry.id) - obstacles_.data());
            standing.push_back(std::move(result.observation.buildings[k]));
        }
    };
    take(setup_.buildings);
    take(setup_.barriers);
    for (const Removed& removed : this->removed()) standing.push_back(removed.impact);
    result.observation.buildings = std::move(standing);
    result.stage_times = simulation_.stage_times();
    result.instruction_set = simulation_.backend().instruction_set();
    result.hash = hash_state(state());
    result.particles = state().released();
    result.steps = state().step;
    result.simulated_time = state().time;
    result.wall_time = wall_time_;
    result.smallest_time_step = std::min(smallest_time_step_, largest_time_step_);
    result.largest_time_step = largest_time_step_;
    result.particle_spacing = model().particle_spacing;
    result.support_radius = model().support_radius;
    result.map_cell = observer_->maps().geometry().cell;
    result.viscosity = model().viscosity;
    result.kinematic_viscosity = model().kinematic_viscosity;
    result.thread_count = threads_;
    return result;
}

}  // namespace talus::twin
