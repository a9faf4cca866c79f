#include "serve/type_notation.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "core/hazard_maps.hpp"
#include "core/try.hpp"

namespace talus::serve {
namespace {

using Kind = Type::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 6> words = {{{"number", Kind::number},
                                                                     {"integer", Kind::integer},
                                                                     {"string", Kind::string},
                                                                     {"boolean", Kind::boolean},
                                                                     {"null", Kind::null},
                                                                     {"object", Kind::object}}};

/// `maps` is one alternative per map of a run.
void add_alternative(Type& all, Type part) {
    if (part.kind != Kind::name || part.name != "maps") {
        all.parts.push_back(std::move(part));
        return;
    }
    for (const NamedMap& map : named_maps) all.parts.push_back(of_kind(Kind::text, std::string(map.key)));
}

/// Reads a type from the front of what is left of a text.
class Reader {
  public:
    explicit Reader(std::string_view text) : text_(text) {}

    Result<Type> either() {
        TALUS_ASSIGN(Type first, with_brackets());
        if (!take("|")) return first;
        Type all = of_kind(Kind::either);
        add_alternative(all, std::move(first));
        do {
            TALUS_ASSIGN(Type next, with_brackets());
            add_alternative(all, std::move(next));
        } while (take("|"));
        return all;
    }

    [[nodiscard]] Error expected(std::string_view what) const {
        return Error{fmt::format("{}: {} expected at character {}", text_, what, at_ + 1)};
    }

    bool at_end() {
        skip_blanks();
        return at_ == text_.size();
    }

  private:
    void skip_blanks() {
        while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    }

    bool take(std::string_view sign) {
        skip_blanks();
        if (text_.substr(at_, sign.size()) != sign) return false;
        at_ += sign.size();
        return true;
    }

    Status need(std::string_view sign) { return take(sign) ? Status() : Status(expected(sign)); }

    std::string_view word() {
        skip_blanks();
        const std::size_t begin = at_;
        while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_')) {
            ++at_;
        }
        return text_.substr(begin, at_ - begin);
    }

