#include "twin/setup_file.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "terrain/barrier.hpp"
#include "twin/json_keys.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr const char* kinematic = "kinematic_viscosity_m2ps";

json polygon_json(const Polygon& polygon) {
    json rings = json::array({to_json(polygon.outer)});
    for (const Ring& hole : polygon.holes) rings.push_back(to_json(hole));
    return rings;
}

json material_json(const MaterialSpec& material) {
    SceneSpec spec;
    spec.material = material;
    json values = json::object();
    const auto add = [&](const Parameter& parameter) {
        const ParameterValue value = parameter.get(spec, 0);
        const double* number = std::get_if<double>(&value);
        values[parameter.key] = number != nullptr ? json(*number) : json();
    };
    for (const Parameter* lever : levers()) add(*lever);
    add(*find_section("material")->find(kinematic));
    return values;
}

/// Reads what write_setup wrote; whatever does not fit ends in an Error.
class SetupReader {
  public:
    explicit SetupReader(const Scene& scene) : scene_(scene) {}

    Status read_material(const json& file, MaterialSpec& material) const;
    Result<ReleaseSetup> read_release(const json& file) const;
    Result<BarrierSetup> read_barrier(const json& file) const;
    Result<BuildingSetup> read_building(const json& file) const;

  private:
    static Error bad(const char* key, const json& object) {
        const auto found = object.is_object() ? object.find(key) : object.end();
        return Error{fmt::format("{} = {}: not what a setup has there", key,
                                 object.is_object() && found != object.end() ? shown(*found) : shown(object))};
    }
    static Result<Polygon> read_polygon(const json& rings);
    static Result<std::vector<BarrierOpening>> read_openings(const json& file);
    static Result<int> read_index(const json& object, std::size_t count);

    const Scene& scene_;
};

