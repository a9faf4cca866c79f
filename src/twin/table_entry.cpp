#include "twin/table_entry.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "scene/load.hpp"
#include "twin/json_keys.hpp"
#include "twin/setup.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t longest_entry_text = 200;  // bytes

const char* kind_name(TableKind kind) {
    switch (kind) {
        case TableKind::observation:
            return "observation";
        case TableKind::trigger:
            return "trigger";
        case TableKind::alarm:
            return "alarm";
    }
    return "";
}

void clear_entries(params::SceneSpec& spec, TableKind kind) {
    switch (kind) {
        case TableKind::observation:
            spec.observations.clear();
            spec.superelevations.clear();
            spec.arrivals.clear();
            spec.run_ups.clear();
            spec.deposit_depths.clear();
            spec.damages.clear();
            spec.observed_run_outs.clear();
            return;
        case TableKind::trigger:
            spec.triggers.clear();
            return;
        case TableKind::alarm:
            spec.alarms.clear();
            return;
    }
}

/// Behind those that are there.
void append_entry(params::SceneSpec& spec, const TableEntry& entry) {
    const params::Section& section = *params::find_section(entry.section);
    section.append(spec);
    const std::size_t index = section.count(spec) - 1;
    for (const auto& [key, value] : entry.values) section.find(key)->set(spec, index, value);
}

json entry_value_json(const params::ParameterValue& value) {
    if (const double* number = std::get_if<double>(&value)) return *number;
    if (const std::string* text = std::get_if<std::string>(&value)) return *text;
    if (const bool* yes = std::get_if<bool>(&value)) return *yes;
    return nullptr;
}

/// monostate where it is null.
Result<params::ParameterValue> read_entry_value(const json& values, const params::Parameter& parameter) {
    const json& value = values[parameter.key];
    if (value.is_null()) return params::ParameterValue();
    switch (parameter.kind) {
        case params::ParameterKind::boolean:
            if (!value.is_boolean()) {
                return Error{fmt::format("{} = {}: must be true or false", parameter.key, shown(value))};
            }
            return params::ParameterValue(value.get<bool>());
        case params::ParameterKind::number: {
            TALUS_ASSIGN(const auto number, read_number(values, parameter.key, parameter.range, parameter.unit));
            return params::ParameterValue(*number);
        }
        default: {
            TALUS_ASSIGN(auto text, read_text(values, parameter.key, longest_entry_text));
            return params::ParameterValue(std::move(*text));
        }
    }
}

/// A sentence of the scene file's reader about its only entry, without the place in a file.
std::string without_place(const std::string& sentence, const std::string& section) {
    const std::string begin = section + "[0].";
    const std::size_t at = sentence.find(begin);
    return at == std::string::npos ? sentence : sentence.substr(at + begin.size());
}

/// Required keys and rules, of an entry behind those of `spec`.
Status check_behind(params::SceneSpec spec, const TableEntry& entry, double particle_spacing) {
    const params::Section& section = *params::find_section(entry.section);
    for (const params::Parameter& parameter : section.parameters) {
        if (!parameter.required || entry.values.contains(parameter.key)) continue;
        return Error{fmt::format("{}: missing; it must be {}", parameter.key, allowed_text(parameter))};
    }
    append_entry(spec, entry);
    const std::size_t index = section.count(spec) - 1;
    auto broken = wrong_choice(section, spec, index, false);
    if (!broken) broken = broken_rule(section, spec, index, particle_spacing);
    return broken ? Status(Error{broken->key + broken->text}) : Status();
}

/// What the reader checks against terrain, path and names.
Status check_in_scene(const TableEntry& entry, TableKind kind, const Setup& setup, const scene::Scene& scene) {
    scene::Scene checked = scene;
    for (const TableKind each : {TableKind::observation, TableKind::trigger, TableKind::alarm}) {
        clear_entries(checked.spec, each);
    }
    append_entry(checked.spec, entry);
    if (kind == TableKind::alarm) {
        checked.buildings = bodies_of(setup.buildings);
        for (const BarrierSetup& barrier : setup.barriers) checked.buildings.push_back(*barrier.body);
    }
    const scene::ParsedScene parsed{.file = {}, .spec = checked.spec, .places = {}};
    const Status found =
        kind == TableKind::observation ? check_observed_places(parsed, checked) : check_alerts(parsed, checked);
    return found ? found : Status(Error{without_place(found.error().message, entry.section)});
}

}  // namespace

const std::vector<std::string>& sections_of(TableKind kind) {
    static const std::vector<std::string> observed = {"observation",   "superelevation", "arrival",         "run_up",
                                                      "deposit_depth", "damage",         "observed_run_out"};
    static const std::vector<std::string> triggers = {"trigger"}, alarms = {"alarm"};
    return kind == TableKind::observation ? observed : kind == TableKind::trigger ? triggers : alarms;
}

