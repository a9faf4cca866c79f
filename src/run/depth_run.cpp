#include "run/depth_run.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/phases.hpp"
#include "core/try.hpp"
#include "depth/entrainment.hpp"
#include "depth/inflow.hpp"
#include "depth/internal_friction.hpp"
#include "depth/material.hpp"
#include "observe/followed_path.hpp"
#include "observe/grid_observer.hpp"
#include "run/depth_grid.hpp"
#include "run/forecast.hpp"
#include "run/grid_fault.hpp"
#include "run/grid_stages.hpp"
#include "run/inflow_energy.hpp"
#include "run/saved_state.hpp"
#include "run/stop_rule.hpp"
#include "run/threads.hpp"
#include "sim/sources/seed.hpp"

namespace talus::run {
namespace {

constexpr std::uint64_t steps_between_good_grids = 64;  // a look at all cells takes less than a step

double volume_of(const std::vector<terrain::Release>& releases) {
    double sum = 0;
    for (const terrain::Release& release : releases) sum += release.volume;
    return sum;
}

}  // namespace

/// What a run of the model is made of.
class GridRun {
  public:
    GridRun(const scene::Scene& scene, Inside inside)
        : scene_(scene),
          ground_(grid_ground(scene)),
          solver_(ground_.bed, depth::material_of(scene.spec.material), ground_.values),
          inflows_(solver_, scene.inflows),
          inflow_energy_(solver_, scene.inflows),
          friction_inside_(solver_,
                           inside == Inside::as_particles ? params::internal_friction_of(scene.spec.material) : 0),
          bed_(grid_bed(scene, ground_)),
          observer_(
              solver_, scene.flow_path, scene.spec.outputs,
              observe::GridStructures(solver_, scene.terrain, scene.buildings, ground_.structures, scene.spec.outputs),
              volume_of(scene.releases)),
          stop_rule_(scene.spec.solver),
          clock_(scene.spec.solver) {
        if (scene.spec.solver.flight) solver_.let_fly();
        held_ = volume_of(scene.releases);
        release_due();
        observer_.watch(solver_, scene.gauges);
        observer_.watch(solver_, scene.terrain, scene.cross_sections);
        solver_.watch(observer_.faces());
    }

    /// Errors: an inflow that no cell takes.
    [[nodiscard]] Status check_inflows() const {
        const std::size_t k = inflows_.first_unplaced();
        if (k == scene_.inflows.size()) return {};
        return Error{
            fmt::format("{}: inflow \"{}\" is refused; it lies on no cell of the depth-averaged model whose ground is "
                        "known and free of structures (cells of {:.4g} m)",
                        scene_.file.string(), scene_.inflows[k].name, solver_.geometry().cell)};
    }
    /// False: it is over; see stop_reason().
    bool advance() {
        if (over()) return false;
        const params::SolverSpec& spec = scene_.spec.solver;
        stages_.begin();
        keep_good_state();
        stages_.end(GridStage::keep_good);
        const StopWatch watch;
        double longest = scene_.spec.outputs.sample_interval;
        for (const terrain::Release& release : scene_.releases) {
            const double wait = release.spec.start_time - solver_.time();
            if (wait > 0) longest = std::min(longest, wait);
        }
        const Result<double> stepped =
            inflows_.advance(solver_, longest, observer_.released(), spec.end_time - solver_.time());
        stages_.end(GridStage::advance_cells);
        friction_inside_.resist(solver_);
        stages_.end(GridStage::resist_inside);
        wall_time_ += watch.seconds();
        smallest_ = std::min(smallest_, solver_.time_step());
        largest_ = std::max(largest_, solver_.time_step());
        observer_.note_inflow(stepped ? *stepped : 0, inflow_energy_.highest(solver_));
        stages_.end(GridStage::observe);
        observer_.note_entrainment(bed_.entrain(solver_));
        stages_.end(GridStage::entrain_bed);
        observer_.after_step(solver_, held_, wall_time_ > 0 ? static_cast<double>(solver_.steps()) / wall_time_ : 0);
        stages_.end(GridStage::observe);
        release_due();
        stages_.end(GridStage::release_held);
        const Status trusted = stepped ? find_grid_fault(solver_, observer_) : Status(stepped.error());
        if (!trusted) {
            fault_ = record_grid_fault(ground_.bed, good_, solver_, trusted.error().message);
            stop_reason_ = trusted.error().message + fault_->sentence;
        } else if (!over()) {
            judge();
        }
        stages_.end(GridStage::check_and_judge);
        return stop_reason_.empty();
    }

