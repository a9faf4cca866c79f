#include "risk/outcome.hpp"

#include <cmath>
#include <cstddef>

namespace talus::risk {

Intensity intensity_at(const HazardMaps& maps, const PlanPoint& place) {
    const auto number = [&](const Grid<float>& grid) {
        const float value = value_at(grid, place);
        return std::isnan(value) ? 0.0 : static_cast<double>(value);
    };
    return {number(maps.peak_depth), number(maps.peak_speed), number(maps.peak_pressure)};
}

RunOutcome outcome_of(const Exposures& exposures, const std::vector<observe::BuildingImpact>& buildings,
                      const HazardMaps& maps) {
    RunOutcome outcome;
    std::size_t next = 0;  // the order is that of the scene, of which an option may have removed some
    for (const ExposedBuilding& exposed : exposures.buildings) {
        BuildingOutcome& made = outcome.buildings.emplace_back();
        made.there = next < buildings.size() && !buildings[next].is_barrier && buildings[next].name == exposed.name;
        if (!made.there) continue;
        const observe::BuildingImpact& impact = buildings[next++];
        made.hit = impact.hit;
        if (!impact.hit) continue;
        const double speed = std::isnan(impact.peak_speed) ? 0 : impact.peak_speed;
        const Intensity intensity{impact.peak_depth, speed, impact.peak_impact_pressure};
        if (exposed.damage != nullptr) made.damage = exposed.damage->at(intensity);
        if (exposed.death != nullptr) made.death = exposed.death->at(intensity);
    }
    for (const ExposedRoad& road : exposures.roads) {
        RoadOutcome& made = outcome.roads.emplace_back();
        for (const PlanPoint& place : road.places) {
            const Intensity intensity = intensity_at(maps, place);
            if (!(intensity.depth > 0)) continue;
            made.hit_length += road.step;
            made.deadly_length += road.step * road.death->at(intensity);
        }
    }
    return outcome;
}

}  // namespace talus::risk
