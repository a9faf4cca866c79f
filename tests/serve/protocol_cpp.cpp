#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include <fmt/format.h>

#include "serve/protocol_pages.hpp"

namespace talus::test {
namespace {

using serve::Field;
using serve::Protocol;
using serve::Type;
using serve::TypeDescription;
using serve::UnionDescription;
using serve::Variant;
using Kind = Type::Kind;

constexpr std::string_view any_json = "nlohmann::json", server_messages = "ServerMessage";
/// These stay JSON: the modules that write results.json and read overlays make their texts, scenarios and their
/// sessions each know a part of setups, which follow the scene file, and values of triggers are as somebody sent them.
constexpr std::array<std::string_view, 11> as_they_came = {
    "Verdict",    "Check",       "Figure",       "Setup",          "Gauge",        "Note",
    "TableEntry", "OverlayData", "OverlayStyle", "OverlayFeature", "TriggerValues"};
constexpr std::string_view made_from =
    "// Made from src/messages/protocol.json: edit that; docs/protocol.md tells how this is made again.\n"
    "// clang-format off\n";

/// "first_hit" -> "FirstHit"
std::string type_name(const std::string& key) {
    std::string name;
    bool first = true;
    for (const char c : key) {
        if (c != '_') name += first ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        first = c == '_';
    }
    return name;
}

/// "FirstHit" -> "first_hit"
std::string member_name(const std::string& type) {
    std::string name;
    for (const char c : type) {
        const auto letter = static_cast<unsigned char>(c);
        if (std::isupper(letter) != 0 && !name.empty()) name += '_';
        name += static_cast<char>(std::tolower(letter));
    }
    return name;
}

/// A key that is a word of C++ has _ behind it.
std::string identifier(const std::string& key) {
    constexpr std::array<std::string_view, 8> words = {"class", "default", "delete", "do",
                                                       "new",   "private", "public", "this"};
    return std::find(words.begin(), words.end(), key) == words.end() ? key : key + "_";
}

/// The object with fields in a type, or in one alternative of it; nullptr: there is none.
const Type* own_fields(const Type& type) {
    if (type.kind == Kind::fields) return &type;
    for (const Type& part : type.parts) {
        if (type.kind == Kind::either && part.kind == Kind::fields) return &part;
    }
    return nullptr;
}

/// Makes the structs of what the server sends, each behind those that it has.
class Structs {
  public:
    explicit Structs(const Protocol& all) : all_(all) {
        for (const serve::RouteDescription& route : all.routes) add(route.answer.type);
        add(serve::of_kind(Kind::name, "Refusal"));  // the answer to whatever is refused
        for (const UnionDescription& one : all.unions) {
            if (one.name != server_messages) continue;
            for (const Variant& variant : one.variants) add(variant, one.tag);
        }
    }
    [[nodiscard]] const std::string& header() const { return header_; }
    [[nodiscard]] const std::string& writers() const { return writers_; }

  private:
    /// Live values of the scene file stay JSON.
    static bool is_described(const TypeDescription& type) {
        return !type.is && type.section.empty() && type.input.empty();
    }
    static bool is_struct(const TypeDescription& type) {
        return is_described(type) &&
               std::find(as_they_came.begin(), as_they_came.end(), type.name) == as_they_came.end();
    }

    void add(const Type& type) {
        std::set<std::string> names;
        add_names(type, names);
        for (const std::string& name : names) {
            const TypeDescription* found = all_.find(name);
            if (found == nullptr || !known_.insert(name).second) continue;
            if (found->is) add(*found->is);
            if (!is_described(*found)) continue;
            if (!found->extends.empty()) add(serve::of_kind(Kind::name, found->extends));
            for (const Field& field : found->fields) add(field.type);
            if (!is_struct(*found)) continue;
            const std::string base = found->extends.empty() ? "" : "from." + member_name(found->extends);
            write(name, found->extends, found->fields, base);
        }
    }

    /// One that has nothing but the keys of a type is that type with the tag.
    void add(const Variant& variant, const std::string& tag) {
        if (!variant.extends.empty()) return add(serve::of_kind(Kind::name, variant.extends));
        for (const Field& field : variant.fields) add(field.type);
        for (const std::string& name : variant.names) {
            write(type_name(name) + "Message", "", variant.fields, fmt::format("{{{{\"{}\", \"{}\"}}}}", tag, name));
        }
    }

    /// `begun_with`: what its JSON is before the fields; empty: an empty object.
    void write(const std::string& name, const std::string& extends, const std::vector<Field>& fields,
               const std::string& begun_with) {
        std::string functions;
        header_ += fmt::format("\nstruct {} {{\n", name);
        for (const Field& field : fields) {
            if (const Type* own = own_fields(field.type)) {
                const std::string inner = type_name(field.key);
                header_ += fmt::format("    struct {} {{\n{}    }};\n", inner, members(own->fields, "        "));
                functions += writer(name + "::" + inner, own->fields, "");
            }
        }
        functions += writer(name, fields, begun_with);
        if (!extends.empty()) header_ += fmt::format("    {} {};\n", extends, member_name(extends));
        header_ += members(fields, "    ") + "};\n" + functions;
    }