    /// Call it before a step after which state() may be asked for. solver.end_time cuts the last step short: a run to a
    /// later end goes on from before that.
    void keep_before_end() {
        const double left = scene_.spec.solver.end_time - solver_.time();
        if (solver_.next_step(scene_.spec.outputs.sample_interval) >= left - 1e-9) before_end_ = bytes();
    }
    [[nodiscard]] std::string state() {
        const bool cut = reached_end() && !before_end_.empty();
        return join_state(scene_, solver_.geometry().cell, solver_.time(), cut ? before_end_ : bytes());
    }
    /// Errors: as restore_state().
    [[nodiscard]] Status restore(std::string_view state) {
        TALUS_ASSIGN(const std::string_view saved, split_state(scene_, solver_.geometry().cell, state));
        ArchiveReader archive(saved);
        keep(archive);
        TALUS_TRY(check_whole(archive));
        good_ = GridState(solver_);
        good_released_ = released_;
        return {};
    }

    [[nodiscard]] double time() const { return solver_.time(); }
    [[nodiscard]] bool fault() const { return fault_.has_value(); }
    [[nodiscard]] Frame frame() const {
        return {solver_.time(), observer_.present(solver_), observer_.thinnest_depth()};
    }
    [[nodiscard]] const depth::Solver& solver() const { return solver_; }
    [[nodiscard]] Progress progress() {
        clock_.tick(wall_time_, solver_.time(), [&] { return outlook(); });
        Progress progress{};
        progress.time = solver_.time();
        progress.end_time = scene_.spec.solver.end_time;
        progress.real_time_factor = wall_time_ > 0 ? solver_.time() / wall_time_ : 0;
        progress.front_chainage = observer_.front_chainage();
        progress.path_length = scene_.flow_path.empty() ? 0 : scene_.flow_path.length();
        progress.share_done = clock_.share_done();
        progress.wall_remaining = clock_.wall_remaining();
        progress.step = solver_.steps();
        return progress;
    }

    [[nodiscard]] RunResult result(int threads) const {
        RunResult result;
        result.status = fault_ ? RunStatus::fault : stop_reason_.empty() ? RunStatus::interrupted : RunStatus::complete;
        result.stop_reason =
            stop_reason_.empty() ? fmt::format("stopped by the user at t = {:.4g} s", solver_.time()) : stop_reason_;
        result.fault = fault_;
        sim::Ground ground(scene_.terrain);
        ground.bed = terrain_bed(scene_, solver_.geometry(), bed_.bed());
        result.observation = observer_.finish(solver_, ground, held_);
        if (follows_debris(scene_)) {
            observe::follow_debris(ground, scene_.spec.flow_path.corridor_width, scene_.spec.outputs,
                                   result.observation);
        }
        result.hash = solver_.hash();
        result.steps = solver_.steps();
        result.simulated_time = solver_.time();
        result.wall_time = wall_time_;
        result.smallest_time_step = std::min(smallest_, largest_);
        result.largest_time_step = largest_;
        result.map_cell = solver_.geometry().cell;
        result.thread_count = threads;
        result.instruction_set = solver_.instruction_set();
        result.grid_cell = solver_.geometry().cell;
        result.grid_cells = solver_.geometry().size();
        result.cell_updates = solver_.cell_updates();
        result.grid_stages = stages_.all();
        return result;
    }

