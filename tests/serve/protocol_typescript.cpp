#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include <fmt/format.h>

#include "core/hazard_maps.hpp"
#include "params/fields.hpp"
#include "serve/protocol_pages.hpp"

namespace talus::test {
namespace {

using serve::Field;
using serve::Protocol;
using serve::Type;
using serve::TypeDescription;
using serve::UnionDescription;
using serve::Variant;

constexpr std::size_t widest = 150;

/// "barrier_opening" -> "BarrierOpeningValues", as schema.ts names them.
std::string values_name(const std::string& section) {
    std::string name;
    bool first = true;
    for (const char c : section) {
        if (c != '_') name += first ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        first = c == '_';
    }
    return name + "Values";
}

/// What somebody gives of a section's values: those that are not required can be left out.
std::string given_values(const std::string& section) {
    std::string optional;
    for (const params::Parameter& parameter : params::live_section(section).parameters) {
        if (parameter.live.empty() || parameter.required) continue;
        optional += fmt::format("{}\"{}\"", optional.empty() ? "" : " | ", parameter.live);
    }
    const std::string values = values_name(section);
    return optional.empty() ? values : fmt::format("Omit<{0}, {1}> & Partial<{0}>", values, optional);
}

std::string comment(const std::string& doc, const char* indent = "") {
    if (doc.empty()) return "";
    return fmt::format("{}/** {}{} */\n", indent, doc, doc.ends_with('.') ? "" : ".");
}

std::string member(const Field& field) {
    return fmt::format("{}{}: {}", field.key, field.optional ? "?" : "", typescript_of(field.type));
}

std::string members(const std::vector<Field>& fields) {
    std::string text;
    for (const Field& field : fields) text += (text.empty() ? "" : "; ") + member(field);
    return text;
}

std::string interface_of(const TypeDescription& type) {
    std::string head = comment(type.doc) + "export interface " + type.name;
    const std::string base = type.section.empty() ? type.extends : values_name(type.section);
    if (!base.empty()) head += " extends " + base;
    const bool plain =
        std::all_of(type.fields.begin(), type.fields.end(), [](const Field& f) { return f.doc.empty(); });
    const std::string line = members(type.fields);
    if (plain && line.size() <= widest) return fmt::format("{} {{ {} }}\n", head, line);
    std::string text = head + " {\n";
    for (const Field& field : type.fields) text += comment(field.doc, "  ") + "  " + member(field) + ";\n";
    return text + "}\n";
}

std::string list_of(const TypeDescription& type) {
    std::string values;
    for (const Type& part : type.is->parts) values += (values.empty() ? "" : ", ") + typescript_of(part);
    return fmt::format("{}export const {} = [{}] as const;\nexport type {} = (typeof {})[number];\n", comment(type.doc),
                       type.values, values, type.name, type.values);
}

std::string declaration_of(const TypeDescription& type) {
    const auto alias = [&](const std::string& to) {
        return fmt::format("{}export type {} = {};\n", comment(type.doc), type.name, to);
    };
    if (!type.values.empty()) return list_of(type);
    if (type.is) return alias(typescript_of(*type.is));
    if (!type.input.empty()) return alias(given_values(type.input));
    if (!type.section.empty() && type.fields.empty()) return alias(values_name(type.section));
    return interface_of(type);
}

std::string variant_of(const Variant& variant, const std::string& tag) {
    std::string names;
    for (const std::string& name : variant.names) names += fmt::format("{}\"{}\"", names.empty() ? "" : " | ", name);
    std::string text = fmt::format("{{ {}: {}", tag, names);
    if (!variant.fields.empty()) text += "; " + members(variant.fields);
    text += " }";
    if (!variant.extends.empty()) return fmt::format("({} & {})", text, variant.extends);
    return variant.partial.empty() ? text : fmt::format("({} & Partial<{}>)", text, values_name(variant.partial));
}

std::string declaration_of(const UnionDescription& all) {
    std::string text = comment(all.doc) + "export type " + all.name + " =";
    for (const Variant& variant : all.variants) text += "\n  | " + variant_of(variant, all.tag);
    return text + ";\n";
}

std::string import_of(const std::set<std::string>& names, const std::string& module) {
    if (names.empty()) return "";
    return fmt::format("import type {{ {} }} from \"./{}\";\n", fmt::join(names, ", "), module);
}

}  // namespace

std::string protocol_typescript(const Protocol& all, const std::string& group) {
    std::set<std::string> values, used, others;
    std::string text;
    for (const TypeDescription& type : all.types) {
        if (type.group != group) continue;
        for (const std::string& section : {type.section, type.input}) {
            if (!section.empty()) values.insert(values_name(section));
        }
        if (type.is) add_names(*type.is, used);
        for (const Field& field : type.fields) add_names(field.type, used);
        text += "\n" + declaration_of(type);
    }
    if (group == "messages") {
        for (const UnionDescription& one : all.unions) {
            for (const Variant& variant : one.variants) {
                if (!variant.partial.empty()) values.insert(values_name(variant.partial));
            }
            text += "\n" + declaration_of(one);
        }
    }
    for (const std::string& name : used) {
        const TypeDescription* type = all.find(name);
        if (type != nullptr && type->group != group) others.insert(name);
    }
    return "// Made from src/messages/protocol.json: edit that; docs/protocol.md tells how this is made again.\n" +
           import_of(others, "messages") + import_of(values, "schema") + text;
}

std::string maps_typescript() {
    constexpr std::array<std::string_view, 3> kinds = {"peak", "arrival", "present"};
    std::string text =
        "// Made from src/core/hazard_maps.hpp: edit that; docs/protocol.md tells how this is made again.\n\n"
        "/** The maps that every run has. `factor`: from what the server sends to `unit`; below `least`, in `unit`, "
        "nothing is drawn. */\nexport const maps = {\n";
    for (const NamedMap& map : named_maps) {
        const Ramp& r = map.ramp;
        text +=
            fmt::format("  {}: {{\n    title: \"{}\", unit: \"{}\", factor: {}, kind: \"{}\", least: {},\n", map.key,
                        map.title, map.unit, map.factor, kinds[static_cast<std::size_t>(map.kind)], map.least);
        text += fmt::format(
            "    ramp: {{ lowHue: {}, lowChroma: {}, highHue: {}, highChroma: {}, lowLightness: {}, highLightness: {} "
            "}},\n"
            "    help: \"{}\",\n  }},\n",
            r.low_hue, r.low_chroma, r.high_hue, r.high_chroma, r.low_lightness, r.high_lightness, map.help);
    }
    return text + "} as const;\nexport type MapName = keyof typeof maps;\n";
}

}  // namespace talus::test
