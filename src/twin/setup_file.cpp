#include "twin/setup_file.hpp"

#include <array>
#include <memory>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/fields.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/outline.hpp"

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

Status read_material(const json& file, const scene::Scene& scene, params::MaterialSpec& material) {
    if (!file.is_object()) return Error{fmt::format("material = {}: must be an object", shown(file))};
    params::SceneSpec spec;
    spec.material = scene.spec.material;
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

/// An entry as it is written now: older journals have other words for outlines.
Result<json> in_present_words(json file) {
    if (file.contains("polygons")) return file;
    if (file.contains("footprint")) {
        file["polygons"] = std::move(file["footprint"]);
        file.erase("footprint");
    }
    for (const auto& [parts, number, numbers] :
         {std::tuple("patches", "thickness_m", "thicknesses_m"), std::tuple("parts", "depth_m", "depths_m")}) {
        if (!file.contains(parts)) continue;
        file["polygons"] = file[numbers] = json::array();
        if (!file[parts].is_array()) return not_of_a_setup(parts, file);
        for (const json& part : file[parts]) {
            if (!part.is_object() || !part.contains("rings") || !part.contains(number)) {
                return not_of_a_setup(parts, file);
            }
            TALUS_TRY(check_keys(part, {"rings", number}));
            file["polygons"].push_back(part["rings"]);
            file[numbers].push_back(part[number]);
        }
        file.erase(parts);
    }
    return file;
}

/// -1 where absent.
Result<int> read_index(const json& object, std::size_t count) {
    if (!object.contains("scene")) return -1;
    const json& index = object["scene"];
    if (!index.is_number_unsigned() || index.get<std::size_t>() >= count) {
        return Error{fmt::format("scene = {}: must be from 0 to {}, as the scene has {}", shown(index),
                                 count > 0 ? count - 1 : 0, count)};
    }
    return index.get<int>();
}

template <class Kind>
Result<typename Kind::Entry> read_entry(json file, const scene::Scene& scene) {
    typename Kind::Entry entry;
    const auto taken = [&](const char* key) {
        json value = file.value(key, json());
        file.erase(key);
        return value;
    };
    if (!file.is_object() || !file.value("id", json()).is_string() ||
        file["id"].template get_ref<const std::string&>().empty()) {
        return not_of_a_setup("id", file);
    }
    entry.id = taken("id");
    auto body = Kind::fresh();
    if constexpr (Kind::origin == Origin::index) {
        const auto& in_scene = Kind::in_scene(scene);
        TALUS_ASSIGN(entry.scene_index, read_index(file, in_scene.size()));
        file.erase("scene");
        if (entry.scene_index >= 0) body = in_scene[static_cast<std::size_t>(entry.scene_index)];
    } else if constexpr (Kind::origin == Origin::flag) {
        entry.scene_index = taken("from_scene") == true ? 0 : -1;  // which one is not known
    }
    if constexpr (requires { entry.triggered; }) entry.triggered = taken("triggered") == true;
    entry.as_in_scene = Kind::origin == Origin::index && entry.scene_index >= 0 && file.empty();
    if (!entry.as_in_scene) {
        TALUS_ASSIGN(const json present, in_present_words(std::move(file)));
        TALUS_TRY(Kind::read(present, scene, body));
    }
    entry.body = std::make_shared<const typename Kind::Body>(std::move(body));
    Kind::measure(entry, scene.terrain);
    return entry;
}

template <class Kind>
json written(const typename Kind::Entry& entry) {
    json file = json::object();
    if (Kind::origin != Origin::index || !entry.as_in_scene) file = Kind::body(*entry.body);
    file["id"] = entry.id;
    if (Kind::origin == Origin::index && entry.scene_index >= 0) file["scene"] = entry.scene_index;
    if (Kind::origin == Origin::flag) file["from_scene"] = entry.scene_index >= 0;
    if constexpr (requires { entry.triggered; }) {
        if (entry.triggered) file["triggered"] = true;
    }
    return file;
}

std::vector<std::string> known_keys() {
    std::vector<std::string> keys = {"material"};
    for_each_kind([&]<class Kind>(Kind) { keys.emplace_back(Kind::list); });
    return keys;
}

}  // namespace

json write_setup(const Setup& setup) {
    json file = {{"material", material_json(setup.material)}};
    for_each_kind([&]<class Kind>(Kind) {
        json& list = file[Kind::list] = json::array();
        for (const auto& entry : setup.*Kind::entries) list.push_back(written<Kind>(entry));
    });
    return file;
}

Result<Setup> read_setup(const json& file, const scene::Scene& scene) {
    if (!file.is_object()) return Error{fmt::format("setup = {}: must be an object", shown(file))};
    if (!file.contains("material")) return Error{"setup.material: missing"};
    TALUS_TRY(try_each_kind([&]<class Kind>(Kind) -> Status {
        if (!file.contains(Kind::list)) {
            return Kind::in_every_file ? Status(Error{fmt::format("setup.{}: missing", Kind::list)}) : Status();
        }
        if (file[Kind::list].is_array()) return {};
        return Error{fmt::format("setup.{} = {}: must be a list", Kind::list, shown(file[Kind::list]))};
    }));
    if (const Status known = check_keys(file, known_keys(), {}); !known) {
        return Error{"setup: " + known.error().message};
    }
    NextNumbers any;
    Setup setup = setup_of(scene, any);
    TALUS_TRY(read_material(file["material"], scene, setup.material));
    TALUS_TRY(try_each_kind([&]<class Kind>(Kind) -> Status {
        if (!file.contains(Kind::list)) return {};  // as in the scene
        auto& entries = setup.*Kind::entries;
        entries.clear();
        for (const json& each : file[Kind::list]) {
            auto entry = read_entry<Kind>(each, scene);
            if (!entry) {
                return Error{fmt::format("setup.{}[{}]: {}", Kind::list, entries.size(), entry.error().message)};
            }
            entries.push_back(std::move(*entry));
        }
        return {};
    }));
    return setup;
}

}  // namespace talus::twin
