// The setup as docs/protocol.md has it.
#include <numbers>
#include <utility>

#include "core/number_or_null.hpp"
#include "terrain/barrier.hpp"
#include "twin/hydrograph_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/scenario_parts.hpp"
#include "twin/section_values.hpp"
#include "twin/setup_file.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t longest_table = 200;  // rows that somebody would read

json zone_json(const ZoneSetup& zone) {
    json entry = values_json(zone.body->spec);
    entry["id"] = zone.id;
    entry["name"] = zone.body->spec.name;
    entry["polygons"] = json::array();
    for (const Polygon& part : zone.body->outline) entry["polygons"].push_back(to_json(part));
    entry["area_m2"] = zone.area;
    entry["from_scene"] = zone.scene_index >= 0;
    return entry;
}

/// NaN where it differs from place to place.
double depth_of(const BedLayer& layer) {
    double depth = layer.depth_raster != nullptr ? never : layer.spec.depth.value_or(never);
    if (layer.depth_raster == nullptr && !layer.parts.empty()) depth = layer.parts.front().depth;
    for (const BedLayer::Part& part : layer.parts) {
        if (part.depth != depth) depth = never;
    }
    return depth;
}

json bed_json(const BedSetup& bed) {
    json entry = values_json(bed.body->spec);
    entry["id"] = bed.id;
    entry["name"] = bed.body->spec.name;
    entry["polygons"] = json::array();
    for (const BedLayer::Part& part : bed.body->parts) entry["polygons"].push_back(to_json(part.polygon));
    entry["depth_m"] = number_or_null<json>(depth_of(*bed.body));
    entry["area_m2"] = bed.amount.area;
    entry["volume_m3"] = bed.amount.volume;
    entry["from_scene"] = bed.scene_index >= 0;
    return entry;
}

json inflow_json(const InflowSetup& inflow) {
    const Inflow& body = *inflow.body;
    json polygons = json::array();
    for (const Polygon& part : body.area) polygons.push_back(to_json(part));
    return {{"id", inflow.id},
            {"name", body.name},
            {"line", body.over_area() ? json() : to_json(std::vector<PlanPoint>{body.from, body.to})},
            {"polygons", polygons},
            {"direction_deg", body.direction ? json(*body.direction * 180 / std::numbers::pi) : json()},
            {"hydrograph", body.hydrograph.size() <= longest_table ? to_json(body.hydrograph) : json()},
            {"volume_m3", body.volume()},
            {"from_scene", inflow.scene_index >= 0}};
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
    for (const Parameter* parameter : live_parameters()) {
        parameters["material." + parameter->key] =
            number_or_null<json>(value_in_force(setup.material, *parameter, p.run->model().viscosity));
    }
    for (const ReleaseSetup& release : setup.releases) {
        json polygons = json::array();
        const Release& body = *release.body;
        double thickness = body.patches.empty() || body.thickness_raster ? never : body.patches.front().thickness;
        for (const ReleasePatch& patch : body.patches) {
            polygons.push_back(to_json(patch.polygon.outer));
            if (patch.thickness != thickness) thickness = never;
        }
        const bool released = release.triggered || p.run->has_begun(release.id);
        releases.push_back({{"id", release.id},
                            {"name", body.name},
                            {"polygons", polygons},
                            {"thickness_m", number_or_null<json>(thickness)},
                            {"volume_m3", body.volume},
                            {"from_scene", release.scene_index >= 0},
                            {"status", released ? "released" : "held"},
                            {"start_time_s", number_or_null<json>(p.run->start_time_of(release.id))}});
    }
    for (const BarrierSetup& barrier : setup.barriers) {
        json entry = values_json(barrier.shape());
        entry.update({{"id", barrier.id},
                      {"name", barrier.body->name},
                      {"line", to_json(barrier.shape().line)},
                      {"height_m", barrier.body->height},
                      {"openings", openings_json(barrier.shape())},
                      {"crest_length_m", length_of(barrier.shape().line)},
                      {"from_scene", barrier.from_scene}});
        barriers.push_back(std::move(entry));
    }
    for (const BuildingSetup& building : setup.buildings) {
        const Building& body = *building.body;
        json footprint = json::array();
        for (const Polygon& part : body.footprint) footprint.push_back(to_json(part));
        buildings.push_back({{"id", building.id},
                             {"name", body.name},
                             {"footprint", footprint},
                             {"height_m", body.height},
                             {"base_m", number_or_null<json>(body.roof_elevation - body.height)},
                             {"roof_m", number_or_null<json>(body.roof_elevation)},
                             {"from_scene", building.scene_index >= 0}});
    }
    json zones = json::array(), beds = json::array(), inflows = json::array();
    for (const ZoneSetup& zone : setup.zones) zones.push_back(zone_json(zone));
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
    return {{"revision", p.revision},
            {"parameters", parameters},
            {"releases", releases},
            {"barriers", barriers},
            {"buildings", buildings},
            {"zones", zones},
            {"beds", beds},
            {"inflows", inflows},
            {"pending_restart", !begin_alike(setup, p.run->begun_with())},
            {"undo", p.undo.empty() ? json() : json(p.undo.back().sentence)},
            {"redo", p.redo.empty() ? json() : json(p.redo.back().sentence)}};
}

}  // namespace talus::twin
