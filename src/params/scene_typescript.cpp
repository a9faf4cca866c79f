#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "params/scene_text.hpp"

namespace talus::params {
namespace {

/// The page's unit for a key's unit, and the factor to convert to it.
std::pair<std::string, double> unit_of(const Parameter& parameter) {
    if (!parameter.form->unit.empty()) return {parameter.form->unit, parameter.form->factor};
    if (parameter.unit == "Pa") return {"kPa", 1e-3};
    if (parameter.unit == "N/m") return {"kN/m", 1e-3};
    if (parameter.unit == "m/Pa") return {"m/kPa", 1e3};
    if (parameter.unit == "1/m2") return {"1/ha", 1e4};
    return {parameter.unit, 1};
}

/// An inclusive bound, as the page uses it.
std::string bound_text(double bound, bool included, double inward) {
    if (std::isinf(bound)) return bound < 0 ? "-Infinity" : "Infinity";
    return fmt::format("{:.8g}", included ? bound : bound + inward);
}

std::string type_of(const Parameter& parameter) {
    std::string type = "number";
    if (parameter.kind == ParameterKind::choice) {
        type.clear();
        for (const std::string& choice : parameter.choices) type += (type.empty() ? "" : " | ") + toml_text(choice);
    }
    return type + (parameter.absent.empty() ? "" : " | null");
}

std::string field_of(const Parameter& parameter) {
    const Form& form = *parameter.form;
    const auto [unit, factor] = unit_of(parameter);
    const double step = std::pow(10, std::floor(std::log10((form.slider_high - form.slider_low) / 100)) - 2);
    const Range& range = parameter.range;
    return fmt::format(
        "    {}: {{\n      label: {}, unit: {}, factor: {:.8g}, low: {}, high: {}, sliderLow: {:.8g}, sliderHigh: "
        "{:.8g}, "
        "first: {:.8g},\n      tick: {}, tickHelp: {}, help: {},\n    }},\n",
        parameter.live, toml_text(form.label), toml_text(unit), factor,
        bound_text(range.low * factor, range.low_included, step),
        bound_text(range.high * factor, range.high_included, -step), form.slider_low, form.slider_high, form.first,
        form.tick.empty() ? "null" : toml_text(form.tick), toml_text(form.tick_help), toml_text(parameter.help));
}

/// The relations of the key to others; "" if there are none.
std::string tie_of(const Parameter& parameter) {
    std::string tie;
    if (parameter.spacings > 0) {
        tie += fmt::format("\n      spacings: {:.8g}, why: {},", parameter.spacings, toml_text(parameter.spacings_why));
    }
    if (!parameter.below.empty()) tie += fmt::format("\n      below: {},", toml_text(parameter.below));
    if (const auto& need = parameter.need) {
        tie += fmt::format("\n      needs: {{ key: {}, value: {}, why: {} }},", toml_text(need->key),
                           toml_text(need->value), toml_text(need->why));
    }
    return tie.empty() ? "" : fmt::format("    {}: {{{}\n    }},\n", parameter.live, tie);
}

/// "barrier_opening" -> "BarrierOpeningValues".
std::string interface_name(const std::string& section) {
    std::string name;
    for (std::size_t i = 0; i < section.size(); ++i) {
        if (section[i] == '_') continue;
        const bool first = i == 0 || section[i - 1] == '_';
        name += first ? static_cast<char>(std::toupper(static_cast<unsigned char>(section[i]))) : section[i];
    }
    return name + "Values";
}

}  // namespace

std::string scene_typescript() {
    std::string types, fields, ties;
    for (const Section& section : live_sections()) {
        std::string members, of_section, ties_of_section;
        for (const Parameter& parameter : section.parameters) {
            if (parameter.live.empty()) continue;
            const std::string absent = parameter.absent.empty() ? "" : " null: " + parameter.absent + ".";
            members +=
                fmt::format("  /** {}{} */\n  {}: {};\n", parameter.help, absent, parameter.live, type_of(parameter));
            if (parameter.form) of_section += field_of(parameter);
            ties_of_section += tie_of(parameter);
        }
        if (members.empty()) continue;
        types += fmt::format("/** {} */\nexport interface {} {{\n{}}}\n\n", section.help, interface_name(section.name),
                             members);
        if (!ties_of_section.empty()) ties += fmt::format("  {}: {{\n{}  }},\n", section.name, ties_of_section);
        if (!of_section.empty()) fields += fmt::format("  {}: {{\n{}  }},\n", section.name, of_section);
    }
    return "// Generated from the field table by `talus scene reference --typescript`; a test keeps it current.\n\n" +
           types +
           "/** How a form shows a value: times `factor`, in this unit. `first`: what it begins with; `tick`: the "
           "label of "
           "the box that gives it and takes it away. */\n"
           "export interface FieldDescription {\n"
           "  label: string; unit: string; factor: number; low: number; high: number; sliderLow: number; sliderHigh: "
           "number; first: number;\n  tick: string | null; tickHelp: string; help: string;\n}\n\n"
           "/** By section and key. */\nexport const fields = {\n" +
           fields +
           "} as const satisfies Record<string, Record<string, FieldDescription>>;\n\n"
           "/** What ties a value to others. `spacings`: it is at least so many particle spacings; `below`: the key "
           "that it "
           "is below, where that is given; `needs`: a key of the scene without which the value is refused. */\n"
           "export interface Tie {\n  spacings?: number; why?: string;\n  below?: string;\n"
           "  needs?: { key: string; value: string; why: string };\n}\n\n"
           "/** By section and key. */\nexport const ties: Record<string, Record<string, Tie>> = {\n" +
           ties + "};\n";
}

}  // namespace talus::params
