#include <cmath>
#include <utility>
#include <vector>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<terrain::Building> read_building(const nlohmann::json& action, const ActionContext& context,
                                        const terrain::Building* existing, const std::string& name) {
    TALUS_TRY(check_keys(action, live_keys("buildings"), {"action", "id", "name", "footprint", "move_m"}));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(action, "footprint", "building", existing != nullptr));
    if (existing == nullptr && !drawn.ring) return missing("footprint", "building");
    if (existing == nullptr && !gives(action, "height_m")) return missing("height_m", "building");
    terrain::Building building;
    if (existing != nullptr) building = *existing;
    building.name = name;
    params::BuildingSpec& values = building;
    TALUS_TRY(read_values(action, values));
    TALUS_TRY(check_rules(values, context.scene.spec.solver, context.particle_spacing));
    if (gives(action, "height_m")) building.height_assumed = false;
    TALUS_TRY(redraw(drawn, context.scene.terrain, false, building.footprint));
    std::vector<terrain::Building> placed{std::move(building)};
    place_buildings(context.scene.terrain, placed);
    if (!std::isfinite(placed.front().roof_elevation)) return Error{"footprint: does not stand on known ground"};
    return std::move(placed.front());
}

}  // namespace talus::twin
