// The setup as docs/protocol.md has it.
#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "core/number_or_null.hpp"
#include "terrain/barrier.hpp"
#include "twin/gauges_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/scenario_parts.hpp"
#include "twin/section_values.hpp"
#include "twin/setup_file.hpp"
#include "twin/zone_blocks.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t longest_table = 200;  // rows that are still readable

using ZoneBlocks = std::map<std::shared_ptr<const scene::Zone>, json>;

json blocks_json(const scene::Zone& zone, const GridGeometry& terrain) {
    json blocks = json::array();
    for (const Extent& block : blocks_of(zone, terrain)) {
        blocks.push_back({block.x_min, block.y_min, block.width(), block.height()});
    }
    return blocks;
}

/// `known`: what was found before; `blocks`: what the present zones have.
json zone_json(const ZoneSetup& zone, const GridGeometry& terrain, const ZoneBlocks& known, ZoneBlocks& blocks) {
    json entry = values_json(zone.body->spec);
    entry["id"] = zone.id;
    entry["name"] = zone.body->spec.name;
    entry["polygons"] = polygons_json(zone.body->outline);
    entry["area_m2"] = zone.area;
    entry["from_scene"] = zone.scene_index >= 0;
    if (zone.body->spec.stem_density > 0 && zone.body->cells != nullptr) {
        const auto found = known.find(zone.body);
        entry["blocks"] = blocks[zone.body] = found != known.end() ? found->second : blocks_json(*zone.body, terrain);
    }
    return entry;
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

json bed_json(const BedSetup& bed) {
    json entry = values_json(bed.body->spec);
    entry["id"] = bed.id;
    entry["name"] = bed.body->spec.name;
    entry["polygons"] = json::array();
    for (const scene::BedLayer::Part& part : bed.body->parts) entry["polygons"].push_back(to_json(part.polygon));
    entry["depth_m"] = number_or_null<json>(depth_of(*bed.body));
    entry["area_m2"] = bed.amount.area;
    entry["volume_m3"] = bed.amount.volume;
    entry["from_scene"] = bed.scene_index >= 0;
    return entry;
}

json inflow_json(const InflowSetup& inflow) {
    const terrain::Inflow& body = *inflow.body;
    json entry = values_json(body.spec);
    entry["id"] = inflow.id;
    entry["name"] = body.name;
    entry["line"] = body.over_area() ? json() : to_json(std::vector<PlanPoint>{body.from, body.to});
    entry["polygons"] = polygons_json(body.area);
    entry["hydrograph"] = body.hydrograph.size() <= longest_table ? list_json(body.hydrograph) : json();
    entry["volume_m3"] = body.volume();
    entry["from_scene"] = inflow.scene_index >= 0;
    return entry;
}

/// NaN where it differs from place to place.
double thickness_of(const terrain::Release& release) {
    if (release.patches.empty() || release.thickness_raster) return observe::never;
    const double thickness = release.patches.front().thickness;
    const bool same = std::all_of(release.patches.begin(), release.patches.end(),
                                  [&](const terrain::ReleasePatch& patch) { return patch.thickness == thickness; });
    return same ? thickness : observe::never;
}

json release_json(const ReleaseSetup& release, const LiveRun& run) {
    const terrain::Release& body = *release.body;
    json entry = values_json(body.spec), polygons = json::array();
    for (const terrain::ReleasePatch& patch : body.patches) polygons.push_back(to_json(patch.polygon.outer));
    entry["id"] = release.id;
    entry["name"] = body.name;
    entry["polygons"] = std::move(polygons);
    entry["thickness_m"] = number_or_null<json>(thickness_of(body));
    entry["volume_m3"] = body.volume;
    entry["from_scene"] = release.scene_index >= 0;
    entry["status"] = release.triggered || run.has_begun(release.id) ? "released" : "held";
    entry["start_time_s"] = number_or_null<json>(run.start_time_of(release.id));
    return entry;
}

json barrier_json(const BarrierSetup& barrier) {
    json entry = values_json(barrier.shape());
    entry["id"] = barrier.id;
    entry["name"] = barrier.body->name;
    entry["line"] = to_json(barrier.shape().line);
    entry["height_m"] = barrier.body->height;
    entry["openings"] = list_json(barrier.shape().openings);
    entry["crest_length_m"] = terrain::length_of(barrier.shape().line);
    entry["from_scene"] = barrier.from_scene;
    return entry;
}

json building_json(const BuildingSetup& building) {
    const terrain::Building& body = *building.body;
    json entry = values_json<params::BuildingSpec>(body);
    entry["id"] = building.id;
    entry["name"] = body.name;
    entry["footprint"] = polygons_json(body.footprint);
    entry["base_m"] = number_or_null<json>(body.roof_elevation - body.height);
    entry["roof_m"] = number_or_null<json>(body.roof_elevation);
    entry["from_scene"] = building.scene_index >= 0;
    return entry;
}

json gauge_json(const GaugeSetup& gauge) {
    json entry = gauge_place(*gauge.body);
    entry["id"] = gauge.id;
    entry["from_scene"] = gauge.scene_index >= 0;
    return entry;
}

template <class Entry>
bool in_force(const Entry& entry, const std::vector<Entry>& begun_with) {
    const Entry* begun = find_id(begun_with, entry.id);
    return begun != nullptr && same_shape(begun->body, entry.body);
}

}  // namespace

