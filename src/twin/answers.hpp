#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "messages/messages.hpp"
#include "params/fields.hpp"
#include "twin/scenario.hpp"

/// What a scenario answers at once, as docs/protocol.md has it, without `scenario`: it does not know its name.
namespace talus::twin {

/// For what is measured, some of it in single precision; values that somebody gave stay as they are.
[[nodiscard]] nlohmann::json with_short_numbers(nlohmann::json measured);

/// A key of the scene file, without its values. `key`: with its section.
[[nodiscard]] messages::Parameter described(const params::Parameter& parameter, std::string key);
[[nodiscard]] nlohmann::json scene_json(const Scenario& scenario);
/// `with_hash`: it takes milliseconds with many particles. The status is that of the run: ready, at_rest, ended or
/// fault.
[[nodiscard]] messages::RunState state_of(const Scenario& scenario, bool with_hash = true);
[[nodiscard]] nlohmann::json state_json(const Scenario& scenario);
/// Of the run as it is now; that of state_json() may be of a moment ago.
[[nodiscard]] nlohmann::json verdict_json(const Scenario& scenario);
/// As in a setup file, with what the page cannot find out by itself.
[[nodiscard]] nlohmann::json setup_json(const Scenario& scenario);
[[nodiscard]] nlohmann::json series_json(const Scenario& scenario);
/// Without a time, s: now; otherwise at the recorded frame at or before it.
[[nodiscard]] nlohmann::json impacts_json(const Scenario& scenario, std::optional<double> time = {});
/// As impacts_json(): between two rows of the time series a gauge reads the former.
[[nodiscard]] nlohmann::json gauges_json(const Scenario& scenario, std::optional<double> time = {});
[[nodiscard]] nlohmann::json journal_json(const Scenario& scenario);
[[nodiscard]] nlohmann::json recording_json(const Scenario& scenario);

}  // namespace talus::twin
