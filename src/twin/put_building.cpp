#include <cmath>
#include <utility>
#include <vector>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"

namespace talus::twin {

Result<Building> read_building(const nlohmann::json& action, const ActionContext& context, const Building* existing,
                               const std::string& name) {
    TALUS_TRY(check_keys(action, {"action", "id", "name", "footprint", "move_m", "height_m"}));
    TALUS_ASSIGN(auto footprint, read_points(action, "footprint", true, 3, most_points));
    TALUS_ASSIGN(const auto height,
                 read_number(action, "height_m", find_section("buildings")->find("default_height_m")->range, "m"));
    TALUS_ASSIGN(const auto by, read_move(action, "footprint", "building", existing != nullptr));
    if (existing == nullptr && !footprint) return missing("footprint", "building");
    if (existing == nullptr && !height) return missing("height_m", "building");
    Building building;
    if (existing != nullptr) building = *existing;
    building.name = name;
    if (footprint) {
        TALUS_TRY(check_ring(context.scene.terrain, *footprint, "footprint", false));
        building.footprint = {{std::move(*footprint), {}}};
    }
    if (by) {
        for (Polygon& part : building.footprint) {
            part = moved(std::move(part), *by);
            TALUS_TRY(check_ground(context.scene.terrain, part, "move_m", false));
        }
    }
    if (height) {
        building.height = *height;
        building.height_assumed = false;
    }
    std::vector<Building> placed{std::move(building)};
    place_buildings(context.scene.terrain, placed);
    if (!std::isfinite(placed.front().roof_elevation)) return Error{"footprint: does not stand on known ground"};
    return std::move(placed.front());
}

}  // namespace talus::twin