Result<Polygon> SetupReader::read_polygon(const json& rings) {
    if (!rings.is_array() || rings.empty()) return Error{fmt::format("rings = {}: must be rings", shown(rings))};
    Polygon polygon;
    for (std::size_t k = 0; k < rings.size(); ++k) {
        auto ring = read_points({{"ring", rings[k]}}, "ring", true, 3, 1'000'000);
        if (!ring) return ring.error();
        if (!*ring) return Error{"ring = null: must be points"};
        if (k == 0) {
            polygon.outer = std::move(**ring);
        } else {
            polygon.holes.push_back(std::move(**ring));
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

Status SetupReader::read_material(const json& file, MaterialSpec& material) const {
    if (!file.is_object()) return Error{fmt::format("material = {}: must be an object", shown(file))};
    SceneSpec spec;
    spec.material = scene_.spec.material;
    for (const auto& [key, value] : file.items()) {
        const Parameter* parameter = find_section("material")->find(key);
        if (parameter == nullptr || parameter->kind != ParameterKind::number) {
            return Error{fmt::format("material.{}: no such key", key)};
        }
        auto number = read_number(file, key, parameter->range, parameter->unit);
        if (!number) return number.error();
        if (!*number && parameter->absent.empty()) return Error{fmt::format("material.{}: must be a number", key)};
        parameter->set(spec, 0, *number ? ParameterValue(**number) : ParameterValue());
    }
    material = spec.material;
    return {};
}

Result<ReleaseSetup> SetupReader::read_release(const json& file) const {
    if (!file.is_object() || !file.contains("id") || !file["id"].is_string()) return bad("id", file);
    const Result<int> index = read_index(file, scene_.releases.size());
    if (!index) return index.error();
    ReleaseSetup setup;
    setup.id = file["id"];
    setup.scene_index = *index;
    setup.as_in_scene = !file.contains("patches");
    setup.triggered = file.contains("triggered") && file["triggered"] == true;
    Release release;
    release.start_time = std::numeric_limits<double>::infinity();
    if (*index >= 0) release = scene_.releases[static_cast<std::size_t>(*index)];
    if (!setup.as_in_scene) {
        const auto name = read_text(file, "name", 1000);
        if (!name) return name.error();
        release.name = name->value_or("");
        if (!file.contains("raster")) release.thickness_raster.reset();
        release.patches.clear();
        if (!file["patches"].is_array()) return bad("patches", file);
        for (const json& patch : file["patches"]) {
            const auto thickness = read_number(patch.is_object() ? patch : json::object(), "thickness_m", {}, "m");
            if (!thickness || !*thickness || !patch.contains("rings")) return bad("patches", file);
            auto polygon = read_polygon(patch["rings"]);
            if (!polygon) return polygon.error();
            release.patches.push_back({std::move(*polygon), **thickness});
        }
        release.volume = release_volume(scene_.terrain, release);
    } else if (*index < 0) {
        return bad("patches", file);
    }
    setup.body = std::make_shared<const Release>(std::move(release));
    return setup;
}

/// None where the key is absent: journals older than openings.
Result<std::vector<BarrierOpening>> SetupReader::read_openings(const json& file) {
    std::vector<BarrierOpening> openings;
    if (!file.contains("openings")) return openings;
    if (!file["openings"].is_array()) return bad("openings", file);
    for (const json& entry : file["openings"]) {
        const json& object = entry.is_object() ? entry : json::object();
        const auto position = read_number(object, "position_m", {}, "m"),
                   width = read_number(object, "width_m", {}, "m"),
                   sill = read_number(object, "sill_height_m", {}, "m");
        if (!position || !*position || !width || !*width || !sill || !*sill) return bad("openings", file);
        openings.push_back({**position, **width, **sill});
    }
    return openings;
}

Result<BarrierSetup> SetupReader::read_barrier(const json& file) const {
    if (!file.is_object() || !file.contains("id") || !file["id"].is_string()) return bad("id", file);
    auto line = read_points(file, "line", false, 2, 1'000'000);
    const auto name = read_text(file, "name", 1000);
    const auto height = read_number(file, "height_m", {}, "m"), thickness = read_number(file, "thickness_m", {}, "m");
    const auto crest = read_number(file, "crest_elevation_m", {}, "m");
    const auto force = read_number(file, "resistance_Npm", {}, "N/m"),
               pressure = read_number(file, "resistance_Pa", {}, "Pa");
    if (!line) return line.error();
    if (!*line) return bad("line", file);
    if (!name || !*name) return bad("name", file);
    if (!height || !*height) return bad("height_m", file);
    if (!thickness || !*thickness) return bad("thickness_m", file);
    if (!crest) return bad("crest_elevation_m", file);
    if (!force) return bad("resistance_Npm", file);
    if (!pressure) return bad("resistance_Pa", file);
    auto openings = read_openings(file);
    if (!openings) return openings.error();
    auto body =
        make_barrier(scene_.terrain, **name, {std::move(**line), **height, *crest, **thickness, std::move(*openings)});
    if (!body) return body.error();
    if (*force) body->resistance.force_per_metre = **force;
    if (*pressure) body->resistance.pressure = **pressure;
    return BarrierSetup{file["id"], std::make_shared<const Building>(std::move(*body)),
                        file.value("from_scene", false)};
}

Result<BuildingSetup> SetupReader::read_building(const json& file) const {
    if (!file.is_object() || !file.contains("id") || !file["id"].is_string()) return bad("id", file);
    const Result<int> index = read_index(file, scene_.buildings.size());
    if (!index) return index.error();
    BuildingSetup setup;
    setup.id = file["id"];
    setup.scene_index = *index;
    setup.as_in_scene = !file.contains("footprint");
    if (setup.as_in_scene) {
        if (*index < 0) return bad("footprint", file);
        setup.body = std::make_shared<const Building>(scene_.buildings[static_cast<std::size_t>(*index)]);
        return setup;
    }
    const auto name = read_text(file, "name", 1000);
    const auto height = read_number(file, "height_m", {}, "m");
    if (!name || !*name) return bad("name", file);
    if (!height || !*height) return bad("height_m", file);
    if (!file["footprint"].is_array()) return bad("footprint", file);
    Building building;
    building.name = **name;
    building.height = **height;
    for (const json& rings : file["footprint"]) {
        auto polygon = read_polygon(rings);
        if (!polygon) return polygon.error();
        building.footprint.push_back(std::move(*polygon));
    }
    std::vector<Building> placed{std::move(building)};
    place_buildings(scene_.terrain, placed);
    setup.body = std::make_shared<const Building>(std::move(placed.front()));
    return setup;
}

}  // namespace

json optional_json(const std::optional<double>& value) {
    return value ? json(*value) : json();
}

json openings_json(const BarrierShape& shape) {
    json openings = json::array();
    for (const BarrierOpening& opening : shape.openings) {
        openings.push_back(
            {{"position_m", opening.position}, {"width_m", opening.width}, {"sill_height_m", opening.sill}});
    }
    return openings;
}

json write_setup(const Setup& setup) {
    json file = {{"material", material_json(setup.material)},
                 {"releases", json::array()},
                 {"barriers", json::array()},
                 {"buildings", json::array()}};
    for (const ReleaseSetup& release : setup.releases) {
        json entry = {{"id", release.id}};
        if (release.scene_index >= 0) entry["scene"] = release.scene_index;
        if (release.triggered) entry["triggered"] = true;
        if (!release.as_in_scene) {
            entry["name"] = release.body->name;
            entry["patches"] = json::array();
            for (const ReleasePatch& patch : release.body->patches) {
                entry["patches"].push_back({{"rings", polygon_json(patch.polygon)}, {"thickness_m", patch.thickness}});
            }
            if (release.body->thickness_raster) entry["raster"] = true;
        }
        file["releases"].push_back(std::move(entry));
    }
    for (const BarrierSetup& barrier : setup.barriers) {
        file["barriers"].push_back({{"id", barrier.id},
                                    {"name", barrier.body->name},
                                    {"line", to_json(barrier.shape().line)},
                                    {"height_m", barrier.shape().height},
                                    {"crest_elevation_m", optional_json(barrier.shape().crest_elevation)},
                                    {"thickness_m", barrier.shape().thickness},
                                    {"openings", openings_json(barrier.shape())},
                                    {"resistance_Npm", number_or_null(barrier.body->resistance.force_per_metre)},
                                    {"resistance_Pa", number_or_null(barrier.body->resistance.pressure)},
                                    {"from_scene", barrier.from_scene}});
    }
    for (const BuildingSetup& building : setup.buildings) {
        json entry = {{"id", building.id}};
        if (building.scene_index >= 0) entry["scene"] = building.scene_index;
        if (!building.as_in_scene) {
            entry["name"] = building.body->name;
            entry["height_m"] = building.body->height;
            entry["footprint"] = json::array();
            for (const Polygon& part : building.body->footprint) entry["footprint"].push_back(polygon_json(part));
        }
        file["buildings"].push_back(std::move(entry));
    }
    return file;
}

Result<Setup> read_setup(const json& file, const Scene& scene) {
    if (!file.is_object()) return Error{fmt::format("setup = {}: must be an object", shown(file))};
    for (const char* key : {"material", "releases", "barriers", "buildings"}) {
        if (!file.contains(key)) return Error{fmt::format("setup.{}: missing", key)};
        if (std::string_view(key) != "material" && !file[key].is_array()) {
            return Error{fmt::format("setup.{} = {}: must be a list", key, shown(file[key]))};
        }
    }
    const SetupReader reader(scene);
    Setup setup;
    if (Status s = reader.read_material(file["material"], setup.material); !s) return s.error();
    const auto read_all = [](const json& entries, auto& into, const char* key, const auto& read) -> Status {
        for (std::size_t k = 0; k < entries.size(); ++k) {
            auto entry = read(entries[k]);
            if (!entry) return Error{fmt::format("setup.{}[{}]: {}", key, k, entry.error().message)};
            into.push_back(std::move(*entry));
        }
        return {};
    };
    Status s =
        read_all(file["releases"], setup.releases, "releases", [&](const json& e) { return reader.read_release(e); });
    if (s)
        s = read_all(file["barriers"], setup.barriers, "barriers",
                     [&](const json& e) { return reader.read_barrier(e); });
    if (s)
        s = read_all(file["buildings"], setup.buildings, "buildings",
                     [&](const json& e) { return reader.read_building(e); });
    if (!s) return s.error();
    return setup;
}

}  // namespace talus::twin
