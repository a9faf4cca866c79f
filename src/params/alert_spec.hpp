#pragma once

#include <optional>
#include <string>

/// Triggers and alarms of the live twin, as spec.hpp has the rest of a scene file.
namespace talus::params {

/// `[[trigger]]`: a run of the live twin that starts when a program or a gauge says so. An absent limit: a message
/// cannot set that value.
struct TriggerSpec {
    std::string name;
    std::string release;                              ///< whose values it sets; empty: none
    std::string inflow;                               ///< that a gauge feeds; empty: none
    std::optional<double> volume_limit;               ///< m3, of the release
    std::optional<double> pore_pressure_ratio_limit;  ///< r_u, of the release, or of all debris without one
    std::optional<double> discharge_limit;            ///< m3/s
    double start_discharge = 0;                       ///< m3/s, a gauge above it starts the run
    double hold_time = 60;                            ///< s, that the last value of a gauge holds
};

/// `[[alarm]]`: a rule for which a run is watched; exactly one place and exactly one condition.
struct AlarmSpec {
    std::string name;
    std::string structure;                                    ///< a building or barrier
    std::optional<double> chainage;                           ///< m along the flow path
    std::optional<double> x, y;                               ///< m, in the terrain's reference system
    std::optional<double> distance;                           ///< m along the flow path, from the front
    std::optional<double> lead_time;                          ///< s, until the front is there at its present velocity
    std::optional<double> impact_pressure, dynamic_pressure;  ///< Pa
    std::optional<double> depth;                              ///< m
    std::string message;                                      ///< what is sent with it
};

}  // namespace talus::params
