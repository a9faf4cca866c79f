#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"

/// The part of a scene file that turns hazard into decisions: options, and what is at risk.
namespace talus::params {

/// `[[option]]`: measures that are built, or not, together. What an option names is in force only with an option that
/// names it; see SceneInfo::option.
struct OptionSpec {
    std::string name;
    std::vector<std::string> barriers, zones;    ///< names of their sections
    std::vector<std::string> removed_buildings;  ///< names
    double cost = 0;                             ///< in the currency of [risk]
    double life = 0;                             ///< years
    double interest_rate = 0;                    ///< per year, 0 to 1
    double upkeep = 0;                           ///< in that currency, per year
    std::string notes, source;
};

/// `[risk]`
enum class CriteriaChoice { hong_kong, none };

struct RiskSpec {
    std::string currency;         ///< in which values and costs are given
    std::string curves;           ///< file with vulnerability curves besides those of the program
    std::string map_death_curve;  ///< of the map of individual risk; empty: no map
    CriteriaChoice criteria = CriteriaChoice::hong_kong;
};

/// `[[risk_scenario]]`: a class of events, of which an ensemble's runs are samples.
struct RiskScenarioSpec {
    std::string name;
    std::optional<double> annual_frequency;  ///< per year, of events of this class
    std::optional<double> return_period;     ///< years between them
    std::vector<std::string> set;            ///< "section.key=value"
    std::string source;

    /// Per year.
    [[nodiscard]] double frequency() const { return annual_frequency ? *annual_frequency : 1 / return_period.value(); }
};

enum class ExposureKind { buildings, road };

/// `[[exposure]]`: what debris may meet.
struct ExposureSpec {
    std::string name;
    ExposureKind kind = ExposureKind::buildings;
    std::string death_curve, damage_curve;  ///< names of vulnerability curves
    std::string source;

    std::vector<std::string> buildings;              ///< names; none: all of the scene
    std::optional<double> value, persons, presence;  ///< of each; presence: share of the time, 0 to 1
    std::string value_attribute, persons_attribute, presence_attribute;

    std::vector<PlanPoint> line;  ///< of a road, in the terrain's reference system
    std::string file, layer;
    std::optional<double> vehicles_per_day, speed /* m/s */, persons_per_vehicle;
    std::optional<double> trips_per_day;  ///< of the person who drives it most; absent: no individual risk
};

}  // namespace talus::params
