#include <utility>

#include <fmt/format.h>

#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<Zone> read_zone(const nlohmann::json& action, const ActionContext& context, const Zone* existing,
                       const std::string& name) {
    if (Status s = check_keys(action, zone_keys(), {"action", "id", "name", "polygon", "move_m"}); !s) {
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
    const ZoneSpec& spec = zone.spec;
    const bool says_something = spec.friction_coefficient || spec.turbulent_friction || spec.cohesion ||
                                spec.stem_density > 0 || spec.raster_holds != ZoneRaster::zone_number;
    if (!says_something) {
        return Error{
            "friction_coefficient: the zone says nothing; give friction_coefficient, turbulent_friction_mps2, "
            "cohesion_Pa or stem_density_pm2, or remove it"};
    }
    if (spec.cohesion && context.scene.spec.solver.internal_friction != InternalFriction::stress) {
        return Error{"cohesion_Pa: needs solver.internal_friction = \"stress\""};
    }
    if (!(area_of(zone, terrain.elevation().geometry) > 0)) {
        return Error{fmt::format("{}: covers the centre of no cell of the terrain, which are {:.6g} m wide",
                                 *by ? "move_m" : "polygon", terrain.cell())};
    }
    return zone;
}

}  // namespace talus::twin
