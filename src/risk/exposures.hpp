#pragma once

#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "risk/vulnerability.hpp"
#include "scene/scene.hpp"

/// What is at risk in a scene.
namespace talus::risk {

/// A building, exposed or not: impact is stated for all of them.
struct ExposedBuilding {
    std::string name;
    std::string exposure;                         ///< name of its [[exposure]]; empty: none
    double value = 0, persons = 0, presence = 0;  ///< in the scene's currency; share of the time
    const Curve *damage = nullptr, *death = nullptr;
    std::vector<Polygon> footprint;
};

/// A road, as places along it that each stand for the same length.
struct ExposedRoad {
    std::string name;
    std::vector<PlanPoint> line, places;
    double step = 0;               ///< m, length of each place
    double persons_per_metre = 0;  ///< on the road at any time, on average
    double busiest_presence = 0;   ///< share of the time for which its busiest driver is on a metre of it, 1/m
    bool has_busiest = false;
    const Curve* death = nullptr;

    [[nodiscard]] double length() const { return step * static_cast<double>(places.size()); }
};

struct Exposures {
    Exposures() = default;
    Exposures(Exposures&&) = default;
    Exposures& operator=(Exposures&&) = default;
    Exposures(const Exposures&) = delete;  // a copy would point to the curves of the other
    Exposures& operator=(const Exposures&) = delete;
    ~Exposures() = default;

    std::vector<Curve> curves;  ///< to which the others point
    std::vector<ExposedBuilding> buildings;
    std::vector<ExposedRoad> roads;
    const Curve* map_death = nullptr;  ///< of the map of individual risk; nullptr: no map
    [[nodiscard]] bool empty() const { return roads.empty() && !any_building(); }
    [[nodiscard]] bool any_building() const;
};

/// Everything that the scene's [[exposure]] state. `scene` is the ground without options, so that all buildings are
/// there. Errors: a curve, building or attribute that does not exist, a building in two exposures or with the name of
/// another, an attribute out of range, a road outside the terrain.
[[nodiscard]] Result<Exposures> find_exposures(const scene::Scene& scene);

}  // namespace talus::risk
