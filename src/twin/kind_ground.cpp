// Zones and beds.
#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/live_run.hpp"
#include "twin/outline.hpp"
#include "twin/section_values.hpp"
#include "twin/zone_blocks.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

json blocks_json(const scene::Zone& zone, const GridGeometry& terrain) {
    json blocks = json::array();
    for (const Extent& block : blocks_of(zone, terrain)) {
        blocks.push_back({block.x_min, block.y_min, block.width(), block.height()});
    }
    return blocks;
}

/// NaN where it differs from place to place.
double depth_of(const scene::BedLayer& layer) {
    double depth = layer.depth_raster != nullptr ? observe::never : layer.spec.depth.value_or(observe::never);
    if (layer.depth_raster == nullptr && !layer.parts.empty()) depth = layer.parts.front().depth;
    for (const scene::BedLayer::Part& part : layer.parts) {
        if (part.depth != depth) depth = observe::never;
    }
    return depth;
}

}  // namespace

void Zones::measure(Entry& zone, const terrain::Terrain& terrain) {
    zone.area = area_of(*zone.body, terrain.elevation().geometry);
}

json Zones::body(const Body& zone) {
    json body = values_json(zone.spec);
    body["name"] = zone.spec.name;
    body["polygons"] = polygons_json(zone.outline);
    return body;
}

json Zones::more(const Entry& zone, Shown& shown) {
    json more = {{"area_m2", zone.area}};
    if (zone.body->spec.stem_density > 0 && zone.body->cells != nullptr) {
        const auto found = shown.known.find(zone.body);
        more["blocks"] = shown.blocks[zone.body] =
            found != shown.known.end() ? found->second : blocks_json(*zone.body, shown.terrain);
    }
    return more;
}

Status Zones::read(const json& file, const scene::Scene&, Body& zone) {
    TALUS_TRY(check_keys(file, live_keys("zone"), {"name", "polygons"}));
    TALUS_ASSIGN(zone.spec.name, read_name(file));
    TALUS_TRY(read_values(file, zone.spec));
    TALUS_ASSIGN(zone.outline, read_polygons(file));
    return {};
}

Status Zones::put(const Put<Entry>& put, Body& zone) {
    TALUS_TRY(check_keys(put.given, live_keys("zone"), {"name", "polygon", "move_m"}));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(put.given, "polygon", name, put.existing != nullptr));
    zone.spec.name = put.name;
    TALUS_TRY(read_values(put.given, zone.spec));
    if (drawn && zone.cells != nullptr) {
        return Error{
            fmt::format("{}: the zone comes from a raster and stays where that is; draw a new one", drawn.key)};
    }
    const terrain::Terrain& terrain = put.context.scene.terrain;
    TALUS_TRY(redraw(drawn, terrain, false, zone.outline));
    const params::SceneSpec& spec = put.context.scene.spec;
    TALUS_TRY(check_rules(zone.spec, spec.solver, put.context.particle_spacing, spec.material));
    if (area_of(zone, terrain.elevation().geometry) > 0) return {};
    return Error{fmt::format("{}: {}", drawn.key, scene::covers_no_cell(terrain))};
}

std::string Zones::told(const Entry& zone, const Put<Entry>& put) {
    return fmt::format(" {}: {:.0f} m2", put.done("drawn"), zone.area);
}

void Beds::measure(Entry& bed, const terrain::Terrain& terrain) {
    bed.amount = amount_of(*bed.body, terrain);
}

json Beds::body(const Body& layer) {
    json body = values_json(layer.spec);
    body["name"] = layer.spec.name;
    write_parts(layer.parts, "depths_m", &scene::BedLayer::Part::depth, body);
    if (layer.depth_raster != nullptr) body["raster"] = true;
    return body;
}

json Beds::more(const Entry& bed, Shown&) {
    return {{"depth_m", number_or_null<json>(depth_of(*bed.body))},
            {"area_m2", bed.amount.area},
            {"volume_m3", bed.amount.volume}};
}

Status Beds::read(const json& file, const scene::Scene&, Body& layer) {
    TALUS_TRY(check_keys(file, live_keys("bed"), {"name", "polygons", "depths_m", "raster"}));
    TALUS_ASSIGN(layer.spec.name, read_name(file));
    TALUS_TRY(read_values(file, layer.spec));
    if (!file.contains("raster")) layer.depth_raster = nullptr;
    return read_parts(file, "depths_m", &scene::BedLayer::Part::depth, layer.parts);
}

Status Beds::put(const Put<Entry>& put, Body& layer) {
    TALUS_TRY(check_keys(put.given, live_keys("bed"), {"name", "polygon", "move_m"}));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(put.given, "polygon", name, put.existing != nullptr));
    if (put.existing == nullptr) TALUS_TRY(check_complete(put.given, "bed", name));
    layer.spec.name = put.name;
    TALUS_TRY(read_values(put.given, layer.spec));
    TALUS_TRY(check_rules(layer.spec, put.context.scene.spec.solver, put.context.particle_spacing));
    const terrain::Terrain& terrain = put.context.scene.terrain;
    const bool uniform = gives(put.given, "depth_m");
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
    if (amount_of(layer, terrain).volume > 0) return {};
    return Error{fmt::format("{}: {}", drawn.key, scene::covers_no_cell(terrain))};
}

std::string Beds::told(const Entry& bed, const Put<Entry>& put) {
    return fmt::format(" {}: {:.0f} m3{}", put.done("drawn"), bed.amount.volume, put.from_restart());
}

}  // namespace talus::twin
