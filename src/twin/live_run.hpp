#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "run/run.hpp"
#include "scene/scene.hpp"
#include "twin/erosion_history.hpp"
#include "twin/impact_history.hpp"
#include "twin/recording.hpp"
#include "twin/scenario.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// The run of a setup, from time 0, with its recording; between two steps it can be brought to another setup.
class LiveRun {
  public:
    /// `spacing`: of the particles, m. Errors: as of Run::start().
    [[nodiscard]] static Result<std::unique_ptr<LiveRun>> start(const Scene& scene, const Setup& setup, double spacing,
                                                                const ScenarioOptions& options);

    /// Takes a step if ready.
    void advance();
    /// Changes what differs. A release whose debris has begun to move keeps its old shape, beds and inflows stay as
    /// they were at the start: see begun_with(). Errors: too many particles,
    /// a release smaller than a particle; nothing has changed then.
    [[nodiscard]] Status bring_to(const Setup& next);

    [[nodiscard]] const Setup& setup() const { return setup_; }
    [[nodiscard]] const Setup& begun_with() const { return begun_with_; }
    /// Whether a release's debris has been let go.
    [[nodiscard]] bool has_begun(const std::string& release_id) const;

    /// s; infinity: it waits for its trigger.
    [[nodiscard]] double start_time_of(const std::string& release_id) const;

    [[nodiscard]] RunPhase phase() const { return run_->phase(); }
    [[nodiscard]] const std::string& message() const { return run_->stop_reason(); }
    [[nodiscard]] const Model& model() const { return run_->model(); }
    [[nodiscard]] const Ground& ground() const { return run_->ground(); }
    [[nodiscard]] const State& state() const { return run_->state(); }
    [[nodiscard]] const Observer& observer() const { return run_->observer(); }
    [[nodiscard]] const Recording& recording() const { return recording_; }
    [[nodiscard]] bool too_compressed() const;
    [[nodiscard]] std::string instruction_set() const {
        return std::string(run_->simulation().backend().instruction_set());
    }
    [[nodiscard]] FramePtr frame(unsigned stride, unsigned flags) const;

    /// What an obstacle of the setup has met, until now or until a time of the recording.
    [[nodiscard]] BuildingImpact impact_on(const std::string& obstacle_id, std::optional<double> time = {}) const;
    /// m by cell of the terrain, as Bed::eroded, now or at a time of the recording; empty: nothing was picked up.
    [[nodiscard]] std::vector<float> eroded(std::optional<double> time = {}) const;

    /// An obstacle that stood for a step at least and was taken away.
    struct Removed {
        std::string id;
        std::shared_ptr<const Building> body;
        bool barrier = false;
        BuildingImpact impact;  ///< until then, its removed_time set
    };
    [[nodiscard]] std::vector<Removed> removed() const;

    /// As Run::result() if the run ended here; buildings are those that stand, in the setup's order, then barriers,
    /// then removed().
    [[nodiscard]] RunResult result() const;

  private:
    struct Group {  ///< beside Model::releases
        std::string id;
        bool begun = false;  ///< a step was taken in which its debris could move
    };
    struct Obstacle {  ///< beside Ground::buildings, which only grows
        std::string id;
        std::shared_ptr<const Building> body;  ///< also of one that was taken away
        bool barrier = false;
        std::uint64_t since_step = 0;  ///< when it came, or was moved, to where it is
        bool stands = true;
        bool failed = false;           ///< under debris; a setup that still has it as it was does not put it up again
        std::uint64_t until_step = 0;  ///< of one that was taken away, as the next
        BuildingImpact last{};         ///< as it was taken away
    };
    struct Change;

    LiveRun(std::unique_ptr<Run> run, Setup setup, const ScenarioOptions& options);

    [[nodiscard]] Result<Change> plan(const Setup& next) const;
    void plan_obstacles(const Setup& next, Change& change) const;
    [[nodiscard]] Status plan_releases(const Setup& next, Change& change) const;
    void carry_out(Change& change, const Setup& next);
    void replace_releases(Model& model, State& state, Change& change);
    void set_start_times(Model& model, const State& state, const Setup& next);
    void note_failed();
    void record();
    void record_impacts();
    [[nodiscard]] BuildingImpact impact_now(std::size_t obstacle) const;

    std::unique_ptr<Run> run_;
    Setup begun_with_, setup_;
    std::vector<Group> groups_;
    std::vector<Obstacle> obstacles_;
    std::uint32_t slots_ = 0;
    Recording recording_;
    ImpactHistory impact_history_;
    ErosionHistory erosion_history_;
};

}  // namespace talus::twin