  private:
    template <class Archive>
    void keep(Archive& archive) {
        archive(solver_, inflows_, bed_, observer_, stop_rule_, released_, held_, judged_, smallest_, largest_,
                stop_reason_);
        if constexpr (Archive::reading) {
            if (released_ > scene_.releases.size()) archive.fail();
        }
    }
    [[nodiscard]] std::string bytes() {
        ArchiveWriter archive;
        keep(archive);
        return archive.take();
    }
    [[nodiscard]] bool reached_end() const { return solver_.time() >= scene_.spec.solver.end_time - 1e-9; }
    [[nodiscard]] bool over() {
        if (stop_reason_.empty() && reached_end()) {
            stop_reason_ = with_what_moved(end_time_reason(scene_.spec.solver), moving_now());
        }
        return !stop_reason_.empty();
    }
    void keep_good_state() {
        if (solver_.steps() % steps_between_good_grids != 0 && released_ == good_released_) return;
        good_ = GridState(solver_);
        good_released_ = released_;
    }
    void release_due() {
        for (; released_ < order().size(); ++released_) {
            const terrain::Release& release = scene_.releases[order()[released_]];
            if (solver_.time() < release.spec.start_time - 1e-9) break;
            const double before = solver_.volume();
            const Grid<float> depth = grid_release(scene_, release, ground_);
            solver_.add(depth, release.spec.pore_pressure_ratio, release.spec.solid_fraction);
            held_ = std::max(0.0, held_ - release.volume);
            observer_.note_release(solver_, depth, solver_.volume() - before, held_);
            stop_rule_.reset(solver_.time());
        }
    }
    /// The releases by their start.
    [[nodiscard]] const std::vector<std::size_t>& order() {
        if (order_.size() == scene_.releases.size()) return order_;
        for (std::size_t k = 0; k < scene_.releases.size(); ++k) order_.push_back(k);
        std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
            return scene_.releases[a].spec.start_time < scene_.releases[b].spec.start_time;
        });
        return order_;
    }
    [[nodiscard]] StillMoving moving_now() const {
        return still_moving(observer_.timeseries(), observer_.sample(solver_, held_, 0));
    }
    /// Whether it is over, at the samples of the time series.
    void judge() {
        const params::SolverSpec& spec = scene_.spec.solver;
        const observe::TimeSample& now = observer_.latest();
        if (now.time <= judged_) return;
        judged_ = now.time;
        const bool waits = inflows_.to_come() || (released_ < scene_.releases.size() &&
                                                  std::isfinite(scene_.releases[order()[released_]].spec.start_time));
        MovingDebris debris{now.volume_moving + now.volume_deposited, now.volume_moving};
        if (!(debris.debris > 0) && !waits) {
            stop_reason_ = now.volume_left > 0 ? all_left_reason : no_debris_reason;
            return;
        }
        if (debris.moving < spec.stop_moving_share * debris.debris) {  // else that alone says that it goes on
            debris.fast = observer_.volume_faster_than(
                solver_, double{sim::MotionCount::fast_ratio} * scene_.spec.outputs.deposited_speed);
        }
        if (!stop_rule_.over(now.time, debris, now, waits)) return;
        stop_reason_ = stop_rule_.at_rest() ? stop_rule_.reason() : with_what_moved(stop_rule_.reason(), moving_now());
    }

    [[nodiscard]] Outlook outlook() {
        if (!sliding_) {
            const double cell = solver_.geometry().cell;
            sliding_ = sim::make_model(scene_.spec.material, scene_.spec.solver, cell, scene_.cover);
            sliding_ground_ = sim::Ground(scene_.terrain, scene_.buildings, cell);
        }
        Outlook outlook = outlook_of(solver_, *sliding_, sliding_ground_, scene_.spec.outputs.deposited_speed);
        for (const terrain::Release& release : scene_.releases) {
            const double wait = release.spec.start_time - solver_.time();
            if (std::isfinite(wait)) outlook.wait = std::max(outlook.wait, wait);
        }
        return outlook;
    }

    const scene::Scene& scene_;
    GridGround ground_;
    depth::Solver solver_;
    depth::Inflows inflows_;
    InflowEnergy inflow_energy_;
    depth::InternalFriction friction_inside_;
    depth::Entrainment bed_;
    observe::GridObserver observer_;
    std::vector<std::size_t> order_;
    std::size_t released_ = 0;
    double held_ = 0, judged_ = 0;  ///< judged_: s, the sample by which it was not over
    double wall_time_ = 0, smallest_ = 1e9, largest_ = 0;
    GridStageTimes stages_;
    /// Of a few steps ago, after the last release: a fault is explained with it.
    GridState good_;
    std::size_t good_released_ = 0;
    std::optional<FaultRecord> fault_;
    std::string stop_reason_, before_end_;  ///< before_end_: see keep_before_end(); empty: not near it
    StopRule stop_rule_;
    RunClock clock_;
    std::optional<sim::Model> sliding_;  ///< what the clock's blocks slide by; made when it is asked
    sim::Ground sliding_ground_;
};

