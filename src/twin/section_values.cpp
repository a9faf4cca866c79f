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

json value_json(const params::ParameterValue& value) {
    if (const double* number = std::get_if<double>(&value)) return *number;
    if (const std::string* text = std::get_if<std::string>(&value)) return *text;
    return nullptr;
}

Result<params::ParameterValue> read_value(const json& object, const params::Parameter& parameter) {
    const std::string& key = parameter.live;
    if (parameter.kind == params::ParameterKind::choice) {
        TALUS_ASSIGN(const auto text, read_text(object, key));
        if (text && problem_with(parameter, *text).empty()) return params::ParameterValue(*text);
    } else {
        TALUS_ASSIGN(const auto number, read_number(object, key, parameter.range, parameter.unit));
        if (number) return params::ParameterValue(*number);
        if (!parameter.absent.empty()) return params::ParameterValue();
    }
    return Error{fmt::format("{} = {}: must be {}", key, shown(object[key]), allowed_text(parameter))};
}

/// Whether this is the only live parameter among its alternatives, so that nothing else can replace it.
bool stands_alone(const params::Section& section, const params::Parameter& parameter) {
    const auto live = [&](const std::string& key) { return !section.find(key)->live.empty(); };
    return std::any_of(section.alternatives.begin(), section.alternatives.end(),
                       [&](const params::Alternatives& choice) {
                           return std::count(choice.keys.begin(), choice.keys.end(), parameter.key) > 0 &&
                                  std::count_if(choice.keys.begin(), choice.keys.end(), live) == 1;
                       });
}

/// A given value replaces its alternatives.
Status drop_alternatives(const json& object, const params::Section& section, params::SceneSpec& spec,
                         std::size_t index) {
    for (const params::Alternatives& choice : section.alternatives) {
        std::vector<std::string> given;
        for (const std::string& key : choice.keys) {
            const std::string& live = section.find(key)->live;
            if (!live.empty() && gives(object, live)) given.push_back(key);
        }
        if (given.size() > 1) {
            return Error{fmt::format("{}: only one of {} can be given", given.back(), fmt::join(given, ", "))};
        }
        for (const std::string& key : choice.keys) {
            if (given.size() == 1 && key != given.front()) section.find(key)->set(spec, index, {});
        }
    }
    return {};
}

}  // namespace

bool gives(const json& object, const std::string& key) {
    const auto found = object.find(key);
    return found != object.end() && !found->is_null();
}

std::vector<std::string> live_keys(const char* section) {
    std::vector<std::string> keys;
    for (const params::Parameter& parameter : params::live_section(section).parameters) {
        if (!parameter.live.empty()) keys.push_back(parameter.live);
    }
    return keys;
}

Status check_complete(const json& object, const char* section, const char* what) {
    const params::Section& table = params::live_section(section);
    for (const params::Parameter& parameter : table.parameters) {
        if (parameter.live.empty() || !(parameter.required || stands_alone(table, parameter))) continue;
        if (!gives(object, parameter.live)) {
            return Error{fmt::format("{}: missing; a new {} needs it", parameter.live, what)};
        }
    }
    return {};
}

json live_values(const params::Section& section, const params::SceneSpec& spec, std::size_t index) {
    json values = json::object();
    for (const params::Parameter& parameter : section.parameters) {
        if (!parameter.live.empty()) values[parameter.live] = value_json(parameter.get(spec, index));
    }
    return values;
}

json live_list(const params::Section& section, const params::SceneSpec& spec) {
    json list = json::array();
    for (std::size_t index = 0; index < section.count(spec); ++index) list.push_back(live_values(section, spec, index));
    return list;
}

Status read_live_values(const json& object, const params::Section& section, params::SceneSpec& spec,
                        std::size_t index) {
    TALUS_TRY(drop_alternatives(object, section, spec, index));
    for (const params::Parameter& parameter : section.parameters) {
        if (parameter.live.empty() || !object.contains(parameter.live)) continue;
        if (object[parameter.live].is_null() && stands_alone(section, parameter)) continue;
        TALUS_ASSIGN(const params::ParameterValue value, read_value(object, parameter));
        parameter.set(spec, index, value);
    }
    return {};
}

Status read_live_list(const json& list, const char* key, const params::Section& section, params::SceneSpec& spec,
                      double particle_spacing) {
    if (!list.is_array()) return Error{fmt::format("{} = {}: must be a list", key, shown(list))};
    const std::vector<std::string> keys = live_keys(section.name.c_str());
    for (std::size_t k = 0; k < list.size(); ++k) {
        const json& entry = list[k];
        if (!entry.is_object()) {
            return Error{
                fmt::format("{}[{}] = {}: must be an object with {}", key, k, shown(entry), fmt::join(keys, ", "))};
        }
        section.append(spec);
        const std::size_t index = section.count(spec) - 1;
        Status s = check_keys(entry, keys, {});
        if (s) s = check_complete(entry, section.name.c_str(), "entry");
        if (s) s = read_live_values(entry, section, spec, index);
        if (!s) return Error{fmt::format("{}[{}]: {}", key, k, s.error().message)};
        if (const auto broken = broken_rule(section, spec, index, particle_spacing)) {
            return Error{fmt::format("{}[{}]: {}{}", key, k, broken->key, broken->text)};
        }
    }
    return {};
}

Status check_live_rules(const params::Section& section, const params::SceneSpec& spec, double particle_spacing) {
    auto broken = wrong_choice(section, spec, 0, true);
    if (!broken) broken = broken_rule(section, spec, 0, particle_spacing);
    if (broken) return Error{broken->key + broken->text};
    return {};
}

}  // namespace talus::twin
