#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/copied.hpp"
#include "core/result.hpp"
#include "run/forecast.hpp"
#include "run/run.hpp"
#include "scene/scene.hpp"
#include "twin/alarms.hpp"
#include "twin/erosion_history.hpp"
#include "twin/impact_history.hpp"
#include "twin/recording.hpp"
#include "twin/scenario.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// More are refused in a change of a live run: a scenario file decides for itself.
inline constexpr int max_live_particles = 1'000'000;

/// The run of a setup, from time 0, with its recording; between two steps it can be changed to another setup.
class LiveRun {
  public:
    /// `spacing`: of the particles, m. Errors: as of Run::start().
    [[nodiscard]] static Result<std::unique_ptr<LiveRun>> start(const scene::Scene& scene, const Setup& setup,
                                                                double spacing, const ScenarioOptions& options,
                                                                const sim::Progress& progress = {});

    /// A copy that goes on by itself, to the same bits.
    explicit LiveRun(const LiveRun& other) = default;
    LiveRun& operator=(const LiveRun&) = delete;
    ~LiveRun() = default;

    /// Takes a step if ready.
    void advance();
    /// A change to another setup: everything that can fail or takes long. It holds for the run as it is now. Null: no
    /// step was taken yet, and only a run that is started with that setup has its debris.
    struct Change;
    [[nodiscard]] Result<std::shared_ptr<Change>> prepare(const Setup& next, const sim::Progress& progress = {}) const;
    void carry_out(Change& change);
    /// Both at once: applies the differences. A release whose debris has started to move keeps its old shape; beds and
    /// inflows remain those of the start: see begun_with(). Errors: too many particles, a release smaller than a
    /// particle; then nothing is changed.
    [[nodiscard]] Status bring_to(const Setup& next);
    /// Puts in force an inflow of begun_with() whose hydrograph is the same until now.
    void follow_gauge(const std::string& inflow_id, const std::shared_ptr<const terrain::Inflow>& body);

    [[nodiscard]] const Setup& setup() const { return setup_; }
    [[nodiscard]] const Setup& begun_with() const { return begun_with_; }
    /// Whether a release has started.
    [[nodiscard]] bool has_begun(const std::string& release_id) const;

    /// s; infinity: it waits for its trigger.
    [[nodiscard]] double start_time_of(const std::string& release_id) const;

    [[nodiscard]] run::RunPhase phase() const { return run_->phase(); }
    [[nodiscard]] const std::string& message() const { return run_->stop_reason(); }
    [[nodiscard]] const sim::Model& model() const { return run_->model(); }
    [[nodiscard]] const sim::Ground& ground() const { return run_->ground(); }
    [[nodiscard]] const sim::State& state() const { return run_->state(); }
    [[nodiscard]] const sim::StateSummary& summary() const { return run_->summary(); }
    [[nodiscard]] const observe::Observer& observer() const { return run_->observer(); }
    [[nodiscard]] const Recording& recording() const { return recording_; }
    [[nodiscard]] bool too_compressed() const;
    /// As Run::verdict(), of a moment ago while the run goes on: looking takes at most a hundredth of the time.
    [[nodiscard]] const run::RunVerdict& verdict() const;
    [[nodiscard]] run::RunVerdict verdict_now() const { return run_->verdict(); }
    /// s, when the run is expected to be over; nothing before the first step, and while debris outlasts the estimate.
    [[nodiscard]] std::optional<double> expected_end() const;
    /// s of wall time until then, as fast as the run goes; nothing likewise.
    [[nodiscard]] std::optional<double> wall_remaining() const;
    /// What is known about the step that cannot be trusted, at fault.
    [[nodiscard]] const std::optional<run::FaultRecord>& fault() const { return run_->fault(); }
    [[nodiscard]] std::string instruction_set() const { return run_->simulation().instruction_set(); }
    /// The current frame. `stride` >= 1: every stride-th particle. `flags`: frame_running; the frame adds
    /// frame_too_compressed itself.
    [[nodiscard]] FramePtr frame(unsigned stride, unsigned flags) const;

