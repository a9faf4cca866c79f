#include "twin/section_values.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "twin/json_keys.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::array zone_key_names{"friction_coefficient", "turbulent_friction_mps2", "cohesion_Pa",
                                    "stem_density_pm2",     "stem_diameter_m",         "stem_drag_coefficient"};
constexpr std::array bed_key_names{
    "depth_m", "law", "growth_rate_per_m", "critical_shear_stress_Pa", "erosion_rate_mps", "erosion_depth_mpPa"};

json to_json(const ParameterValue& value) {
    if (const double* number = std::get_if<double>(&value)) return *number;
    if (const std::string* text = std::get_if<std::string>(&value)) return *text;
    return nullptr;
}

json section_json(const Section& section, std::span<const char* const> keys, const SceneSpec& spec) {
    json values = json::object();
    for (const char* key : keys) values[key] = to_json(section.find(key)->get(spec, 0));
    return values;
}

Status read_choice(const json& object, const Parameter& parameter, SceneSpec& spec) {
    const auto text = read_text(object, parameter.key);
    if (!text) return text.error();
    const auto& choices = parameter.choices;
    if (!*text || std::find(choices.begin(), choices.end(), **text) == choices.end()) {
        return Error{
            fmt::format("{} = {}: must be {}", parameter.key, shown(object[parameter.key]), allowed_text(parameter))};
    }
    parameter.set(spec, 0, **text);
    return {};
}

Status read_section(const json& object, const Section& section, std::span<const char* const> keys, SceneSpec& spec) {
    for (const char* key : keys) {
        if (!object.contains(key)) continue;
        const Parameter& parameter = *section.find(key);
        if (parameter.kind == ParameterKind::choice) {
            if (Status s = read_choice(object, parameter, spec); !s) return s;
            continue;
        }
        const auto number = read_number(object, key, parameter.range, parameter.unit);
        if (!number) return number.error();
        if (!*number && parameter.absent.empty()) {
            return Error{fmt::format("{} = null: must be {}", key, allowed_text(parameter))};
        }
        parameter.set(spec, 0, *number ? ParameterValue(**number) : ParameterValue());
    }
    return {};
}

}  // namespace

std::span<const char* const> zone_keys() {
    return zone_key_names;
}
std::span<const char* const> bed_keys() {
    return bed_key_names;
}

json values_json(const ZoneSpec& spec) {
    SceneSpec scene;
    scene.zones = {spec};
    return section_json(*find_section("zone"), zone_key_names, scene);
}

json values_json(const BedSpec& spec) {
    SceneSpec scene;
    scene.beds = {spec};
    return section_json(*find_section("bed"), bed_key_names, scene);
}

Status read_values(const json& object, ZoneSpec& spec) {
    SceneSpec scene;
    scene.zones = {spec};
    if (Status s = read_section(object, *find_section("zone"), zone_key_names, scene); !s) return s;
    spec = scene.zones.front();
    return {};
}

Status read_values(const json& object, BedSpec& spec) {
    SceneSpec scene;
    scene.beds = {spec};
    if (Status s = read_section(object, *find_section("bed"), bed_key_names, scene); !s) return s;
    spec = scene.beds.front();
    return {};
}

}  // namespace talus::twin
