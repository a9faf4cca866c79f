#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "twin/action.hpp"
#include "twin/setup.hpp"

/// The actions of triggers and gauges (docs/triggers.md).
namespace talus::twin {

class Scenario;

/// Time in which a hydrograph goes from one value of a gauge to the next, s.
inline constexpr double gauge_rise_time = 1;

/// `{"action": "trigger", "trigger": name, "source", "received_at", "values": {...}}`: the setup with which a run
/// starts. Errors: it has begun; no such trigger; a value that the trigger does not allow, with its range; no debris.
[[nodiscard]] Result<Edit> read_trigger(const nlohmann::json& action, const Setup& setup, const ActionContext& context);

/// The action of the trigger that started the run of a scenario; nullptr: people did.
[[nodiscard]] const nlohmann::json* started_by(const Scenario& scenario);

/// A value of a gauge as an inflow of the run.
struct GaugeReading {
    std::string inflow_id;
    std::shared_ptr<const terrain::Inflow> body;
    std::string sentence;
};

/// `{"action": "gauge", "trigger", "time_s", "discharge_m3ps", "received_at"}`. `now`: of the run, s; `last`: time of
/// the value before, s. A value of the past holds from now on. Errors: as above; not later than the one before; no
/// inflow of that run; more particles than there may be.
[[nodiscard]] Result<GaugeReading> read_gauge(const nlohmann::json& action, const Setup& setup, const Setup& begun_with,
                                              const ActionContext& context, double now, double last);

/// The hydrograph with a discharge, m3/s, from a time, s, on: the same before that; it holds for `hold` s, then the
/// inflow ends. `rated`: whose row of the largest discharge gives the velocity, in proportion to discharge^0.4
/// (Manning, wide channel), and the density.
[[nodiscard]] std::vector<params::InflowSample> with_reading(const std::vector<params::InflowSample>& hydrograph,
                                                             const std::vector<params::InflowSample>& rated,
                                                             double time, double discharge, double hold);

}  // namespace talus::twin
