#include <utility>

#include <fmt/format.h>

#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<Zone> read_zone(const nlohmann::json& action, const ActionContext& context, const Zone* existing,
                       const std::string& name) {
    if (Status s = check_keys(action, live_keys("zone"), {"action", "id", "name", "polygon", "move_m"}); !s) {
        return s.error();
    }
    auto polygon = read_points(action, "polygon", true, 3, most_points);
    if (!polygon) return polygon.error();
    const auto by = read_move(action, "polygon", "zone", existing != nullptr);
    if (!by) return by.error();
    if (existing == nullptr && !*polygon) return missing("polygon", "zone");
    Zone zone;
    if (existing != nullptr) zone = *existing;
    zone.spec.name = name;
    if (Status s = read_values(action, zone.spec); !s) return s.error();
    const Terrain& terrain = context.scene.terrain;
    if ((*polygon || *by) && zone.cells != nullptr) {
        return Error{fmt::format("{}: the zone comes from a raster and stays where that is; draw a new one",
                                 *by ? "move_m" : "polygon")};
    }
    if (*polygon) {
        if (Status s = check_ring(terrain, **polygon, "polygon", false); !s) return s.error();
        zone.outline = {{std::move(**polygon), {}}};
    }
    if (*by) {
        for (Polygon& part : zone.outline) {
            part = moved(std::move(part), **by);
            if (Status s = check_ground(terrain, part, "move_m", false); !s) return s.error();
        }
    }
    if (Status s = check_rules(zone.spec, context.scene.spec.solver, context.particle_spacing); !s) return s.error();
    if (!(area_of(zone, terrain.elevation().geometry) > 0)) {
        return Error{fmt::format("{}: covers the centre of no cell of the terrain, which are {:.6g} m wide",
                                 *by ? "move_m" : "polygon", terrain.cell())};
    }
    return zone;
}

}  // namespace talus::twin
