#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<BedLayer> read_bed(const nlohmann::json& action, const ActionContext& context, const BedLayer* existing,
                          const std::string& name) {
    TALUS_TRY(check_keys(action, live_keys("bed"), {"action", "id", "name", "polygon", "move_m"}));
    TALUS_ASSIGN(auto polygon, read_points(action, "polygon", true, 3, most_points));
    TALUS_ASSIGN(const auto by, read_move(action, "polygon", "bed", existing != nullptr));
    const bool depth_given = action.contains("depth_m") && !action["depth_m"].is_null();
    if (existing == nullptr && !polygon) return missing("polygon", "bed");
    if (existing == nullptr && !depth_given) return missing("depth_m", "bed");
    BedLayer layer;
    if (existing != nullptr) layer = *existing;
    layer.spec.name = name;
    const std::optional<double> depth_before = layer.spec.depth;
    TALUS_TRY(read_values(action, layer.spec));
    if (!depth_given) layer.spec.depth = depth_before;  // a null asks for nothing: a bed has a depth
    TALUS_TRY(check_rules(layer.spec, context.scene.spec.solver, context.particle_spacing));
    const Terrain& terrain = context.scene.terrain;
    if ((polygon || by) && !depth_given && (layer.depth_raster != nullptr || !layer.spec.depth)) {
        return Error{"depth_m: missing; the bed's depth differs from place to place, a new outline needs one value"};
    }
    if (polygon) {
        TALUS_TRY(check_ring(terrain, *polygon, "polygon", false));
        layer.parts = {{{std::move(*polygon), {}}, *layer.spec.depth}};
    }
    if (by) {
        if (layer.parts.empty()) return Error{"move_m: the bed has no outline that could be moved; give a polygon"};
        for (BedLayer::Part& part : layer.parts) {
            part.polygon = moved(std::move(part.polygon), *by);
            TALUS_TRY(check_ground(terrain, part.polygon, "move_m", false));
        }
    }
    if (depth_given) {
        if (layer.depth_raster != nullptr && layer.parts.empty()) {
            return Error{"depth_m: the bed lies where its raster has depths; one depth needs a polygon, too"};
        }
        layer.depth_raster = nullptr;
        for (BedLayer::Part& part : layer.parts) part.depth = *layer.spec.depth;
    }
    if (!(amount_of(layer, terrain).volume > 0)) {
        return Error{fmt::format("{}: covers the centre of no cell of the terrain, which are {:.6g} m wide",
                                 by ? "move_m" : "polygon", terrain.cell())};
    }
    return layer;
}

}  // namespace talus::twin
