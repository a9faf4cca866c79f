#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<Zone> read_zone(const nlohmann::json& action, const ActionContext& context, const Zone* existing,
                       const std::string& name) {
    TALUS_TRY(check_keys(action, live_keys("zone"), {"action", "id", "name", "polygon", "move_m"}));
    TALUS_ASSIGN(auto polygon, read_points(action, "polygon", true, 3, most_points));
    TALUS_ASSIGN(const auto by, read_move(action, "polygon", "zone", existing != nullptr));
    if (existing == nullptr && !polygon) return missing("polygon", "zone");
    Zone zone;
    if (existing != nullptr) zone = *existing;
    zone.spec.name = name;
    TALUS_TRY(read_values(action, zone.spec));
    const Terrain& terrain = context.scene.terrain;
    if ((polygon || by) && zone.cells != nullptr) {
        return Error{fmt::format("{}: the zone comes from a raster and stays where that is; draw a new one",
                                 by ? "move_m" : "polygon")};
    }
    if (polygon) {
        TALUS_TRY(check_ring(terrain, *polygon, "polygon", false));
        zone.outline = {{std::move(*polygon), {}}};
    }
    if (by) {
        for (Polygon& part : zone.outline) {
            part = moved(std::move(part), *by);
            TALUS_TRY(check_ground(terrain, part, "move_m", false));
        }
    }
    TALUS_TRY(check_rules(zone.spec, context.scene.spec.solver, context.particle_spacing));
    if (!(area_of(zone, terrain.elevation().geometry) > 0)) {
        return Error{fmt::format("{}: covers the centre of no cell of the terrain, which are {:.6g} m wide",
                                 by ? "move_m" : "polygon", terrain.cell())};
    }
    return zone;
}

}  // namespace talus::twin
