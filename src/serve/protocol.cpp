#include "serve/protocol.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/try.hpp"
#include "protocol_file.hpp"

namespace talus::serve {
namespace {

using Json = nlohmann::ordered_json;  // its keys stay in order

constexpr std::array<std::string_view, 6> callers = {"anyone", "trigger", "viewer", "controller", "control", "person"};

std::vector<std::string> words_of(std::string_view text, std::string_view between) {
    std::vector<std::string> words;
    while (!text.empty()) {
        const std::size_t at = text.find(between);
        words.emplace_back(text.substr(0, at));
        text = at == std::string_view::npos ? std::string_view() : text.substr(at + between.size());
    }
    return words;
}

std::string text_of(const Json& object, const char* key) {
    return object.value(key, "");
}

Status check_keys(const std::string& where, const Json& object, std::initializer_list<std::string_view> known) {
    for (const auto& [key, value] : object.items()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            return Error{fmt::format("{}: the key {} is not known", where, key)};
        }
    }
    return {};
}

Result<std::vector<Field>> read_fields(const Json& object, const char* key) {
    std::vector<Field> fields;
    if (!object.contains(key)) return fields;
    for (const auto& [name, text] : object[key].items()) {
        TALUS_ASSIGN(Field field, parse_field(name, text.get<std::string>()));
        fields.push_back(std::move(field));
    }
    return fields;
}

Result<Content> read_content(const std::string& text) {
    Content content;
    if (text.find('/') == std::string::npos) {
        TALUS_ASSIGN(content.type, parse_type(text));
    } else {
        content.media = words_of(text, ", ");
    }
    return content;
}

/// The parameters of a path: each is described once, for all paths that begin as it does.
Result<std::vector<Field>> read_path(const std::string& path, const Json& described) {
    std::vector<Field> parameters;
    for (std::size_t end = path.find('}'); end != std::string::npos; end = path.find('}', end + 1)) {
        const std::size_t begin = path.rfind('{', end) + 1;
        const auto found = described.find(path.substr(0, end + 1));
        if (found == described.end()) return Error{path.substr(0, end + 1) + ": is not in path_parameters"};
        TALUS_ASSIGN(Field field, parse_field(path.substr(begin, end - begin), found->get<std::string>()));
        parameters.push_back(std::move(field));
    }
    return parameters;
}

Result<RouteDescription> read_route(const std::string& group, const std::string& name, const Json& written,
                                    const Json& path_parameters) {
    TALUS_TRY(check_keys(name, written, {"does", "more", "who", "query", "body", "answer", "status", "errors"}));
    const std::vector<std::string> words = words_of(name, " ");
    if (words.size() != 2) return Error{name + ": must be a method and a path"};
    RouteDescription route{.group = group,
                           .method = words[0],
                           .path = words[1],
                           .does = text_of(written, "does"),
                           .more = text_of(written, "more")};
    const auto who = std::find(callers.begin(), callers.end(), text_of(written, "who"));
    if (who == callers.end()) return Error{fmt::format("{}: who must be one of {}", name, fmt::join(callers, ", "))};
    route.who = static_cast<Caller>(who - callers.begin());
    TALUS_ASSIGN(route.path_parameters, read_path(route.path, path_parameters));
    TALUS_ASSIGN(route.query, read_fields(written, "query"));
    if (written.contains("body")) {
        TALUS_ASSIGN(route.body, read_content(text_of(written, "body")));
    }
    auto [answer, doc] = split_doc(text_of(written, "answer"));
    TALUS_ASSIGN(route.answer, read_content(answer));
    route.answer_doc = std::move(doc);
    route.status = written.value("status", 200);
    route.errors = words_of(text_of(written, "errors"), " ");
    return route;
}

Result<TypeDescription> read_type(const std::string& group, const std::string& name, const Json& written) {
    TALUS_TRY(check_keys(name, written, {"is", "doc", "values", "extends", "section", "input", "fields"}));
    TypeDescription type{.group = group, .name = name, .doc = text_of(written, "doc")};
    if (written.contains("is")) {
        TALUS_ASSIGN(type.is, parse_type(text_of(written, "is")));
    }
    type.values = text_of(written, "values");
    type.extends = text_of(written, "extends");
    type.section = text_of(written, "section");
    type.input = text_of(written, "input");
    TALUS_ASSIGN(type.fields, read_fields(written, "fields"));
    return type;
}

Result<UnionDescription> read_union(const std::string& name, const Json& written) {
    TALUS_TRY(check_keys(name, written, {"tag", "doc", "of"}));
    UnionDescription all{.name = name, .tag = text_of(written, "tag"), .doc = text_of(written, "doc"), .variants = {}};
    for (const auto& [names, one] : written.at("of").items()) {
        TALUS_TRY(check_keys(names, one, {"when", "extends", "partial", "fields"}));
        Variant variant{.names = words_of(names, ", "), .when = text_of(one, "when")};
        variant.extends = text_of(one, "extends");
        variant.partial = text_of(one, "partial");
        TALUS_ASSIGN(variant.fields, read_fields(one, "fields"));
        all.variants.push_back(std::move(variant));
    }
    return all;
}

/// The names of all types that are used.
std::set<std::string> used_names(const Protocol& all) {
    std::set<std::string> names;
    const auto add = [&](const std::vector<Field>& fields) {
        for (const Field& field : fields) add_names(field.type, names);
    };
    for (const RouteDescription& route : all.routes) {
        add_names(route.answer.type, names);
        if (route.body) add_names(route.body->type, names);
        add(route.path_parameters);
        add(route.query);
    }
    for (const TypeDescription& type : all.types) {
        if (type.is) add_names(*type.is, names);
        if (!type.extends.empty()) names.insert(type.extends);
        add(type.fields);
    }
    for (const UnionDescription& one : all.unions) {
        for (const Variant& variant : one.variants) {
            if (!variant.extends.empty()) names.insert(variant.extends);
            add(variant.fields);
        }
    }
    return names;
}

Status check_names(const Protocol& all) {
    for (const std::string& name : used_names(all)) {
        const bool is_union = std::any_of(all.unions.begin(), all.unions.end(),
                                          [&](const UnionDescription& one) { return one.name == name; });
        if (!is_union && all.find(name) == nullptr) return Error{fmt::format("the type {} is not described", name)};
    }
    return {};
}

std::vector<Field> followed_by(std::vector<Field> fields, const std::vector<Field>& more) {
    fields.insert(fields.end(), more.begin(), more.end());
    return fields;
}

}  // namespace

