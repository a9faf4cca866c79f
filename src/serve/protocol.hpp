#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.hpp"
#include "serve/type_notation.hpp"
#include "session/role.hpp"

/// The one description of the messages, protocol.json. From it are made the OpenAPI document that the server answers
/// with, the types of the page (web/src/protocol) and the tables of docs/protocol.md.
namespace talus::serve {

/// Who may call a route. control: a controller's token, and nobody else has control; person: that of the header.
enum class Caller { anyone, trigger, viewer, controller, control, person };

[[nodiscard]] std::string_view caller_name(Caller caller);
/// What the token of such a caller must entitle to.
[[nodiscard]] session::Role role_of(Caller caller);

/// A type in the notation, or media types.
struct Content {
    Type type;
    std::vector<std::string> media;  ///< none: JSON of that type
};

struct RouteDescription {
    std::string group;         ///< "session", "start"
    std::string method, path;  ///< "GET", "/api/scenarios/{s}/state"
    std::string does, more;    ///< a sentence, and what else there is to say; the second may be empty
    Caller who = Caller::viewer;
    std::vector<Field> path_parameters{}, query{};
    std::optional<Content> body{};
    Content answer{};
    std::string answer_doc{};
    int status = 200;
    std::vector<std::string> errors{};  ///< besides 401 and 403, which all have that need a token
};

/// An object with fields, or where it has `is` another name for that type.
struct TypeDescription {
    std::string group;  ///< the module of the page: "messages", "start"
    std::string name, doc;
    std::optional<Type> is{};
    std::string values{};   ///< the page's list of an enumeration's values; empty: none
    std::string extends{};  ///< it has the fields of this one as well
    std::string section{};  ///< of the scene file, whose live values it has
    std::string input{};    ///< likewise, as somebody gives them: what is not required can be left out
    std::vector<Field> fields{};
};

/// A message of several with a key that says which it is.
struct Variant {
    std::vector<std::string> names;
    std::string when;
    std::string extends{};
    std::string partial{};  ///< section of the scene file whose live values it may have
    std::vector<Field> fields{};
};

struct UnionDescription {
    std::string name, tag, doc;  ///< tag: the key that says which
    std::vector<Variant> variants;
};

struct Protocol {
    std::string info;                                         ///< JSON, of the OpenAPI document
    std::string token, person;                                ///< what a token and a person's header are
    std::vector<std::pair<std::string, std::string>> errors;  ///< by status
    std::vector<RouteDescription> routes;
    std::vector<TypeDescription> types;
    std::vector<UnionDescription> unions;

    /// nullptr: there is none.
    [[nodiscard]] const TypeDescription* find(std::string_view name) const;
    /// With those of what it extends.
    [[nodiscard]] std::vector<Field> fields_of(const TypeDescription& type) const;
    [[nodiscard]] std::vector<Field> fields_of(const Variant& variant) const;
};

/// Errors: not the notation, a key that is not known, a type that is used and not described.
[[nodiscard]] Result<Protocol> read_protocol(std::string_view text);

/// protocol.json.
[[nodiscard]] const Protocol& protocol();

}  // namespace talus::serve
