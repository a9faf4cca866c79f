#include "params/fields.hpp"
#include "twin/gauges_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/section_values.hpp"
#include "twin/setup_file.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

/// What is not live, and is in the place of what is.
constexpr const char* in_place_of_live[] = {"kinematic_viscosity_m2ps", "laminar_viscosity_Pas"};

json material_json(const params::MaterialSpec& material) {
    params::SceneSpec spec;
    spec.material = material;
    json values = json::object();
    const auto add = [&](const params::Parameter& parameter) {
        const params::ParameterValue value = parameter.get(spec, 0);
        const double* number = std::get_if<double>(&value);
        values[parameter.key] = number != nullptr ? json(*number) : json();
    };
    for (const params::Parameter* parameter : live_parameters()) add(*parameter);
    for (const char* key : in_place_of_live) add(*params::find_section("material")->find(key));
    return values;
}

/// Outlines, each with its own value.
template <class Part>
json parts_json(const std::vector<Part>& parts, const char* key, double Part::*value) {
    json list = json::array();
    for (const Part& part : parts) list.push_back({{"rings", to_json(part.polygon)}, {key, part.*value}});
    return list;
}

json body_json(const terrain::Release& release) {
    json body = values_json(release.spec);
    body["name"] = release.name;
    body["patches"] = parts_json(release.patches, "thickness_m", &terrain::ReleasePatch::thickness);
    if (release.thickness_raster) body["raster"] = true;
    return body;
}

json body_json(const terrain::Building& building) {
    json body = values_json<params::BuildingSpec>(building);
    body["name"] = building.name;
    body["footprint"] = polygons_json(building.footprint);
    return body;
}

json body_json(const scene::Zone& zone) {
    json body = values_json(zone.spec);
    body["name"] = zone.spec.name;
    body["polygons"] = polygons_json(zone.outline);
    return body;
}

json body_json(const scene::BedLayer& layer) {
    json body = values_json(layer.spec);
    body["name"] = layer.spec.name;
    body["parts"] = parts_json(layer.parts, "depth_m", &scene::BedLayer::Part::depth);
    if (layer.depth_raster != nullptr) body["raster"] = true;
    return body;
}

json body_json(const terrain::Inflow& inflow) {
    json body = values_json(inflow.spec);
    body["name"] = inflow.name;
    if (!inflow.over_area()) body["line"] = to_json(std::vector<PlanPoint>{inflow.from, inflow.to});
    body["polygons"] = polygons_json(inflow.area);
    body["hydrograph"] = list_json(inflow.hydrograph);
    return body;
}

json body_json(const terrain::Gauge& gauge) {
    return gauge_place(gauge);
}

/// The id, its index in the scene, and the body of a changed one.
template <class Entry>
json entry_json(const Entry& setup) {
    json entry = {{"id", setup.id}};
    if (setup.scene_index >= 0) entry["scene"] = setup.scene_index;
    if (!setup.as_in_scene) entry.update(body_json(*setup.body));
    return entry;
}

}  // namespace

json note_json(const NoteSetup& note) {
    return {{"id", note.id}, {"name", note.body->name}, {"x_m", note.body->at.x}, {"y_m", note.body->at.y}};
}

json tables_json(const std::vector<TableSetup>& entries) {
    json list = json::array();
    for (const TableSetup& entry : entries) {
        list.push_back({{"id", entry.id},
                        {"section", entry.body->section},
                        {"name", entry.body->name()},
                        {"values", table_values_json(*entry.body)},
                        {"from_scene", entry.from_scene}});
    }
    return list;
}

json write_setup(const Setup& setup) {
    json file = {{"material", material_json(setup.material)},
                 {"releases", json::array()},
                 {"barriers", json::array()},
                 {"buildings", json::array()},
                 {"zones", json::array()},
                 {"beds", json::array()},
                 {"inflows", json::array()},
                 {"gauges", json::array()},
                 {"notes", json::array()},
                 {"observations", tables_json(setup.observations)},
                 {"triggers", tables_json(setup.triggers)},
                 {"alarms", tables_json(setup.alarms)}};
    for (const ReleaseSetup& release : setup.releases) {
        json entry = entry_json(release);
        if (release.triggered) entry["triggered"] = true;
        file["releases"].push_back(std::move(entry));
    }
    for (const BarrierSetup& barrier : setup.barriers) {
        json entry = values_json(barrier.shape());
        entry.update({{"id", barrier.id},
                      {"name", barrier.body->name},
                      {"line", to_json(barrier.shape().line)},
                      {"openings", list_json(barrier.shape().openings)},
                      {"from_scene", barrier.from_scene}});
        file["barriers"].push_back(std::move(entry));
    }
    for (const BuildingSetup& building : setup.buildings) file["buildings"].push_back(entry_json(building));
    for (const ZoneSetup& zone : setup.zones) file["zones"].push_back(entry_json(zone));
    for (const BedSetup& bed : setup.beds) file["beds"].push_back(entry_json(bed));
    for (const InflowSetup& inflow : setup.inflows) file["inflows"].push_back(entry_json(inflow));
    for (const GaugeSetup& gauge : setup.gauges) file["gauges"].push_back(entry_json(gauge));
    for (const NoteSetup& note : setup.notes) file["notes"].push_back(note_json(note));
    return file;
}

}  // namespace talus::twin