    Result<double> number() {
        skip_blanks();
        const std::size_t end = std::min(text_.find("..", at_), text_.find(')', at_));
        const std::string_view digits = text_.substr(at_, end == std::string_view::npos ? end : end - at_);
        double value = 0;
        const auto [rest, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (code != std::errc() || rest != digits.data() + digits.size()) return expected("a number");
        at_ += digits.size();
        return value;
    }

    Result<Type> with_brackets() {
        TALUS_ASSIGN(Type type, single());
        for (;;) {
            if (take("[]")) {
                Type list = of_kind(Kind::list);
                list.parts.push_back(std::move(type));
                type = std::move(list);
            } else if ((type.kind == Kind::list || type.kind == Kind::number || type.kind == Kind::integer) &&
                       take("(")) {
                TALUS_ASSIGN(const double low, number());
                TALUS_TRY(need(".."));
                TALUS_ASSIGN(const double high, number());
                TALUS_TRY(need(")"));
                type.bounds = {low, high};
            } else {
                return type;
            }
        }
    }

    Result<Type> single() {
        if (take("(")) {
            TALUS_ASSIGN(Type inner, either());
            TALUS_TRY(need(")"));
            return inner;
        }
        if (take("'")) {
            const std::size_t end = text_.find('\'', at_);
            if (end == std::string_view::npos) return expected("a closing quote");
            Type text = of_kind(Kind::text, std::string(text_.substr(at_, end - at_)));
            at_ = end + 1;
            return text;
        }
        if (take("[")) return tuple();
        if (take("{")) return fields();
        const std::string name(word());
        if (name.empty()) return expected("a type");
        if (std::isdigit(static_cast<unsigned char>(name.front())) != 0) {
            return of_kind(Kind::whole, name);
        }
        if (name == "Record" || name == "Partial") return generic(name == "Record" ? Kind::record : Kind::partial);
        for (const auto& [known, kind] : words) {
            if (name == known) return of_kind(kind);
        }
        return of_kind(Kind::name, name);
    }

    Result<Type> tuple() {
        Type type = of_kind(Kind::tuple);
        do {
            TALUS_ASSIGN(Type part, either());
            type.parts.push_back(std::move(part));
        } while (take(","));
        TALUS_TRY(need("]"));
        return type;
    }

    Result<Type> fields() {
        Type type = of_kind(Kind::fields);
        do {
            Field field;
            field.key = std::string(word());
            if (field.key.empty()) return expected("a key");
            field.optional = take("?");
            TALUS_TRY(need(":"));
            TALUS_ASSIGN(field.type, either());
            type.fields.push_back(std::move(field));
        } while (take(";"));
        TALUS_TRY(need("}"));
        return type;
    }

    Result<Type> generic(Kind kind) {
        Type type = of_kind(kind);
        TALUS_TRY(need("<"));
        for (int i = 0; i < (kind == Kind::record ? 2 : 1); ++i) {
            if (i > 0) TALUS_TRY(need(","));
            TALUS_ASSIGN(Type part, either());
            type.parts.push_back(std::move(part));
        }
        TALUS_TRY(need(">"));
        return type;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

std::string joined(const std::vector<Type>& parts, std::string_view between) {
    std::string text;
    for (const Type& part : parts) text += (text.empty() ? "" : std::string(between)) + typescript_of(part);
    return text;
}

}  // namespace

Type of_kind(Kind kind, std::string name) {
    Type type;
    type.kind = kind;
    type.name = std::move(name);
    return type;
}

bool Type::may_be_null() const {
    return kind == Kind::null || (kind == Kind::either && std::any_of(parts.begin(), parts.end(), [](const Type& part) {
                                      return part.may_be_null();
                                  }));
}

Result<Type> parse_type(std::string_view text) {
    Reader reader(text);
    TALUS_ASSIGN(Type type, reader.either());
    if (!reader.at_end()) return reader.expected("the end");
    return type;
}

std::pair<std::string, std::string> split_doc(std::string_view text) {
    constexpr std::string_view between = " -- ";
    const std::size_t at = text.find(between);
    if (at == std::string_view::npos) return {std::string(text), ""};
    return {std::string(text.substr(0, at)), std::string(text.substr(at + between.size()))};
}

Result<Field> parse_field(std::string_view key, std::string_view text) {
    auto [type, doc] = split_doc(text);
    Field field;
    field.optional = key.ends_with('?');
    field.key = std::string(key.substr(0, key.size() - (field.optional ? 1 : 0)));
    field.doc = std::move(doc);
    TALUS_ASSIGN(field.type, parse_type(type));
    return field;
}

void add_names(const Type& type, std::set<std::string>& names) {
    if (type.kind == Kind::name) names.insert(type.name);
    for (const Type& part : type.parts) add_names(part, names);
    for (const Field& field : type.fields) add_names(field.type, names);
}

std::string typescript_of(const Type& type) {
    switch (type.kind) {
        case Kind::number:
        case Kind::integer:
            return "number";
        case Kind::string:
            return "string";
        case Kind::boolean:
            return "boolean";
        case Kind::null:
            return "null";
        case Kind::object:
            return "object";
        case Kind::text:
            return '"' + type.name + '"';
        case Kind::whole:
        case Kind::name:
            return type.name;
        case Kind::list: {
            const Type& item = type.parts.front();
            return (item.kind == Kind::either ? "(" + typescript_of(item) + ")" : typescript_of(item)) + "[]";
        }
        case Kind::tuple:
            return "[" + joined(type.parts, ", ") + "]";
        case Kind::record:
            return "Record<" + joined(type.parts, ", ") + ">";
        case Kind::partial:
            return "Partial<" + joined(type.parts, ", ") + ">";
        case Kind::either:
            return joined(type.parts, " | ");
        case Kind::fields:
            break;
    }
    std::string text;
    for (const Field& field : type.fields) {
        text += fmt::format("{}{}{}: {}", text.empty() ? "" : "; ", field.key, field.optional ? "?" : "",
                            typescript_of(field.type));
    }
    return "{ " + text + " }";
}

}  // namespace talus::serve