json Scenario::setup_json() const {
    const Parts& p = *parts_;
    const Setup& setup = p.setup();
    json parameters = json::object(), releases = json::array(), barriers = json::array(), buildings = json::array();
    for (const params::Parameter* parameter : live_parameters()) {
        parameters["material." + parameter->key] =
            number_or_null<json>(value_in_force(setup.material, *parameter, p.run->model().viscosity));
    }
    for (const ReleaseSetup& release : setup.releases) releases.push_back(release_json(release, *p.run));
    for (const BarrierSetup& barrier : setup.barriers) barriers.push_back(barrier_json(barrier));
    for (const BuildingSetup& building : setup.buildings) buildings.push_back(building_json(building));
    json zones = json::array(), beds = json::array(), inflows = json::array();
    const GridGeometry& terrain = p.scene->terrain.elevation().geometry;
    ZoneBlocks blocks;
    for (const ZoneSetup& zone : setup.zones) zones.push_back(zone_json(zone, terrain, p.zone_blocks, blocks));
    p.zone_blocks = std::move(blocks);
    for (const BedSetup& bed : setup.beds) {
        json entry = bed_json(bed);
        entry["in_force"] = in_force(bed, p.run->begun_with().beds);
        beds.push_back(std::move(entry));
    }
    for (const InflowSetup& inflow : setup.inflows) {
        json entry = inflow_json(inflow);
        entry["in_force"] = in_force(inflow, p.run->begun_with().inflows);
        inflows.push_back(std::move(entry));
    }
    json gauges = json::array(), notes = json::array();
    for (const GaugeSetup& gauge : setup.gauges) {
        json entry = gauge_json(gauge);
        entry["in_force"] = in_force(gauge, p.run->begun_with().gauges);
        gauges.push_back(std::move(entry));
    }
    for (const NoteSetup& note : setup.notes) notes.push_back(note_json(note));
    json changes = json::array();
    for (const Parts::ChangeOnTheWay& change : p.changes) {
        changes.push_back({{"time_s", change.time}, {"by", change.by}, {"sentence", change.sentence}});
    }
    return {{"revision", p.revision},
            {"changes", changes},
            {"parameters", parameters},
            {"releases", releases},
            {"barriers", barriers},
            {"buildings", buildings},
            {"zones", zones},
            {"beds", beds},
            {"inflows", inflows},
            {"gauges", gauges},
            {"notes", notes},
            {"observations", tables_json(setup.observations)},
            {"triggers", tables_json(setup.triggers)},
            {"alarms", tables_json(setup.alarms)},
            {"pending_restart", !begin_alike(setup, p.run->begun_with())},
            {"undo", p.undo.empty() ? json() : json(p.undo.back().sentence)},
            {"redo", p.redo.empty() ? json() : json(p.redo.back().sentence)}};
}

}  // namespace talus::twin