    /// Impact on an obstacle of the setup, until now or until a time of the recording.
    [[nodiscard]] observe::BuildingImpact impact_on(const std::string& obstacle_id,
                                                    std::optional<double> time = {}) const;
    /// What is measured on it so far, without the debris that a barrier holds; nullptr: there is none.
    [[nodiscard]] const observe::BuildingImpact* measured_on(const std::string& obstacle_id) const;
    /// Those raised so far.
    [[nodiscard]] const std::vector<RaisedAlarm>& alarms() const { return alarms_.raised(); }
    /// m by cell of the terrain, as Bed::eroded, now or at a time of the recording; empty: no erosion.
    [[nodiscard]] std::vector<float> eroded(std::optional<double> time = {}) const;

    /// An obstacle that existed for at least one step and was removed.
    struct Removed {
        std::string id;
        std::shared_ptr<const terrain::Building> body;
        bool barrier = false;
        observe::BuildingImpact impact;  ///< until then, its removed_time set
    };
    [[nodiscard]] std::vector<Removed> removed() const;

    /// As Run::result() if the run ended now; buildings are the existing ones, in the setup's order, then barriers,
    /// then removed().
    [[nodiscard]] run::RunResult result() const;

  private:
    struct Group {  ///< parallel to Model::releases
        std::string id;
        bool begun = false;  ///< its debris could move in at least one step
    };
    struct Obstacle {  ///< parallel to Ground::buildings, which only grows
        std::string id;
        std::shared_ptr<const terrain::Building> body;  ///< also of a removed one
        bool barrier = false;
        std::uint64_t since_step = 0;  ///< when it was added or last moved
        bool stands = true;
        bool failed = false;             ///< destroyed by debris; not restored by a setup that contains it unchanged
        std::uint64_t until_step = 0;    ///< of a removed one, like the next
        observe::BuildingImpact last{};  ///< at its removal
    };
    LiveRun(std::unique_ptr<run::Run> run, const scene::Scene& scene, Setup setup, const ScenarioOptions& options);

    [[nodiscard]] run::Outlook outlook() const;

    [[nodiscard]] Status plan_obstacles(const Setup& next, Change& change) const;
    [[nodiscard]] Status plan_releases(const Setup& next, Change& change) const;
    [[nodiscard]] Status seed_debris(Change& change, const sim::Progress& progress) const;
    [[nodiscard]] bool begins_anew(const Change& change) const;
    [[nodiscard]] Status check_room(const ReleaseSetup& release, double particles) const;
    void put_in_force(Change& change);
    void replace_releases(sim::Model& model, sim::State& state, Change& change);
    void set_start_times(sim::Model& model, const sim::State& state, const Setup& next);
    void note_failed();
    void record();
    void record_impacts();
    [[nodiscard]] observe::BuildingImpact impact_now(std::size_t obstacle) const;

    Copied<run::Run> run_;
    Setup begun_with_, setup_;
    std::vector<Group> groups_;
    std::vector<Obstacle> obstacles_;
    std::uint32_t slots_ = 0;
    Recording recording_;
    run::RunClock clock_;
    double deposited_speed_;
    struct Judged {
        run::RunVerdict verdict;
        std::uint64_t step = 0;
        run::RunPhase phase = run::RunPhase::ready;
        std::chrono::steady_clock::time_point next{};  ///< when another look is cheap enough
    };
    mutable Judged judged_;
    std::chrono::steady_clock::time_point stepped_at_ = std::chrono::steady_clock::now();
    double going_ = 0;  ///< s of wall time, pauses left out
    ImpactHistory impact_history_;
    ErosionHistory erosion_history_;
    AlarmWatch alarms_;
};

}  // namespace talus::twin
