#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/archive.hpp"
#include "core/result.hpp"
#include "observe/observer.hpp"
#include "run/fault_record.hpp"
#include "run/run_result.hpp"
#include "run/stop_rule.hpp"
#include "run/threads.hpp"
#include "run/verdict.hpp"
#include "scene/scene.hpp"
#include "sim/relax.hpp"
#include "sim/simulation.hpp"
#include "sim/sources/inflow.hpp"

namespace talus::run {

/// Initial data of a run.
struct RunStart {
    sim::Model model;
    sim::Ground ground;
    sim::State state;
    sim::InflowFeeder inflow = {};
    terrain::FlowPath flow_path = {};  ///< empty: no front against chainage
    params::OutputSpec outputs = {};
    std::vector<terrain::Gauge> gauges = {};
    std::vector<terrain::CrossSection> cross_sections = {};
    /// Continues at rest, beyond solver.end_time and after a fault: the caller decides when it ends.
    bool endless = false;
    /// False: an endless run whose caller reads the state; the observer has what was at the start.
    bool measured = true;
    /// m: the flow path is a first guess, and the result is along the path that debris followed. 0: it stays.
    double followed_corridor_width = 0;
};

/// A run: a simulation, the observer that measures it, and the rule that says when it is over. Everything that runs a
/// scene uses this class: `talus run`, ensembles, the live twin, validation, benchmarks.
class Run {
  public:
    /// With the threads of `start.model.solver`.
    explicit Run(RunStart start);

    /// A copy that goes on by itself, to the same bits.
    explicit Run(const Run& other) = default;
    Run& operator=(const Run&) = delete;
    ~Run() = default;

    /// A run of a loaded scene, with its releases seeded; of all of it: a zoom is for run_scene(). `particle_spacing`,
    /// m: absent, the scene's own. Errors: a release smaller than a particle, more particles than
    /// solver.particle_limit, including those of inflows; `progress` ended it.
    [[nodiscard]] static Result<std::unique_ptr<Run>> start(const scene::Scene& scene,
                                                            std::optional<double> particle_spacing = {},
                                                            const sim::Progress& progress = {});

    /// Takes a step and measures it. False: the run was over before, or the step cannot be trusted; see phase().
    bool advance();
    /// Adds the particles of inflows that are due. A step begins with it.
    void inject_inflow() { simulation_.inject_inflow(watcher()); }

    /// Lets `edit` change model, ground and state, as Simulation::change() does; a run at rest becomes ready again.
    /// `edit` returns the id of the first new particle.
    void change(const std::function<std::uint32_t(sim::Model&, sim::Ground&, sim::State&)>& edit);
    /// Replaces the hydrograph of an inflow by one that is the same until now.
    void follow_gauge(std::size_t inflow, const std::vector<params::InflowSample>& hydrograph);
    /// Resets the record of a building, for example after it was moved.
    void forget_building(std::size_t building) { observer_.forget_building(model(), ground(), state(), building); }

    [[nodiscard]] RunPhase phase() const { return phase_; }
    /// Why it is at rest, ended or at fault; empty while ready.
    [[nodiscard]] const std::string& stop_reason() const { return stop_reason_; }
    [[nodiscard]] const sim::Model& model() const { return simulation_.model(); }
    [[nodiscard]] const sim::Ground& ground() const { return simulation_.ground(); }
    [[nodiscard]] const sim::State& state() const { return simulation_.state(); }
    /// Without the particles, which are not copied from a device for it.
    [[nodiscard]] const sim::StateSummary& summary() const { return simulation_.summary(); }
    [[nodiscard]] const sim::Simulation& simulation() const { return simulation_; }
    [[nodiscard]] const observe::Observer& observer() const { return observer_; }
    /// Of the run so far. Costs a look at the peak maps.
    [[nodiscard]] RunVerdict verdict() const;
    /// What is known about the first step that cannot be trusted, at fault.
    [[nodiscard]] const std::optional<FaultRecord>& fault() const { return fault_; }
    /// Parallel work on the run must use them.
    [[nodiscard]] const Threads& threads() const { return threads_; }
    [[nodiscard]] double wall_time() const { return wall_time_; }  ///< s, of the steps alone

    /// All that its steps have changed, between two of them, for restore() of a run of the same scene, which goes on as
    /// this one would: the result is that of the run that was not interrupted, to the bit.
    void save(ArchiveWriter& archive);
    /// What ended only because of solver.end_time goes on if that is later now.
    void restore(ArchiveReader& archive);

    /// The result if the run ends here. `unfinished`: why a run that could continue was stopped.
    [[nodiscard]] RunResult result(const std::string& unfinished = "stopped by the user") const;

  private:
    [[nodiscard]] bool over();
    [[nodiscard]] StillMoving moving_now() const;
    void take_step();
    [[nodiscard]] observe::Observer* watcher() { return measured_ ? &observer_ : nullptr; }
    [[nodiscard]] RunStatus status() const;
    void stop(RunPhase phase, std::string why);
    [[nodiscard]] bool inflow_to_come() const {
        return simulation_.inflow().remaining() > 0 || simulation_.inflow().awaits(summary().time);
    }
    [[nodiscard]] bool no_debris() const { return summary().count == 0 && !inflow_to_come(); }

    Threads threads_;
    sim::Simulation simulation_;
    observe::Observer observer_;
    StopRule stop_rule_;
    params::OutputSpec outputs_;
    double followed_corridor_width_;
    bool endless_, measured_;
    RunPhase phase_ = RunPhase::ready;
    std::string stop_reason_;
    std::optional<FaultRecord> fault_;
    double wall_time_ = 0, smallest_time_step_, largest_time_step_ = 0;
};

}  // namespace talus::run
