#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<scene::Zone> read_zone(const nlohmann::json& action, const ActionContext& context, const scene::Zone* existing,
                              const std::string& name) {
    TALUS_TRY(check_keys(action, live_keys("zone"), {"action", "id", "name", "polygon", "move_m"}));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(action, "polygon", "zone", existing != nullptr));
    if (existing == nullptr && !drawn.ring) return missing("polygon", "zone");
    scene::Zone zone;
    if (existing != nullptr) zone = *existing;
    zone.spec.name = name;
    TALUS_TRY(read_values(action, zone.spec));
    if (drawn && zone.cells != nullptr) {
        return Error{
            fmt::format("{}: the zone comes from a raster and stays where that is; draw a new one", drawn.key)};
    }
    const terrain::Terrain& terrain = context.scene.terrain;
    TALUS_TRY(redraw(drawn, terrain, false, zone.outline));
    const params::SceneSpec& spec = context.scene.spec;
    TALUS_TRY(check_rules(zone.spec, spec.solver, context.particle_spacing, spec.material));
    if (!(area_of(zone, terrain.elevation().geometry) > 0)) {
        return Error{fmt::format("{}: {}", drawn.key, scene::covers_no_cell(terrain))};
    }
    return zone;
}

}  // namespace talus::twin