std::string_view caller_name(Caller caller) {
    return callers[static_cast<std::size_t>(caller)];
}

session::Role role_of(Caller caller) {
    using session::Role;
    switch (caller) {
        case Caller::anyone:
            return Role::nobody;
        case Caller::trigger:
            return Role::trigger;
        case Caller::viewer:
            return Role::viewer;
        default:
            return Role::controller;
    }
}

const TypeDescription* Protocol::find(std::string_view name) const {
    const auto found =
        std::find_if(types.begin(), types.end(), [&](const TypeDescription& type) { return type.name == name; });
    return found == types.end() ? nullptr : &*found;
}

std::vector<Field> Protocol::fields_of(const TypeDescription& type) const {
    return type.extends.empty() ? type.fields : followed_by(fields_of(*find(type.extends)), type.fields);
}

std::vector<Field> Protocol::fields_of(const Variant& variant) const {
    return variant.extends.empty() ? variant.fields : followed_by(fields_of(*find(variant.extends)), variant.fields);
}

Result<Protocol> read_protocol(std::string_view text) {
    const Json written = Json::parse(text);
    TALUS_TRY(check_keys("protocol.json", written,
                         {"info", "token", "person", "errors", "path_parameters", "routes", "types", "unions"}));
    Protocol all;
    all.info = written.at("info").dump();
    all.token = text_of(written, "token");
    all.person = text_of(written, "person");
    for (const auto& [status, doc] : written.at("errors").items()) {
        all.errors.emplace_back(status, doc.get<std::string>());
    }
    for (const auto& [group, routes] : written.at("routes").items()) {
        for (const auto& [name, route] : routes.items()) {
            TALUS_ASSIGN(RouteDescription read, read_route(group, name, route, written.at("path_parameters")));
            all.routes.push_back(std::move(read));
        }
    }
    for (const auto& [group, types] : written.at("types").items()) {
        for (const auto& [name, type] : types.items()) {
            TALUS_ASSIGN(TypeDescription read, read_type(group, name, type));
            all.types.push_back(std::move(read));
        }
    }
    for (const auto& [name, one] : written.at("unions").items()) {
        TALUS_ASSIGN(UnionDescription read, read_union(name, one));
        all.unions.push_back(std::move(read));
    }
    TALUS_TRY(check_names(all));
    return all;
}

const Protocol& protocol() {
    static const Protocol all = read_protocol(protocol_file::protocol_json).value();
    return all;
}

}  // namespace talus::serve