struct DepthRun::Parts {
    Parts(const scene::Scene& scene, const RunOptions& run_options)
        : options(run_options),
          threads(scene.spec.solver.thread_count),
          state_clock(options),
          frame_clock(scene, options) {}

    void look_at_state(bool at_end = false) {
        if (state_clock.due(run->time(), at_end)) options.on_state(run->state(), run->time());
    }
    void show_frame(bool at_end = false) {
        if (frame_clock.due(run->time(), at_end)) options.on_frame(run->frame());
    }
    /// A step. False: it is over.
    bool advance() {
        if (options.stop_requested && options.stop_requested->load()) return false;
        if (state_clock.wanted()) run->keep_before_end();
        const bool goes_on = run->advance();
        if (options.on_grid_step) options.on_grid_step(run->solver());
        if (!goes_on) return false;
        look_at_state();
        show_frame();
        if (options.on_progress) options.on_progress(run->progress());
        return true;
    }
    RunResult finish() {
        if (!run->fault()) {
            look_at_state(true);
            show_frame(true);
        }
        const StopWatch finishing;
        RunResult result = run->result(threads.count());
        result.seed_time = seed_time;
        result.finish_time = finishing.seconds();
        return result;
    }

    const RunOptions& options;
    Threads threads;
    std::optional<GridRun> run;
    StateClock state_clock;
    FrameClock frame_clock;
    double seed_time = 0;
};

DepthRun::DepthRun(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
DepthRun::DepthRun(DepthRun&&) noexcept = default;
DepthRun& DepthRun::operator=(DepthRun&&) noexcept = default;
DepthRun::~DepthRun() = default;

Result<DepthRun> DepthRun::start(const scene::Scene& scene, const RunOptions& options, Inside inside) {
    auto parts = std::make_unique<Parts>(scene, options);
    const Status started = parts->threads.execute([&]() -> Status {
        const StopWatch seeding;
        TALUS_TRY(parts->run.emplace(scene, inside).check_inflows());
        if (!options.start_from.empty()) {
            const Status restored = parts->run->restore(options.start_from);
            if (!restored) return Error{options.start_from_file + ": " + restored.error().message};
        }
        parts->seed_time = seeding.seconds();
        parts->show_frame();
        parts->look_at_state();
        return {};
    });
    if (!started) return started.error();
    return DepthRun(std::move(parts));
}

bool DepthRun::advance() {
    return parts_->threads.execute([&] { return parts_->advance(); });
}

RunResult DepthRun::finish() {
    return parts_->threads.execute([&] { return parts_->finish(); });
}

RunResult DepthRun::complete() {
    return parts_->threads.execute([&] {
        while (parts_->advance()) {
        }
        return parts_->finish();
    });
}

Result<RunResult> run_depth_averaged(const scene::Scene& scene, const RunOptions& options, Inside inside) {
    TALUS_ASSIGN(DepthRun run, DepthRun::start(scene, options, inside));
    return run.complete();
}

}  // namespace talus::run
