#include <cmath>
#include <utility>
#include <vector>

#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"

namespace talus::twin {

Result<Building> read_building(const nlohmann::json& action, const ActionContext& context, const Building* existing,
                               const std::string& name) {
    if (Status s = check_keys(action, {"action", "id", "name", "footprint", "move_m", "height_m"}); !s) {
        return s.error();
    }
    auto footprint = read_points(action, "footprint", true, 3, most_points);
    if (!footprint) return footprint.error();
    const auto height =
        read_number(action, "height_m", find_section("buildings")->find("default_height_m")->range, "m");
    if (!height) return height.error();
    const auto by = read_move(action, "footprint", "building", existing != nullptr);
    if (!by) return by.error();
    if (existing == nullptr && !*footprint) return missing("footprint", "building");
    if (existing == nullptr && !*height) return missing("height_m", "building");
    Building building;
    if (existing != nullptr) building = *existing;
    building.name = name;
    if (*footprint) {
        if (Status s = check_ring(context.scene.terrain, **footprint, "footprint", false); !s) return s.error();
        building.footprint = {{std::move(**footprint), {}}};
    }
    if (*by) {
        for (Polygon& part : building.footprint) {
            part = moved(std::move(part), **by);
            if (Status s = check_ground(context.scene.terrain, part, "move_m", false); !s) return s.error();
        }
    }
    if (*height) {
        building.height = **height;
        building.height_assumed = false;
    }
    std::vector<Building> placed{std::move(building)};
    place_buildings(context.scene.terrain, placed);
    if (!std::isfinite(placed.front().roof_elevation)) return Error{"footprint: does not stand on known ground"};
    return std::move(placed.front());
}

}  // namespace talus::twin
