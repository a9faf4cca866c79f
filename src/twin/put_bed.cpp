#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<scene::BedLayer> read_bed(const nlohmann::json& action, const ActionContext& context,
                                 const scene::BedLayer* existing, const std::string& name) {
    TALUS_TRY(check_keys(action, live_keys("bed"), {"action", "id", "name", "polygon", "move_m"}));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(action, "polygon", "bed", existing != nullptr));
    if (existing == nullptr && !drawn.ring) return missing("polygon", "bed");
    if (existing == nullptr) TALUS_TRY(check_complete(action, "bed", "bed"));
    scene::BedLayer layer;
    if (existing != nullptr) layer = *existing;
    layer.spec.name = name;
    TALUS_TRY(read_values(action, layer.spec));
    TALUS_TRY(check_rules(layer.spec, context.scene.spec.solver, context.particle_spacing));
    const terrain::Terrain& terrain = context.scene.terrain;
    const bool uniform = gives(action, "depth_m");
    if (drawn && !uniform && (layer.depth_raster != nullptr || !layer.spec.depth)) {
        return Error{"depth_m: missing; the bed's depth differs from place to place, a new outline needs one value"};
    }
    if (drawn.by && layer.parts.empty()) {
        return Error{"move_m: the bed has no outline that could be moved; give a polygon"};
    }
    TALUS_TRY(redraw(drawn, terrain, false, layer.parts));
    if (drawn.ring) layer.parts.front().depth = *layer.spec.depth;
    if (uniform) {
        if (layer.depth_raster != nullptr && layer.parts.empty()) {
            return Error{"depth_m: the bed lies where its raster has depths; one depth needs a polygon, too"};
        }
        layer.depth_raster = nullptr;
        for (scene::BedLayer::Part& part : layer.parts) part.depth = *layer.spec.depth;
    }
    if (!(amount_of(layer, terrain).volume > 0)) {
        return Error{fmt::format("{}: {}", drawn.key, scene::covers_no_cell(terrain))};
    }
    return layer;
}

}  // namespace talus::twin
