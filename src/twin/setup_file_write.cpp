#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "params/fields.hpp"
#include "twin/hydrograph_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/section_values.hpp"
#include "twin/setup_file.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr const char* kinematic = "kinematic_viscosity_m2ps";

json material_json(const MaterialSpec& material) {
    SceneSpec spec;
    spec.material = material;
    json values = json::object();
    const auto add = [&](const Parameter& parameter) {
        const ParameterValue value = parameter.get(spec, 0);
        const double* number = std::get_if<double>(&value);
        values[parameter.key] = number != nullptr ? json(*number) : json();
    };
    for (const Parameter* parameter : live_parameters()) add(*parameter);
    add(*find_section("material")->find(kinematic));
    return values;
}

json polygons_json(const std::vector<Polygon>& polygons) {
    json list = json::array();
    for (const Polygon& polygon : polygons) list.push_back(to_json(polygon));
    return list;
}

/// The id, and which of the scene's it is.
template <class Entry>
json origin_json(const Entry& setup) {
    json entry = {{"id", setup.id}};
    if (setup.scene_index >= 0) entry["scene"] = setup.scene_index;
    return entry;
}

json zone_entry(const ZoneSetup& zone) {
    json entry = origin_json(zone);
    if (zone.as_in_scene) return entry;
    entry.update(values_json(zone.body->spec));
    entry["name"] = zone.body->spec.name;
    entry["polygons"] = polygons_json(zone.body->outline);
    return entry;
}

json bed_entry(const BedSetup& bed) {
    json entry = origin_json(bed);
    if (bed.as_in_scene) return entry;
    entry.update(values_json(bed.body->spec));
    entry["name"] = bed.body->spec.name;
    entry["parts"] = json::array();
    for (const BedLayer::Part& part : bed.body->parts) {
        entry["parts"].push_back({{"rings", to_json(part.polygon)}, {"depth_m", part.depth}});
    }
    if (bed.body->depth_raster != nullptr) entry["raster"] = true;
    return entry;
}

json inflow_entry(const InflowSetup& inflow) {
    json entry = origin_json(inflow);
    if (inflow.as_in_scene) return entry;
    const Inflow& body = *inflow.body;
    entry["name"] = body.name;
    if (!body.over_area()) entry["line"] = to_json(std::vector<PlanPoint>{body.from, body.to});
    entry["polygons"] = polygons_json(body.area);
    entry["direction"] = body.direction ? json(*body.direction) : json();
    entry["hydrograph"] = to_json(body.hydrograph);
    return entry;
}

}  // namespace

json openings_json(const BarrierSpec& barrier) {
    json openings = json::array();
    for (const BarrierOpeningSpec& opening : barrier.openings) openings.push_back(values_json(opening));
    return openings;
}

json write_setup(const Setup& setup) {
    json file = {{"material", material_json(setup.material)},
                 {"releases", json::array()},
                 {"barriers", json::array()},
                 {"buildings", json::array()},
                 {"zones", json::array()},
                 {"beds", json::array()},
                 {"inflows", json::array()}};
    for (const ReleaseSetup& release : setup.releases) {
        json entry = {{"id", release.id}};
        if (release.scene_index >= 0) entry["scene"] = release.scene_index;
        if (release.triggered) entry["triggered"] = true;
        if (!release.as_in_scene) {
            entry["name"] = release.body->name;
            entry["patches"] = json::array();
            for (const ReleasePatch& patch : release.body->patches) {
                entry["patches"].push_back({{"rings", to_json(patch.polygon)}, {"thickness_m", patch.thickness}});
            }
            if (release.body->thickness_raster) entry["raster"] = true;
        }
        file["releases"].push_back(std::move(entry));
    }
    for (const BarrierSetup& barrier : setup.barriers) {
        json entry = values_json(barrier.shape());
        entry.update({{"id", barrier.id},
                      {"name", barrier.body->name},
                      {"line", to_json(barrier.shape().line)},
                      {"openings", openings_json(barrier.shape())},
                      {"from_scene", barrier.from_scene}});
        file["barriers"].push_back(std::move(entry));
    }
    for (const BuildingSetup& building : setup.buildings) {
        json entry = {{"id", building.id}};
        if (building.scene_index >= 0) entry["scene"] = building.scene_index;
        if (!building.as_in_scene) {
            entry["name"] = building.body->name;
            entry["height_m"] = building.body->height;
            entry["footprint"] = json::array();
            for (const Polygon& part : building.body->footprint) entry["footprint"].push_back(to_json(part));
        }
        file["buildings"].push_back(std::move(entry));
    }
    for (const ZoneSetup& zone : setup.zones) file["zones"].push_back(zone_entry(zone));
    for (const BedSetup& bed : setup.beds) file["beds"].push_back(bed_entry(bed));
    for (const InflowSetup& inflow : setup.inflows) file["inflows"].push_back(inflow_entry(inflow));
    return file;
}

}  // namespace talus::twin
