#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "scene/scene.hpp"
#include "twin/scenario.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// An action and its time.
struct JournalEntry {
    std::uint64_t step = 0;  ///< steps taken before it
    std::string by;
    nlohmann::json action;
    nlohmann::json setup;  ///< restored by undo or redo (write_setup); null for other actions
};

/// Everything that determines a session's result, and the result.
struct Journal {
    std::string scene_file;  ///< absolute, or "built-in:sham_tseng/scene.toml"
    std::vector<std::string> overrides;
    std::vector<scene::InputFile> inputs;
    nlohmann::json first_setup = nlohmann::json::object();  ///< write_setup
    NextNumbers next;
    std::vector<JournalEntry> entries;
    std::uint64_t steps = 0;
    double time = 0;   ///< s
    std::string hash;  ///< of the state after the last step, hexadecimal
    std::string instruction_set;
};

/// Of a scenario so far.
[[nodiscard]] Journal journal_of(const Scenario& scenario);

[[nodiscard]] nlohmann::json write_journal(const Journal& journal);

/// Errors name key and value.
[[nodiscard]] Result<Journal> read_journal(const std::string& text);

/// A sentence for every input of the scene that has changed since the session.
[[nodiscard]] std::vector<std::string> changed_inputs(const Journal& journal, const scene::Scene& scene);

/// The result of a replay of a journal.
struct Replayed {
    std::uint64_t steps = 0;
    double time = 0;                          ///< s
    std::string hash;                         ///< as in the journal
    std::unique_ptr<Scenario> scenario = {};  ///< as it is then
};

/// Runs a journal on its scene. `on_step` gets the number of each step; false stops. `options`: nothing is recorded
/// without them. Errors: the setup does not fit the scene, an action fails, the run ends before the journal does.
[[nodiscard]] Result<Replayed> replay(const Journal& journal, std::shared_ptr<const scene::Scene> scene,
                                      const std::function<bool(std::uint64_t step)>& on_step = {},
                                      std::optional<ScenarioOptions> options = {});

}  // namespace talus::twin
