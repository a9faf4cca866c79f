#include "products/view.hpp"

#include <algorithm>
#include <cmath>

#include "products/structure_mesh.hpp"
#include "report/hazard_map.hpp"
#include "report/intensity.hpp"

namespace talus::products {

std::vector<View::Structure> View::structures() const {
    const auto& guideline = report::intensity_guideline(scene.spec.outputs.intensity_guideline);
    const Extent shown = surface.lattice().extent();
    const auto& impacts = result.observation.buildings;
    std::vector<Structure> all;
    for (std::size_t i = 0; i < scene.buildings.size(); ++i) {
        const terrain::Building& building = scene.buildings[i];
        const Extent extent = extent_of(building);
        if (!shown.contains({(extent.x_min + extent.x_max) / 2, (extent.y_min + extent.y_max) / 2})) continue;
        TriangleMesh mesh = structure_mesh(scene.terrain, building);
        if (mesh.corners.empty()) continue;
        all.push_back({i, std::move(mesh),
                       structure_colour(guideline, i < impacts.size() ? impacts[i] : observe::BuildingImpact{})});
    }
    return all;
}

double View::greatest_speed() const {
    return report::greatest(result.observation.maps.peak_speed);
}

std::vector<report::Colour> View::speed_colours(const std::vector<float>& speeds) const {
    const auto& maps = report::hazard_maps();
    const auto map = std::find_if(maps.begin(), maps.end(), [](const report::HazardMap& candidate) {
        return candidate.grid == &HazardMaps::peak_speed;
    });
    // A colour is costly to compute.
    constexpr std::size_t steps = 64;
    std::vector<report::Colour> ramp;
    for (std::size_t k = 0; k < steps; ++k)
        ramp.push_back(report::colour_at(map->ramp, static_cast<double>(k) / (steps - 1)));
    const double greatest = std::max(greatest_speed(), 1e-6);
    std::vector<report::Colour> colours;
    colours.reserve(speeds.size());
    for (const float speed : speeds) {
        const double share = std::clamp(speed / greatest, 0.0, 1.0);
        colours.push_back(ramp[static_cast<std::size_t>(std::lround(share * (steps - 1)))]);
    }
    return colours;
}

}  // namespace talus::products
