// Barriers and buildings.
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "terrain/barrier.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/outline.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t max_openings = 100;

/// Unchanged where the file or action has none.
Status read_openings(const json& given, double particle_spacing, params::BarrierSpec& barrier) {
    if (!gives(given, "openings")) return {};
    params::SceneSpec read;
    TALUS_TRY(
        read_live_list(given["openings"], "openings", params::live_section("barrier_opening"), read, particle_spacing));
    barrier.openings = std::move(read.barrier_openings);
    return {};
}

}  // namespace

json Barriers::body(const Body& barrier) {
    json body = values_json(*barrier.barrier);
    body.update({{"name", barrier.name},
                 {"line", to_json(barrier.barrier->line)},
                 {"openings", list_json(barrier.barrier->openings)}});
    return body;
}

json Barriers::more(const Entry& barrier, Shown&) {
    return {{"height_m", barrier.body->height}, {"crest_length_m", terrain::length_of(barrier.shape().line)}};
}

Status Barriers::read(const json& file, const scene::Scene& scene, Body& barrier) {
    TALUS_TRY(check_keys(file, live_keys("barrier"), {"name", "line", "openings"}));
    TALUS_ASSIGN(auto line, read_points(file, "line", false, 2, 1'000'000));
    if (!line) return not_of_a_setup("line", file);
    TALUS_ASSIGN(const std::string name, read_name(file));
    params::BarrierSpec shape;
    TALUS_TRY(read_openings(file, 0, shape));
    shape.line = std::move(*line);
    json values = file;  // an older journal gives a level crest a height of 0, too
    if (gives(file, "crest_elevation_m")) values.erase("height_m");
    TALUS_TRY(read_values(values, shape));
    TALUS_TRY(check_rules(shape, scene.spec.solver, 0));
    TALUS_ASSIGN(barrier, make_barrier(scene.terrain, name, shape));
    return {};
}

Status Barriers::put(const Put<Entry>& put, Body& barrier) {
    const json& given = put.given;
    TALUS_TRY(check_keys(given, live_keys("barrier"), {"name", "line", "openings"}));
    TALUS_ASSIGN(auto line, read_points(given, "line", false, 2, max_points));
    if (put.existing == nullptr && !line) return missing("line", name);
    params::BarrierSpec shape = barrier.barrier.value_or(params::BarrierSpec());
    if (line) shape.line = std::move(*line);
    TALUS_TRY(read_values(given, shape));
    if (gives(given, "openings") && (!given["openings"].is_array() || given["openings"].size() > max_openings)) {
        return Error{
            fmt::format("openings = {}: must be a list of at most {}", shown(given["openings"]), max_openings)};
    }
    TALUS_TRY(read_openings(given, put.context.particle_spacing, shape));
    TALUS_TRY(check_rules(shape, put.context.scene.spec.solver, put.context.particle_spacing));
    TALUS_ASSIGN(barrier, make_barrier(put.context.scene.terrain, put.name, shape));
    return {};
}

std::string Barriers::told(const Entry& barrier, const Put<Entry>& put) {
    const params::BarrierSpec& shape = barrier.shape();
    std::string size = fmt::format(" {}: {:.1f} m long, {:.3g} m high, {:.3g} m thick", put.done("placed"),
                                   terrain::length_of(shape.line), barrier.body->height, shape.thickness);
    if (!shape.passing_share) return size;
    return size + fmt::format(", a net: {:.3g} % pass its meshes", 100 * *shape.passing_share);
}

json Buildings::body(const Body& building) {
    json body = values_json<params::BuildingSpec>(building);
    body["name"] = building.name;
    body["polygons"] = polygons_json(building.footprint);
    return body;
}

json Buildings::more(const Entry& building, Shown&) {
    const double roof = building.body->roof_elevation;
    return {{"base_m", number_or_null<json>(roof - building.body->height)}, {"roof_m", number_or_null<json>(roof)}};
}

Status Buildings::read(const json& file, const scene::Scene& scene, Body& building) {
    TALUS_TRY(check_keys(file, live_keys("buildings"), {"name", "polygons"}));
    if (!gives(file, "height_m")) return not_of_a_setup("height_m", file);
    building = {};
    TALUS_ASSIGN(building.name, read_name(file));
    TALUS_TRY(read_values<params::BuildingSpec>(file, building));
    TALUS_ASSIGN(building.footprint, read_polygons(file));
    std::vector<terrain::Building> placed{std::move(building)};
    place_buildings(scene.terrain, placed);
    building = std::move(placed.front());
    return {};
}

Status Buildings::put(const Put<Entry>& put, Body& building) {
    const json& given = put.given;
    const char* outline = given.contains("footprint") ? "footprint" : "polygon";  // the former: in older journals
    TALUS_TRY(check_keys(given, live_keys("buildings"), {"name", outline, "move_m"}));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(given, outline, name, put.existing != nullptr));
    if (put.existing == nullptr && !gives(given, "height_m")) return missing("height_m", name);
    building.name = put.name;
    params::BuildingSpec& values = building;
    TALUS_TRY(read_values(given, values));
    TALUS_TRY(check_rules(values, put.context.scene.spec.solver, put.context.particle_spacing));
    if (gives(given, "height_m")) building.height_assumed = false;
    TALUS_TRY(redraw(drawn, put.context.scene.terrain, false, building.footprint));
    std::vector<terrain::Building> placed{std::move(building)};
    place_buildings(put.context.scene.terrain, placed);
    building = std::move(placed.front());
    if (std::isfinite(building.roof_elevation)) return {};
    return Error{fmt::format("{}: does not stand on known ground", outline)};
}

std::string Buildings::told(const Entry& building, const Put<Entry>& put) {
    return fmt::format(" {}: {:.3g} m high", put.given.contains("move_m") ? "moved" : put.done("placed"),
                       building.body->height);
}

}  // namespace talus::twin