std::string TableEntry::name() const {
    for (const char* key : {"name", "building"}) {
        const auto found = values.find(key);
        if (found != values.end()) return std::get<std::string>(found->second);
    }
    return section;
}

std::vector<TableEntry> entries_of(const params::SceneSpec& spec, TableKind kind) {
    std::vector<TableEntry> entries;
    for (const std::string& name : sections_of(kind)) {
        const params::Section& section = *params::find_section(name);
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            TableEntry& entry = entries.emplace_back();
            entry.section = name;
            for (const params::Parameter& parameter : section.parameters) {
                params::ParameterValue value = parameter.get(spec, index);
                if (!std::holds_alternative<std::monostate>(value)) entry.values[parameter.key] = std::move(value);
            }
        }
    }
    return entries;
}

void put_entries(params::SceneSpec& spec, TableKind kind, const std::vector<TableEntry>& entries) {
    clear_entries(spec, kind);
    for (const TableEntry& entry : entries) append_entry(spec, entry);
}

bool operator==(const TableEntry& a, const TableEntry& b) {
    return a.section == b.section && table_values_json(a) == table_values_json(b);
}

json table_values_json(const TableEntry& entry) {
    params::SceneSpec spec;  // with the default of what is not given
    append_entry(spec, entry);
    json values = json::object();
    for (const params::Parameter& parameter : params::find_section(entry.section)->parameters) {
        values[parameter.key] = entry_value_json(parameter.get(spec, 0));
    }
    return values;
}

Status read_table_values(const json& values, TableEntry& entry) {
    if (!values.is_object()) return Error{fmt::format("values = {}: must be an object", shown(values))};
    const params::Section& section = *params::find_section(entry.section);
    std::vector<std::string> keys;
    for (const params::Parameter& parameter : section.parameters) keys.push_back(parameter.key);
    TALUS_TRY(check_keys(values, keys, {}));
    for (const params::Parameter& parameter : section.parameters) {
        if (!values.contains(parameter.key)) continue;
        TALUS_ASSIGN(params::ParameterValue value, read_entry_value(values, parameter));
        if (std::holds_alternative<std::monostate>(value)) {
            entry.values.erase(parameter.key);
        } else {
            entry.values[parameter.key] = std::move(value);
        }
    }
    return {};
}

Result<TableEntry> read_table_entry(const json& file, TableKind kind) {
    TALUS_ASSIGN(const auto section, read_text(file, "section"));
    const std::vector<std::string>& known = sections_of(kind);
    if (!section || std::find(known.begin(), known.end(), *section) == known.end()) {
        return Error{fmt::format("section = {}: must be one of {}", shown(file.value("section", json())),
                                 fmt::join(known, ", "))};
    }
    TableEntry entry{*section, {}};
    TALUS_TRY(read_table_values(file.value("values", json::object()), entry));
    return entry;
}

Status check_table_shape(const TableEntry& entry) {
    return check_behind({}, entry, 0);  // no rule of these sections is about the particles' spacing
}

Status check_table_entry(const TableEntry& entry, TableKind kind, const std::vector<TableEntry>& others,
                         const Setup& setup, const scene::Scene& scene, double particle_spacing) {
    params::SceneSpec spec;
    put_entries(spec, kind, others);
    TALUS_TRY(check_behind(std::move(spec), entry, particle_spacing));
    return check_in_scene(entry, kind, setup, scene);
}

std::vector<messages::TableSection> table_sections() {
    std::vector<messages::TableSection> list;
    for (const TableKind kind : {TableKind::observation, TableKind::trigger, TableKind::alarm}) {
        for (const std::string& name : sections_of(kind)) {
            const params::Section& section = *params::find_section(name);
            std::vector<messages::TableKey> keys;
            std::vector<std::vector<std::string>> choices;
            keys.reserve(section.parameters.size());
            choices.reserve(section.alternatives.size());
            for (const params::Parameter& parameter : section.parameters) {
                const bool number = parameter.kind == params::ParameterKind::number;
                const bool text = parameter.kind == params::ParameterKind::text;
                keys.push_back({.key = parameter.key,
                                .label = label_of(parameter),
                                .unit = parameter.unit,
                                .is = number ? "number"
                                      : text ? "text"
                                             : "boolean",
                                .required = parameter.required,
                                .default_ = entry_value_json(default_value(section, parameter)),
                                .absent = parameter.absent,
                                .allowed = number ? parameter.range.text() : "",
                                .help = parameter.help});
            }
            for (const params::Alternatives& choice : section.alternatives) choices.push_back(choice.keys);
            list.push_back({.section = name,
                            .kind = kind_name(kind),
                            .help = section.help,
                            .keys = std::move(keys),
                            .one_of = std::move(choices)});
        }
    }
    return list;
}

}  // namespace talus::twin
