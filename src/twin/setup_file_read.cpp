#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "core/try.hpp"
#include "terrain/barrier.hpp"
#include "twin/hydrograph_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/section_values.hpp"
#include "twin/setup_file.hpp"

namespace talus::twin {
namespace {

using namespace std::string_view_literals;
using nlohmann::json;

/// Older journals have directions in radians. Returns degrees that convert back to exactly the same value, so that a
/// replay is exact.
double degrees_of(double radians) {
    const double middle = radians * 180 / std::numbers::pi;
    double low = middle, high = middle;
    for (int k = 0; k < 8; ++k) {
        for (const double degrees : {low, high}) {
            if (degrees * std::numbers::pi / 180 == radians) return degrees;
        }
        low = std::nextafter(low, -360.0);
        high = std::nextafter(high, 720.0);
    }
    return middle;
}

/// Reads the output of write_setup; any mismatch is an Error.
class SetupReader {
  public:
    explicit SetupReader(const scene::Scene& scene) : scene_(scene) {}

    Status read_material(const json& file, params::MaterialSpec& material) const;
    Result<ReleaseSetup> read_release(const json& file) const;
    Result<BarrierSetup> read_barrier(const json& file) const;
    Result<BuildingSetup> read_building(const json& file) const;
    Result<ZoneSetup> read_zone(const json& file) const;
    Result<BedSetup> read_bed(const json& file) const;
    Result<InflowSetup> read_inflow(const json& file) const;
    Result<GaugeSetup> read_gauge(const json& file) const;
    Result<NoteSetup> read_note(const json& file) const;
    static Result<TableSetup> read_table(const json& file, TableKind kind);

  private:
    static Error bad(const char* key, const json& object) {
        const auto found = object.is_object() ? object.find(key) : object.end();
        return Error{fmt::format("{} = {}: not what a setup has there", key,
                                 object.is_object() && found != object.end() ? shown(*found) : shown(object))};
    }
    static Result<Polygon> read_polygon(const json& rings);
    static Result<std::vector<Polygon>> read_polygons(const json& file, const char* key);
    /// Outlines, each with its own number.
    template <class Part>
    static Status read_parts(const json& file, const char* key, const char* number, double Part::*value,
                             std::vector<Part>& parts);
    static Result<std::string> read_name(const json& file);
    /// Refuses what is no object, or has no id; an empty one is none.
    static Status check_id(const json& file);
    static bool is_from_scene(const json& file) { return file.value("from_scene", json(false)) == true; }
    static Status check_keys_and_id(const json& file, std::initializer_list<std::string_view> keys);
    /// Refuses keys other than the id and those of such an entry.
    template <class Spec>
    static Status check_entry(const json& file, std::initializer_list<std::string_view> keys);
    /// The id, and its index among `count` entries of the scene; `key`: present only in a changed one.
    template <class Entry>
    static Status read_origin(const json& file, const char* key, std::size_t count, Entry& setup);
    static Result<PlanPoint> read_place(const json& file);
    static Result<int> read_index(const json& object, std::size_t count);

