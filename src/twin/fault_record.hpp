#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

/// What is known about a step that cannot be trusted, so that its cause can be looked for.
namespace talus::twin {

/// `good`: a state of a few steps earlier, after which nothing was changed; `bad`: after the step.
struct FaultRecord {
    std::string sentence;  ///< for people: the first bad particle, where it was, its neighbours, the last action
    nlohmann::json content = nlohmann::json::object();  ///< the same as data
    std::string state_table;                            ///< the good state, a particle per line, with all digits
};

[[nodiscard]] FaultRecord record_fault(const sim::Model& model, const sim::Ground& ground, const sim::State& good,
                                       const sim::State& bad, const std::string& reason);

/// Writes fault.json, last_good_state.csv and journal.json into a new folder FOLDER/fault_N and returns its path.
[[nodiscard]] Result<std::filesystem::path> keep_fault(const FaultRecord& record, const nlohmann::json& journal,
                                                       const std::filesystem::path& folder);

}  // namespace talus::twin
