#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "params/fields.hpp"

/// What is asked of the field table: sections by name, defaults, and the rules between keys.
namespace talus::params {

const Section* find_section(std::string_view name) {
    for (const Section& section : scene_sections()) {
        if (section.name == name) return &section;
    }
    return nullptr;
}

const Parameter* Section::find(std::string_view key) const {
    for (const Parameter& parameter : parameters) {
        if (parameter.key == key) return &parameter;
    }
    return nullptr;
}

ParameterValue default_value(const Section& section, const Parameter& parameter) {
    if (parameter.required) return {};
    SceneSpec spec;
    if (section.repeats) section.append(spec);
    return parameter.get(spec, 0);
}

bool is_given(const ParameterValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return !text->empty();
    if (const auto* points = std::get_if<std::vector<PlanPoint>>(&value)) return !points->empty();
    return !std::holds_alternative<std::monostate>(value);
}

std::optional<Violation> wrong_choice(const Section& section, const SceneSpec& spec, std::size_t index,
                                      bool live_only) {
    for (const Alternatives& choice : section.alternatives) {
        std::vector<std::string> given;
        bool all_live = true;
        for (const std::string& key : choice.keys) {
            const Parameter& parameter = *section.find(key);
            all_live = all_live && !parameter.live.empty();
            if (is_given(parameter.get(spec, index))) given.push_back(key);
        }
        if (given.size() == 1 || (given.empty() && !choice.required) || (live_only && !all_live)) continue;
        return Violation{
            given.empty() ? choice.blamed : given.back(),
            fmt::format(": {} of {} {} be given; {}", choice.required ? "exactly one" : "at most one",
                        fmt::join(choice.keys, ", "), choice.required ? "must" : "may",
                        given.empty() ? "there is none" : fmt::format("given are {}", fmt::join(given, ", ")))};
    }
    return {};
}

namespace {

/// A number in the unit of its key, where one is given.
std::optional<double> number_in(const Parameter& parameter, const SceneSpec& spec, std::size_t index) {
    const ParameterValue value = parameter.get(spec, index);
    const double* number = std::get_if<double>(&value);
    return number != nullptr ? std::optional(*number) : std::nullopt;
}

bool is_met(const Need& need, const SceneSpec& spec) {
    const std::size_t dot = need.key.find('.');
    const Parameter& other = parameter_of(need.key.substr(0, dot), need.key.substr(dot + 1));
    return plain_text(other.get(spec, 0)) == need.value;
}

/// Checks the relations of a key to others.
std::optional<Violation> broken_tie(const Section& section, const Parameter& parameter, const SceneSpec& spec,
                                    std::size_t index, double spacing) {
    const std::optional<double> value = number_in(parameter, spec, index);
    if (!value) return {};
    if (parameter.spacings > 0 && *value < parameter.spacings * spacing) {
        return Violation{
            parameter.key,
            fmt::format(" = {:.6g} is refused; with particles of {:.3g} m it must be at least {:.4g} m: {}", *value,
                        spacing, std::ceil(1000 * parameter.spacings * spacing) / 1000, parameter.spacings_why)};
    }
    if (!parameter.below.empty()) {
        const std::optional<double> above = number_in(*section.find(parameter.below), spec, index);
        if (above && *value >= *above) {
            return Violation{parameter.key, fmt::format(" = {:.6g} is refused; it must be below {} = {:.6g}", *value,
                                                        parameter.below, *above)};
        }
    }
    if (const auto& need = parameter.need; need && (*value != 0 || need->even_at_0) && !is_met(*need, spec)) {
        return Violation{parameter.key, fmt::format(": needs {} = \"{}\"; {}", need->key, need->value, need->why)};
    }
    return {};
}

}  // namespace

std::optional<Violation> broken_rule(const Section& section, const SceneSpec& spec, std::size_t index,
                                     double particle_spacing) {
    for (const Parameter& parameter : section.parameters) {
        if (auto broken = broken_tie(section, parameter, spec, index, particle_spacing)) return broken;
    }
    for (const Rule& rule : section.rules) {
        if (std::optional<Violation> broken = rule(spec, index, particle_spacing)) return broken;
    }
    return {};
}

std::string key_path(const Section& section, std::size_t index, const Parameter& parameter) {
    return section.name + (section.repeats ? "[" + std::to_string(index) + "]" : "") + "." + parameter.key;
}

void for_each_value(
    const SceneSpec& spec,
    const std::function<void(const Section&, std::size_t, const Parameter&, const ParameterValue&)>& visit) {
    for (const Section& section : scene_sections()) {
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            for (const Parameter& parameter : section.parameters) {
                visit(section, index, parameter, parameter.get(spec, index));
            }
        }
    }
}

}  // namespace talus::params