    std::string members(const std::vector<Field>& fields, std::string_view indent) const {
        std::string text;
        for (const Field& field : fields) {
            const std::string type = type_of(field.type, field.key), name = identifier(field.key);
            text += field.optional ? fmt::format("{}std::optional<{}> {}{{}};\n", indent, type, name)
                                   : fmt::format("{}{} {};\n", indent, type, name);
        }
        return text;
    }

    /// Returns the declaration.
    std::string writer(const std::string& name, const std::vector<Field>& fields, const std::string& begun_with) {
        writers_ += fmt::format("\nvoid to_json(json& to, const {}&{}) {{\n    to = {};\n", name,
                                fields.empty() ? "" : " from", begun_with.empty() ? "json::object()" : begun_with);
        for (const Field& field : fields) {
            writers_ += fmt::format("    {}(to, \"{}\", from.{});\n", field.optional ? "put_if_there" : "put",
                                    field.key, identifier(field.key));
        }
        writers_ += "}\n";
        return fmt::format("void to_json(nlohmann::json& to, const {}& from);\n", name);
    }

    [[nodiscard]] std::string type_of(const Type& type, const std::string& key) const {
        switch (type.kind) {
            case Kind::number:
                return "double";
            case Kind::integer:
            case Kind::whole:
                return "Integer";
            case Kind::string:
            case Kind::text:
                return "std::string";
            case Kind::boolean:
                return "bool";
            case Kind::null:
            case Kind::object:
                return std::string(any_json);
            case Kind::name: {
                const TypeDescription* found = all_.find(type.name);
                if (found != nullptr && found->is) return type_of(*found->is, key);
                return found != nullptr && is_struct(*found) ? type.name : std::string(any_json);
            }
            case Kind::list: {
                const std::string item = type_of(type.parts.front(), key);
                return fmt::format("std::vector<{}>", item == "std::optional<double>" ? "double" : item);
            }
            case Kind::tuple: {
                const bool numbers = std::all_of(type.parts.begin(), type.parts.end(),
                                                 [](const Type& part) { return part.kind == Kind::number; });
                return numbers ? fmt::format("std::array<double, {}>", type.parts.size()) : std::string(any_json);
            }
            case Kind::record:
                return fmt::format("std::map<std::string, {}>", type_of(type.parts[1], key));
            case Kind::partial:
                return type_of(type.parts.front(), key);
            case Kind::fields:
                return type_name(key);
            case Kind::either:
                break;
        }
        std::set<std::string> types;
        for (const Type& part : type.parts) {
            if (part.kind != Kind::null) types.insert(type_of(part, key));
        }
        if (types.size() != 1 || *types.begin() == any_json) return std::string(any_json);
        return type.may_be_null() ? fmt::format("std::optional<{}>", *types.begin()) : *types.begin();
    }

    const Protocol& all_;
    std::set<std::string> known_;
    std::string header_, writers_;
};

}  // namespace

std::string protocol_header(const Protocol& all) {
    return std::string(made_from) + R"(#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

/// The messages that are sent, a struct each whose JSON to_json() makes; docs/protocol.md says what they mean. What is
/// std::optional is null where it is empty; with {} behind it, absent. A number that is not finite is null.
namespace talus::messages {

/// A whole number, of any of the types that are.
struct Integer {
    template <class Whole>
        requires std::is_integral_v<Whole>
    Integer(Whole whole) : value(static_cast<std::int64_t>(whole)) {}
    std::int64_t value;
};

/// Nothing where it is empty.
[[nodiscard]] std::optional<std::string> if_any(std::string text);
)" + Structs(all).header() +
           "\n}  // namespace talus::messages\n";
}

std::string protocol_writers(const Protocol& all) {
    return std::string(made_from) + R"(#include "messages/messages.hpp"

#include <cmath>
#include <utility>

namespace talus::messages {
namespace {

using nlohmann::json;

struct Written {
    static json of(double number) { return std::isfinite(number) ? json(number) : json(); }
    static json of(const Integer& whole) { return whole.value; }
    template <class Value>
    static json of(const Value& value) {
        return value;
    }
    template <class Value>
    static json of(const std::optional<Value>& value) {
        return value ? of(*value) : json();
    }
    template <class Value>
    static json of(const std::vector<Value>& values) {
        json list = json::array();
        for (const Value& value : values) list.push_back(of(value));
        return list;
    }
    template <class Value>
    static json of(const std::map<std::string, Value>& values) {
        json object = json::object();
        for (const auto& [key, value] : values) object[key] = of(value);
        return object;
    }
};

template <class Value>
void put(json& to, const char* key, const Value& value) {
    to[key] = Written::of(value);
}

template <class Value>
void put_if_there(json& to, const char* key, const std::optional<Value>& value) {
    if (value) put(to, key, *value);
}

}  // namespace

std::optional<std::string> if_any(std::string text) {
    return text.empty() ? std::nullopt : std::optional(std::move(text));
}
)" + Structs(all).writers() +
           "\n}  // namespace talus::messages\n";
}

}  // namespace talus::test
