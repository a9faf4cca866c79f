#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/try.hpp"
#include "serve/protocol_pages.hpp"

namespace talus::test {
namespace {

using serve::Field;
using serve::Protocol;
using serve::RouteDescription;
using serve::Type;
using serve::TypeDescription;
using serve::UnionDescription;
using serve::Variant;
using Kind = Type::Kind;

/// Keys carry their unit. Longer endings first.
constexpr std::array<std::pair<std::string_view, std::string_view>, 16> units = {{{"_kgpm3", "kg/m³"},
                                                                                  {"_m3ps", "m³/s"},
                                                                                  {"_mps2", "m/s²"},
                                                                                  {"_mps", "m/s"},
                                                                                  {"_m3", "m³"},
                                                                                  {"_m2", "m²"},
                                                                                  {"_kNs", "kN s"},
                                                                                  {"_kN", "kN"},
                                                                                  {"_kPa", "kPa"},
                                                                                  {"_deg", "°"},
                                                                                  {"_hz", "Hz"},
                                                                                  {"per_second", "1/s"},
                                                                                  {"bytes", "bytes"},
                                                                                  {"_m", "m"},
                                                                                  {"_s", "s"},
                                                                                  {"_95", ""}}};

std::string unit_of(const std::string& key) {
    for (const auto& [ending, unit] : units) {
        if (key.ends_with(ending)) return std::string(unit);
    }
    return "";
}

/// For a cell of a table.
std::string cell(const std::string& text) {
    std::string escaped;
    for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
    return escaped;
}

std::string type_text(const Type& type) {
    const auto parts = [&](std::string_view between) {
        std::string text;
        for (const Type& part : type.parts) text += (text.empty() ? "" : std::string(between)) + type_text(part);
        return text;
    };
    switch (type.kind) {
        case Kind::name: {
            std::string anchor = type.name;
            std::transform(anchor.begin(), anchor.end(), anchor.begin(),
                           [](unsigned char c) { return std::tolower(c); });
            // The actions have a section of their own, not one of types.
            return fmt::format("[{}](#{})", type.name, anchor == "action" ? "actions" : anchor);
        }
        case Kind::list: {
            std::string list = "list of " + type_text(type.parts.front());
            return type.bounds ? fmt::format("{}, {} to {}", list, type.bounds->first, type.bounds->second) : list;
        }
        case Kind::either:
            return parts(" or ");
        case Kind::tuple:
            return "[" + parts(", ") + "]";
        case Kind::record:
            return fmt::format("{} by {}", type_text(type.parts[1]), type_text(type.parts[0]));
        case Kind::partial:
            return "any of " + parts("");
        case Kind::text:
            return fmt::format("`\"{}\"`", type.name);
        case Kind::integer:
        case Kind::number: {
            const char* name = type.kind == Kind::integer ? "integer" : "number";
            return type.bounds ? fmt::format("{} from {} to {}", name, type.bounds->first, type.bounds->second) : name;
        }
        case Kind::fields:
            break;
        default:
            return typescript_of(type);
    }
    std::string text;
    for (const Field& field : type.fields) {
        text += fmt::format("{}`{}{}`: {}", text.empty() ? "" : ", ", field.key, field.optional ? "?" : "",
                            type_text(field.type));
    }
    return text;
}

/// "`time_s` (number, s; may be absent): when".
std::string parameter_text(const Field& field) {
    const std::string unit = unit_of(field.key);
    std::string text = fmt::format("`{}` ({}{}{})", field.key, type_text(field.type), unit.empty() ? "" : ", " + unit,
                                   field.optional ? "; may be absent" : "");
    return field.doc.empty() ? text : text + ": " + field.doc;
}

std::string parameters_text(const std::vector<Field>& fields) {
    std::string text;
    for (const Field& field : fields) text += (text.empty() ? "" : ". ") + parameter_text(field);
    return text;
}

std::string content_text(const serve::Content& content) {
    return content.media.empty() ? type_text(content.type) : fmt::format("`{}`", fmt::join(content.media, "` or `"));
}

std::string routes_table(const Protocol& all, const std::string& group) {
    std::string text = "| Route | Who | Takes | What | Answer |\n|---|---|---|---|---|\n";
    for (const RouteDescription& route : all.routes) {
        if (route.group != group) continue;
        std::string takes = parameters_text(route.query);
        if (route.body) takes += (takes.empty() ? "" : ". ") + content_text(*route.body);
        std::string answer = content_text(route.answer);
        if (!route.answer.media.empty()) answer += ": " + route.answer_doc;
        if (route.status != 200) answer += fmt::format(", {}", route.status);
        text +=
            fmt::format("| `{} {}` | {} | {} | {} | {} |\n", route.method, route.path, caller_name(route.who),
                        cell(takes), cell(route.does + (route.more.empty() ? "" : ". " + route.more)), cell(answer));
    }
    return text;
}

std::string fields_table(const std::vector<Field>& fields) {
    if (fields.empty()) return "";
    std::string text = "\n| Key | Type | Unit | What |\n|---|---|---|---|\n";
    for (const Field& field : fields) {
        text += fmt::format("| `{}{}` | {} | {} | {} |\n", field.key, field.optional ? "?" : "",
                            cell(type_text(field.type)), unit_of(field.key), cell(field.doc));
    }
    return text;
}

std::string types_text(const Protocol& all, const std::string& group) {
    std::string text;
    for (const TypeDescription& type : all.types) {
        if (type.group != group) continue;
        std::string about;
        if (type.is) about += "Is " + type_text(*type.is) + ". ";
        if (!type.doc.empty()) about += type.doc + (type.doc.ends_with('.') ? " " : ". ");
        if (!type.extends.empty())
            about += fmt::format("It has the keys of {} as well. ", type_text(of_kind(Kind::name, type.extends)));
        for (const std::string& section : {type.section, type.input}) {
            if (!section.empty()) about += fmt::format("It has the live keys of `[[{}]]`. ", section);
        }
        if (!type.input.empty()) about += "Those that are not required can be left out. ";
        while (about.ends_with(' ')) about.pop_back();
        text += fmt::format("{}#### {}\n{}{}", text.empty() ? "" : "\n", type.name,
                            about.empty() ? "" : "\n" + about + "\n", fields_table(type.fields));
    }
    return text;
}

std::string union_table(const UnionDescription& all) {
    std::string text = fmt::format("| `{}` | Other keys | {} |\n|---|---|---|\n", all.tag,
                                   all.tag == "action" ? "Takes effect" : "When");
    for (const Variant& variant : all.variants) {
        std::string keys = parameters_text(variant.fields);
        const auto add = [&](const std::string& more) { keys += (keys.empty() ? "" : ". ") + more; };
        if (!variant.extends.empty()) add("those of " + type_text(of_kind(Kind::name, variant.extends)));
        if (!variant.partial.empty()) add(fmt::format("Live keys of `[[{}]]`", variant.partial));
        text += fmt::format("| `{}` | {} | {} |\n", fmt::join(variant.names, "`, `"), cell(keys), cell(variant.when));
    }
    return text;
}

Result<std::string> made(const Protocol& all, const std::string& what) {
    const std::size_t blank = what.find(' ');
    const std::string kind = what.substr(0, blank), name = blank == std::string::npos ? "" : what.substr(blank + 1);
    if (kind == "routes") return routes_table(all, name);
    if (kind == "types") return types_text(all, name);
    for (const UnionDescription& one : all.unions) {
        if (kind == "union" && one.name == name) return union_table(one);
    }
    return Error{"there is nothing to be made for " + what};
}

}  // namespace

Result<std::string> with_protocol_tables(const Protocol& all, const std::string& page) {
    constexpr std::string_view begin = "<!-- protocol.json: ", close = " -->\n", end = "<!-- end -->";
    std::string text;
    std::size_t at = 0;
    for (std::size_t found = page.find(begin); found != std::string::npos; found = page.find(begin, at)) {
        const std::size_t what = found + begin.size(), body = page.find(close, what), stop = page.find(end, what);
        if (body == std::string::npos || stop == std::string::npos || stop < body) {
            return Error{"no end of " + page.substr(what, 30)};
        }
        TALUS_ASSIGN(const std::string table, made(all, page.substr(what, body - what)));
        text += page.substr(at, body + close.size() - at) + "\n" + table + "\n";
        at = stop;
    }
    return text + page.substr(at);
}

}  // namespace talus::test
