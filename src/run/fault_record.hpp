#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::run {

/// What is known about a step that cannot be trusted, so that its cause can be looked for.
struct FaultRecord {
    std::string sentence;  ///< for people: the first bad particle, where it was, its neighbours
    nlohmann::json content = nlohmann::json::object();  ///< the same as data
    std::string state_table;                            ///< the good state, a particle per line, with all digits
};

/// `good`: a state of a few steps earlier, after which nothing was changed; `bad`: after the step.
[[nodiscard]] FaultRecord record_fault(const sim::Model& model, const sim::Ground& ground, const sim::State& good,
                                       const sim::State& bad, const std::string& reason);

}  // namespace talus::run
