#include "twin/section_values.hpp"

#include <algorithm>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

json value_json(const ParameterValue& value) {
    if (const double* number = std::get_if<double>(&value)) return *number;
    if (const std::string* text = std::get_if<std::string>(&value)) return *text;
    return nullptr;
}

Result<ParameterValue> read_value(const json& object, const Parameter& parameter) {
    const std::string& key = parameter.live;
    if (parameter.kind == ParameterKind::choice) {
        TALUS_ASSIGN(const auto text, read_text(object, key));
        if (text && problem_with(parameter, *text).empty()) return ParameterValue(*text);
    } else {
        TALUS_ASSIGN(const auto number, read_number(object, key, parameter.range, parameter.unit));
        if (number) return ParameterValue(*number);
        if (!parameter.absent.empty()) return ParameterValue();
    }
    return Error{fmt::format("{} = {}: must be {}", key, shown(object[key]), allowed_text(parameter))};
}

/// What is given takes the place of its alternatives.
Status drop_alternatives(const json& object, const Section& section, SceneSpec& spec) {
    for (const Alternatives& choice : section.alternatives) {
        std::vector<std::string> given;
        for (const std::string& key : choice.keys) {
            const std::string& live = section.find(key)->live;
            if (!live.empty() && object.contains(live) && !object[live].is_null()) given.push_back(key);
        }
        if (given.size() > 1) {
            return Error{fmt::format("{}: only one of {} can be given", given.back(), fmt::join(given, ", "))};
        }
        for (const std::string& key : choice.keys) {
            if (given.size() == 1 && key != given.front()) section.find(key)->set(spec, 0, {});
        }
    }
    return {};
}

}  // namespace

std::vector<std::string> live_keys(const char* section) {
    std::vector<std::string> keys;
    for (const Parameter& parameter : find_section(section)->parameters) {
        if (!parameter.live.empty()) keys.push_back(parameter.live);
    }
    return keys;
}

json live_values(const Section& section, const SceneSpec& spec) {
    json values = json::object();
    for (const Parameter& parameter : section.parameters) {
        if (!parameter.live.empty()) values[parameter.live] = value_json(parameter.get(spec, 0));
    }
    return values;
}

Status read_live_values(const json& object, const Section& section, SceneSpec& spec) {
    TALUS_TRY(drop_alternatives(object, section, spec));
    for (const Parameter& parameter : section.parameters) {
        if (parameter.live.empty() || !object.contains(parameter.live)) continue;
        TALUS_ASSIGN(const ParameterValue value, read_value(object, parameter));
        parameter.set(spec, 0, value);
    }
    return {};
}

Status check_live_rules(const Section& section, const SceneSpec& spec, double particle_spacing) {
    auto broken = wrong_choice(section, spec, 0, true);
    if (!broken) broken = broken_rule(section, spec, 0, particle_spacing);
    if (broken) return Error{broken->key + broken->text};
    return {};
}

}  // namespace talus::twin
