#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ensemble/run_record.hpp"
#include "observe/observation.hpp"
#include "risk/exposures.hpp"

/// What the runs of an ensemble do to what is at risk.
namespace talus::risk {

struct BuildingOutcome {
    bool there = true;  ///< false: an option removed it
    bool hit = false;
    double damage = 0, death = 0;  ///< share of the value lost; probability for a person who is there
};

struct RoadOutcome {
    double hit_length = 0;     ///< m that debris covers
    double deadly_length = 0;  ///< m, the probability of death of a person there, summed over the length
};

struct RunOutcome {
    std::vector<BuildingOutcome> buildings;  ///< as Exposures::buildings
    std::vector<RoadOutcome> roads;          ///< as Exposures::roads
};

/// The runs of one class of events.
struct ScenarioOutcome {
    std::string name;
    double frequency = 1;                         ///< events in a year
    std::vector<std::optional<RunOutcome>> runs;  ///< by number; none: it failed
};

/// `maps`: peak depth, speed and pressure of the run.
[[nodiscard]] RunOutcome outcome_of(const Exposures& exposures, const std::vector<observe::BuildingImpact>& buildings,
                                    const HazardMaps& maps);

/// The intensity at a place; all 0 where debris did not come.
[[nodiscard]] Intensity intensity_at(const HazardMaps& maps, const PlanPoint& place);

}  // namespace talus::risk
