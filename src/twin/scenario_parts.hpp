#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/copied.hpp"
#include "twin/action.hpp"
#include "twin/journal.hpp"
#include "twin/live_run.hpp"
#include "twin/scenario.hpp"
#include "twin/setup.hpp"
#include "twin/trigger.hpp"

namespace talus::twin {

/// A change that is ready to be carried out: of the present run, or a new one.
struct Scenario::Prepared {
    nlohmann::json action = nlohmann::json::object();
    std::string by;
    Done done;
    NextNumbers next;
    bool by_trigger = false;
    std::shared_ptr<LiveRun::Change> change;
    std::unique_ptr<LiveRun> anew;
    std::optional<GaugeReading> gauge;  ///< in place of both
};

/// What a scenario consists of.
struct Scenario::Parts {
    /// A setup that can be restored, and the change from or to it.
    struct Past {
        Setup setup;
        std::string sentence;
        bool by_trigger = false;
    };
    /// A change after the first step.
    struct ChangeOnTheWay {
        std::uint64_t step = 0;
        double time = 0;  ///< s
        std::string by, sentence;
        bool undoes = false;
    };

    Parts(std::shared_ptr<const scene::Scene> its_scene, ScenarioOptions its_options);

    std::shared_ptr<const scene::Scene> scene;
    ScenarioOptions options;
    double particle_spacing = 0;
    Copied<LiveRun> run;
    std::vector<Past> undo, redo;
    NextNumbers next;
    std::uint64_t revision = 0;  ///< of the setup
    nlohmann::json first_setup;  ///< the journal begins with it
    NextNumbers first_next;
    std::vector<JournalEntry> entries;
    std::vector<ChangeOnTheWay> changes;  ///< those without which the run would be that of its setup from time 0
    /// Where the zones from rasters lie, as told last: it takes long to find, and is told several times a second.
    mutable std::map<std::shared_ptr<const scene::Zone>, nlohmann::json> zone_blocks;
    std::string fault_note;  ///< at fault, what the reason does not say

    [[nodiscard]] const Setup& setup() const { return run->setup(); }
    /// Starts with a setup.
    [[nodiscard]] Status start(const Setup& setup, const sim::Progress& progress = {});
    [[nodiscard]] Result<std::unique_ptr<LiveRun>> run_of(const Setup& setup, const sim::Progress& progress) const;
    /// `run` begins the journal anew.
    void take(std::unique_ptr<LiveRun> run);
    /// The change of the run to a setup. Before the first step it is to begin as that setup would: see
    /// LiveRun::prepare(). After it, beds and inflows wait for the restart.
    [[nodiscard]] Status prepare(const Setup& next, Prepared& prepared, const sim::Progress& progress) const;
    void carry_out(Prepared& prepared);
    [[nodiscard]] Result<GaugeReading> prepare_gauge(const nlohmann::json& action, const ActionContext& context) const;
    /// Also in the setups that can be undone to: what a gauge has measured is not undone.
    void follow_gauge(const GaugeReading& reading);
    void keep_past(Prepared& prepared);
    void note_change(const nlohmann::json& action, const std::string& by, const std::string& sentence);
};

}  // namespace talus::twin