    const scene::Scene& scene_;
};

Result<Polygon> SetupReader::read_polygon(const json& rings) {
    if (!rings.is_array() || rings.empty()) return Error{fmt::format("rings = {}: must be rings", shown(rings))};
    Polygon polygon;
    for (std::size_t k = 0; k < rings.size(); ++k) {
        TALUS_ASSIGN(auto ring, read_points({{"ring", rings[k]}}, "ring", true, 3, 1'000'000));
        if (!ring) return Error{"ring = null: must be points"};
        if (k == 0) {
            polygon.outer = std::move(*ring);
        } else {
            polygon.holes.push_back(std::move(*ring));
        }
    }
    return polygon;
}

/// -1 where absent.
Result<int> SetupReader::read_index(const json& object, std::size_t count) {
    if (!object.contains("scene")) return -1;
    const json& index = object["scene"];
    if (!index.is_number_unsigned() || index.get<std::size_t>() >= count) {
        return Error{fmt::format("scene = {}: must be from 0 to {}, as the scene has {}", shown(index),
                                 count > 0 ? count - 1 : 0, count)};
    }
    return index.get<int>();
}

Status SetupReader::read_material(const json& file, params::MaterialSpec& material) const {
    if (!file.is_object()) return Error{fmt::format("material = {}: must be an object", shown(file))};
    params::SceneSpec spec;
    spec.material = scene_.spec.material;
    std::vector<std::string> numbers;
    for (const params::Parameter& parameter : params::find_section("material")->parameters) {
        if (parameter.kind == params::ParameterKind::number) numbers.push_back(parameter.key);
    }
    for (const auto& [key, value] : file.items()) {
        const params::Parameter* parameter = params::find_section("material")->find(key);
        if (parameter == nullptr || parameter->kind != params::ParameterKind::number) {
            return Error{fmt::format("material.{}: no such key; nearest known key: {}", key,
                                     params::nearest_word(key, numbers))};
        }
        TALUS_ASSIGN(auto number, read_number(file, key, parameter->range, parameter->unit));
        if (!number && parameter->absent.empty()) return Error{fmt::format("material.{}: must be a number", key)};
        parameter->set(spec, 0, number ? params::ParameterValue(*number) : params::ParameterValue());
    }
    material = spec.material;
    return {};
}

Result<std::string> SetupReader::read_name(const json& file) {
    const auto name = read_text(file, "name", 1000);
    if (!name || !*name) return bad("name", file);
    return **name;
}

Result<std::vector<Polygon>> SetupReader::read_polygons(const json& file, const char* key) {
    std::vector<Polygon> polygons;
    if (!file.contains(key) || !file[key].is_array()) return bad(key, file);
    for (const json& rings : file[key]) {
        TALUS_ASSIGN(auto polygon, read_polygon(rings));
        polygons.push_back(std::move(polygon));
    }
    return polygons;
}

template <class Part>
Status SetupReader::read_parts(const json& file, const char* key, const char* number, double Part::*value,
                               std::vector<Part>& parts) {
    parts.clear();
    if (!file[key].is_array()) return bad(key, file);
    for (const json& entry : file[key]) {
        if (entry.is_object()) TALUS_TRY(check_keys(entry, {"rings", number}));
        const auto given = read_number(entry.is_object() ? entry : json::object(), number, {}, "m");
        if (!given || !*given || !entry.contains("rings")) return bad(key, file);
        Part& part = parts.emplace_back();
        TALUS_ASSIGN(part.polygon, read_polygon(entry["rings"]));
        part.*value = **given;
    }
    return {};
}

Status SetupReader::check_id(const json& file) {
    const bool given = file.is_object() && file.contains("id") && file["id"].is_string();
    return given && !file["id"].get_ref<const std::string&>().empty() ? Status() : Status(bad("id", file));
}

Status SetupReader::check_keys_and_id(const json& file, std::initializer_list<std::string_view> keys) {
    TALUS_TRY(check_id(file));
    return check_keys(file, keys);
}

template <class Spec>
Status SetupReader::check_entry(const json& file, std::initializer_list<std::string_view> keys) {
    TALUS_TRY(check_id(file));
    return check_keys(file, live_keys(params::section_of<Spec>.first), keys);
}

template <class Entry>
Status SetupReader::read_origin(const json& file, const char* key, std::size_t count, Entry& setup) {
    TALUS_ASSIGN(const int index, read_index(file, count));
    setup.id = file["id"];
    setup.scene_index = index;
    setup.as_in_scene = !file.contains(key);
    return setup.as_in_scene && index < 0 ? Status(bad(key, file)) : Status();
}

Result<ReleaseSetup> SetupReader::read_release(const json& file) const {
    ReleaseSetup setup;
    TALUS_TRY(check_entry<params::ReleaseSpec>(file, {"id", "scene", "triggered", "name", "patches", "raster"}));
    TALUS_TRY(read_origin(file, "patches", scene_.releases.size(), setup));
    setup.triggered = file.contains("triggered") && file["triggered"] == true;
    terrain::Release release;
    release.spec.start_time = std::numeric_limits<double>::infinity();
    if (setup.scene_index >= 0) release = scene_.releases[static_cast<std::size_t>(setup.scene_index)];
    if (!setup.as_in_scene) {
        TALUS_ASSIGN(release.name, read_name(file));
        TALUS_TRY(read_values(file, release.spec));
        if (!file.contains("raster")) release.thickness_raster.reset();
        TALUS_TRY(read_parts(file, "patches", "thickness_m", &terrain::ReleasePatch::thickness, release.patches));
        release.volume = release_volume(scene_.terrain, release);
    }
    setup.body = std::make_shared<const terrain::Release>(std::move(release));
    return setup;
}

Result<BarrierSetup> SetupReader::read_barrier(const json& file) const {
    TALUS_TRY(check_entry<params::BarrierSpec>(file, {"id", "name", "line", "openings", "from_scene"}));
    TALUS_ASSIGN(auto line, read_points(file, "line", false, 2, 1'000'000));
    if (!line) return bad("line", file);
    TALUS_ASSIGN(const std::string name, read_name(file));
    params::SceneSpec read;
    if (file.contains("openings")) {  // not in journals older than openings
        TALUS_TRY(read_live_list(file["openings"], "openings", params::live_section("barrier_opening"), read, 0));
    }
    params::BarrierSpec barrier;
    barrier.line = std::move(*line);
    barrier.openings = std::move(read.barrier_openings);
    json values = file;  // an older journal gives a level crest a height of 0, too
    if (gives(file, "crest_elevation_m")) values.erase("height_m");
    TALUS_TRY(read_values(values, barrier));
    TALUS_TRY(check_rules(barrier, scene_.spec.solver, 0));
    TALUS_ASSIGN(auto body, make_barrier(scene_.terrain, name, barrier));
    return BarrierSetup{file["id"], std::make_shared<const terrain::Building>(std::move(body)), is_from_scene(file)};
}

Result<BuildingSetup> SetupReader::read_building(const json& file) const {
    BuildingSetup setup;
    TALUS_TRY(check_entry<params::BuildingSpec>(file, {"id", "scene", "name", "footprint"}));
    TALUS_TRY(read_origin(file, "footprint", scene_.buildings.size(), setup));
    if (setup.as_in_scene) {
        setup.body =
            std::make_shared<const terrain::Building>(scene_.buildings[static_cast<std::size_t>(setup.scene_index)]);
        return setup;
    }
    if (!gives(file, "height_m")) return bad("height_m", file);
    terrain::Building building;
    params::BuildingSpec& values = building;
    TALUS_ASSIGN(building.name, read_name(file));
    TALUS_TRY(read_values(file, values));
    TALUS_ASSIGN(building.footprint, read_polygons(file, "footprint"));
    std::vector<terrain::Building> placed{std::move(building)};
    place_buildings(scene_.terrain, placed);
    setup.body = std::make_shared<const terrain::Building>(std::move(placed.front()));
    return setup;
}

Result<ZoneSetup> SetupReader::read_zone(const json& file) const {
    ZoneSetup setup;
    TALUS_TRY(check_entry<params::ZoneSpec>(file, {"id", "scene", "name", "polygons"}));
    TALUS_TRY(read_origin(file, "polygons", scene_.zones.size(), setup));
    scene::Zone zone;
    if (setup.scene_index >= 0) zone = scene_.zones[static_cast<std::size_t>(setup.scene_index)];
    if (!setup.as_in_scene) {
        TALUS_ASSIGN(zone.spec.name, read_name(file));
        TALUS_TRY(read_values(file, zone.spec));
        TALUS_ASSIGN(zone.outline, read_polygons(file, "polygons"));
    }
    setup.area = area_of(zone, scene_.terrain.elevation().geometry);
    setup.body = std::make_shared<const scene::Zone>(std::move(zone));
    return setup;
}

Result<BedSetup> SetupReader::read_bed(const json& file) const {
    BedSetup setup;
    TALUS_TRY(check_entry<params::BedSpec>(file, {"id", "scene", "name", "parts", "raster"}));
    TALUS_TRY(read_origin(file, "parts", scene_.bed_layers.size(), setup));
    scene::BedLayer layer;
    if (setup.scene_index >= 0) layer = scene_.bed_layers[static_cast<std::size_t>(setup.scene_index)];
    if (!setup.as_in_scene) {
        TALUS_ASSIGN(layer.spec.name, read_name(file));
        TALUS_TRY(read_values(file, layer.spec));
        if (!file.contains("raster")) layer.depth_raster = nullptr;
        TALUS_TRY(read_parts(file, "parts", "depth_m", &scene::BedLayer::Part::depth, layer.parts));
    }
    setup.amount = amount_of(layer, scene_.terrain);
    setup.body = std::make_shared<const scene::BedLayer>(std::move(layer));
    return setup;
}

Result<InflowSetup> SetupReader::read_inflow(const json& file) const {
    InflowSetup setup;
    // "direction": of older journals, in radians.
    TALUS_TRY(
        check_entry<params::InflowSpec>(file, {"id", "scene", "name", "line", "polygons", "hydrograph", "direction"}));
    TALUS_TRY(read_origin(file, "polygons", scene_.inflows.size(), setup));
    if (setup.as_in_scene) {
        setup.body =
            std::make_shared<const terrain::Inflow>(scene_.inflows[static_cast<std::size_t>(setup.scene_index)]);
        return setup;
    }
    terrain::Inflow inflow;
    const auto line = read_points(file, "line", false, 2, 2);
    TALUS_ASSIGN(const auto radians, read_number(file, "direction", {}, "rad"));
    TALUS_ASSIGN(inflow.name, read_name(file));
    TALUS_ASSIGN(inflow.area, read_polygons(file, "polygons"));
    if (!line || (line->has_value() != inflow.area.empty())) return bad("line", file);
    if (*line) {
        inflow.from = (**line)[0];
        inflow.to = (**line)[1];
        inflow.spec.line = **line;
    } else {
        inflow.spec.polygon = inflow.area.front().outer;
    }
    TALUS_TRY(read_values(file, inflow.spec));
    if (radians) inflow.spec.direction = degrees_of(*radians);
    TALUS_ASSIGN(inflow.hydrograph, read_hydrograph_rows(file.value("hydrograph", json()), inflow.spec));
    setup.body = std::make_shared<const terrain::Inflow>(std::move(inflow));
    return setup;
}

Result<PlanPoint> SetupReader::read_place(const json& file) {
    const auto x = read_number(file, "x_m", {}, "m"), y = read_number(file, "y_m", {}, "m");
    if (!x || !*x) return bad("x_m", file);
    if (!y || !*y) return bad("y_m", file);
    return PlanPoint{**x, **y};
}

Result<GaugeSetup> SetupReader::read_gauge(const json& file) const {
    GaugeSetup setup;
    TALUS_TRY(check_keys_and_id(file, {"id", "scene", "name", "x_m", "y_m", "chainage_m"}));
    TALUS_TRY(read_origin(file, "name", scene_.gauges.size(), setup));
    terrain::Gauge gauge;
    if (setup.scene_index >= 0) gauge = scene_.gauges[static_cast<std::size_t>(setup.scene_index)];
    if (!setup.as_in_scene) {
        TALUS_ASSIGN(gauge.name, read_name(file));
        TALUS_ASSIGN(gauge.at, read_place(file));
        TALUS_ASSIGN(const auto chainage, read_number(file, "chainage_m", {}, "m"));
        gauge.chainage = chainage.value_or(std::numeric_limits<double>::quiet_NaN());
    }
    setup.body = std::make_shared<const terrain::Gauge>(std::move(gauge));
    return setup;
}

Result<NoteSetup> SetupReader::read_note(const json& file) const {
    TALUS_TRY(check_keys_and_id(file, {"id", "name", "x_m", "y_m"}));
    Note note;
    TALUS_ASSIGN(note.name, read_name(file));
    TALUS_ASSIGN(note.at, read_place(file));
    return NoteSetup{file["id"], std::make_shared<const Note>(std::move(note))};
}

Result<TableSetup> SetupReader::read_table(const json& file, TableKind kind) {
    TALUS_TRY(check_keys_and_id(file, {"id", "section", "name", "values", "from_scene"}));
    TALUS_ASSIGN(TableEntry entry, read_table_entry(file, kind));
    TALUS_TRY(check_table_shape(entry));
    auto body = std::make_shared<const TableEntry>(std::move(entry));
    return TableSetup{file["id"], std::move(body), is_from_scene(file)};
}

}  // namespace

Result<Setup> read_setup(const json& file, const scene::Scene& scene) {
    if (!file.is_object()) return Error{fmt::format("setup = {}: must be an object", shown(file))};
    const auto sections = {"material"sv, "releases"sv, "barriers"sv, "buildings"sv,    "zones"sv,    "beds"sv,
                           "inflows"sv,  "gauges"sv,   "notes"sv,    "observations"sv, "triggers"sv, "alarms"sv};
    const auto later = {"gauges"sv, "notes"sv, "observations"sv, "triggers"sv, "alarms"sv};  // not in older journals
    for (const std::string_view key : sections) {
        if (!file.contains(key)) {
            if (std::find(later.begin(), later.end(), key) != later.end()) continue;
            return Error{fmt::format("setup.{}: missing", key)};
        }
        if (key != "material" && !file[key].is_array()) {
            return Error{fmt::format("setup.{} = {}: must be a list", key, shown(file[key]))};
        }
    }
    if (const Status known = check_keys(file, sections); !known) return Error{"setup: " + known.error().message};
    const SetupReader reader(scene);
    Setup setup;
    TALUS_TRY(reader.read_material(file["material"], setup.material));
    const auto read_all = [](const json& entries, auto& into, const char* key, const auto& read) -> Status {
        for (std::size_t k = 0; k < entries.size(); ++k) {
            auto entry = read(entries[k]);
            if (!entry) return Error{fmt::format("setup.{}[{}]: {}", key, k, entry.error().message)};
            into.push_back(std::move(*entry));
        }
        return {};
    };
    TALUS_TRY(
        read_all(file["releases"], setup.releases, "releases", [&](const json& e) { return reader.read_release(e); }));
    TALUS_TRY(
        read_all(file["barriers"], setup.barriers, "barriers", [&](const json& e) { return reader.read_barrier(e); }));
    TALUS_TRY(read_all(file["buildings"], setup.buildings, "buildings",
                       [&](const json& e) { return reader.read_building(e); }));
    TALUS_TRY(read_all(file["zones"], setup.zones, "zones", [&](const json& e) { return reader.read_zone(e); }));
    TALUS_TRY(read_all(file["beds"], setup.beds, "beds", [&](const json& e) { return reader.read_bed(e); }));
    TALUS_TRY(
        read_all(file["inflows"], setup.inflows, "inflows", [&](const json& e) { return reader.read_inflow(e); }));
    NextNumbers any;
    const Setup of_scene = setup_of(scene, any);
    for (const auto& [key, kind] : {std::pair("observations", TableKind::observation),
                                    std::pair("triggers", TableKind::trigger), std::pair("alarms", TableKind::alarm)}) {
        setup.tables(kind) = of_scene.tables(kind);
        if (!file.contains(key)) continue;
        setup.tables(kind).clear();
        TALUS_TRY(read_all(file[key], setup.tables(kind), key,
                           [kind = kind](const json& e) { return SetupReader::read_table(e, kind); }));
    }
    if (!file.contains("gauges")) {
        setup.gauges = of_scene.gauges;
    } else {
        TALUS_TRY(
            read_all(file["gauges"], setup.gauges, "gauges", [&](const json& e) { return reader.read_gauge(e); }));
    }
    TALUS_TRY(read_all(file.value("notes", json::array()), setup.notes, "notes",
                       [&](const json& e) { return reader.read_note(e); }));
    return setup;
}

}  // namespace talus::twin
