#pragma once

#include <string>
#include <utility>
#include <vector>

#include "twin/journal.hpp"
#include "twin/live_run.hpp"
#include "twin/scenario.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// Shared by scenario*.cpp.
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
    std::unique_ptr<LiveRun> run;
    std::vector<Past> undo, redo;
    NextNumbers next;
    std::uint64_t revision = 0;  ///< of the setup
    nlohmann::json first_setup;  ///< the journal begins with it
    NextNumbers first_next;
    std::vector<JournalEntry> entries;
    std::vector<ChangeOnTheWay> changes;  ///< those without which the run would be that of its setup from time 0
    std::string fault_note;               ///< at fault, what the reason does not say

    [[nodiscard]] const Setup& setup() const { return run->setup(); }
    /// Starts, or restarts, with a setup.
    [[nodiscard]] Status start(const Setup& setup);
    /// Changes the run to a setup. Beds and inflows apply immediately only before the first step.
    [[nodiscard]] Status bring_to(const Setup& next);
    [[nodiscard]] Result<Done> edit(const nlohmann::json& action);
    [[nodiscard]] Result<Done> step_back(std::vector<Past>& from, std::vector<Past>& to, const char* word);
    [[nodiscard]] Result<Done> restart();
    /// The scene with the present setup, and the result of the run so far.
    [[nodiscard]] std::pair<scene::Scene, run::RunResult> outcome() const;
    void note_change(const nlohmann::json& action, const std::string& by, const std::string& sentence);
};

}  // namespace talus::twin
