#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "ensemble/plan.hpp"
#include "risk/outcome.hpp"
#include "run/variants.hpp"
#include "run/verdict.hpp"
#include "scene/scene.hpp"

/// The ensembles from which risk is counted: one for each class of events, and for each option of measures.
namespace talus::risk {

/// One ensemble: a class of events with an option.
struct Part {
    std::string option;        ///< empty: the ground without options
    std::size_t scenario = 0;  ///< of Study::scenarios
    run::SceneSource source;
    std::shared_ptr<const scene::Scene> scene;
    std::shared_ptr<const ensemble::PlannedRuns> runs;
    std::filesystem::path folder;
    std::shared_ptr<const nlohmann::ordered_json> definition;
};

struct Study {
    std::vector<std::string> options;  ///< the first is the base
    std::vector<params::RiskScenarioSpec> scenarios;
    bool per_event = false;   ///< the scene states no frequency: all is per event
    std::vector<Part> parts;  ///< option by option, and in each scenario by scenario
    Exposures exposures;
    [[nodiscard]] std::size_t run_count() const;
    [[nodiscard]] double frequency(std::size_t scenario) const;
    [[nodiscard]] const char* per() const { return per_event ? "per event" : "per year"; }
};

/// What is wanted of a scene.
struct StudyRequest {
    ensemble::EnsemblePlan plan;       ///< of every ensemble; classes of events differ in their seed
    run::SceneSource source;           ///< as given
    std::string scene_name;            ///< in the definitions of the ensembles
    std::vector<std::string> options;  ///< the first is the base; empty text: none in force
    std::filesystem::path folder;
    bool needs_risk = true;  ///< classes of events and exposures must be there
};

/// Loads every scene once, so that whatever is wrong is refused before a run. The draws of a class of events are the
/// same for every option. Errors: as find_exposures and PlannedRuns::make; no [[risk_scenario]] or [[exposure]] where
/// they are needed; a factor or a scenario that sets scene.option.
[[nodiscard]] Result<Study> plan_study(const StudyRequest& request);

/// What the runs of one option came to.
struct OptionOutcome {
    std::string option;
    std::vector<ScenarioOutcome> scenarios;
    Grid<float> debris;       ///< events in a year with debris deeper than outputs.arrival_depth_m; NaN: none
    Grid<float> individual;   ///< death in a year of a person who is always there; NaN: none; empty: not wanted
    std::size_t failed = 0;   ///< runs
    run::RunVerdict verdict;  ///< of all runs
    std::vector<run::RunVerdict> verdicts{};  ///< of each
};

/// Reads the complete ensembles of an option. Errors: a record cannot be read; fewer than two complete runs.
[[nodiscard]] Result<OptionOutcome> read_outcome(const Study& study, const std::string& option);

}  // namespace talus::risk
