#include "serve/openapi.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <nlohmann/json.hpp>

#include "params/fields.hpp"
#include "serve/protocol.hpp"

namespace talus::serve {
namespace {

using Schema = nlohmann::ordered_json;  // its keys stay in order
using Kind = Type::Kind;

Schema reference(const std::string& kind, const std::string& name) {
    return {{"$ref", "#/components/" + kind + "/" + name}};
}

/// Of a value that may be null as well.
Schema or_null(Schema schema) {
    if (!schema.contains("type")) return {{"oneOf", Schema::array({std::move(schema), {{"type", "null"}}})}};
    if (!schema["type"].is_array()) schema["type"] = Schema::array({schema["type"]});
    schema["type"].push_back("null");
    if (schema.contains("enum")) schema["enum"].push_back(nullptr);
    return schema;
}

class SchemaWriter {
  public:
    explicit SchemaWriter(const Protocol& all) : all_(all) {}

    [[nodiscard]] Schema of(const Type& type) const {
        switch (type.kind) {
            case Kind::number:
                return bounded({{"type", "number"}}, type, "minimum", "maximum");
            case Kind::integer:
                return bounded({{"type", "integer"}}, type, "minimum", "maximum");
            case Kind::string:
                return {{"type", "string"}};
            case Kind::boolean:
                return {{"type", "boolean"}};
            case Kind::null:
                return {{"type", "null"}};
            case Kind::object:
                return {{"type", "object"}};
            case Kind::text:
                return {{"type", "string"}, {"enum", Schema::array({type.name})}};
            case Kind::whole:
                return {{"type", "integer"}, {"enum", Schema::array({std::stoi(type.name)})}};
            case Kind::name:
                return reference("schemas", type.name);
            case Kind::list:
                return bounded({{"type", "array"}, {"items", of(type.parts.front())}}, type, "minItems", "maxItems");
            case Kind::tuple:
                return {{"type", "array"},
                        {"items", of(type.parts.front())},
                        {"minItems", type.parts.size()},
                        {"maxItems", type.parts.size()}};
            case Kind::record:
                return record(type);
            case Kind::partial:
                return partial(type.parts.front());
            case Kind::fields:
                return object(type.fields);
            case Kind::either:
                break;
        }
        return either(type);
    }

    /// With the sentence of a field.
    [[nodiscard]] Schema of(const Field& field) const {
        Schema schema = of(field.type);
        if (!field.doc.empty()) schema["description"] = field.doc;
        return schema;
    }

    [[nodiscard]] Schema of(const TypeDescription& type) const {
        Schema schema = type.is ? of(*type.is) : object(all_.fields_of(type));
        add_section(type.section, Values::all, schema);
        add_section(type.input, Values::required, schema);
        if (!type.doc.empty()) schema["description"] = type.doc;
        return schema;
    }

    [[nodiscard]] Schema of(const UnionDescription& all) const {
        Schema schema = {{"description", all.doc}, {"oneOf", Schema::array()}};
        for (const Variant& variant : all.variants) {
            Schema one = {{"type", "object"},
                          {"description", variant.when},
                          {"required", Schema::array({all.tag})},
                          {"properties", {{all.tag, {{"type", "string"}, {"enum", variant.names}}}}}};
            add_fields(all_.fields_of(variant), one);
            add_section(variant.partial, Values::none, one);
            schema["oneOf"].push_back(std::move(one));
        }
        return schema;
    }

  private:
    enum class Values { all, required, none };  // that must be there

    static Schema bounded(Schema schema, const Type& type, const char* lowest, const char* highest) {
        if (!type.bounds) return schema;
        for (const auto& [key, bound] : {std::pair(lowest, type.bounds->first), {highest, type.bounds->second}}) {
            schema[key] = bound == std::round(bound) ? Schema(std::llround(bound)) : Schema(bound);
        }
        return schema;
    }

    [[nodiscard]] Schema record(const Type& type) const {
        Schema schema = {{"type", "object"}};
        if (type.parts[0].kind != Kind::string) schema["propertyNames"] = of(type.parts[0]);
        schema["additionalProperties"] = of(type.parts[1]);
        return schema;
    }

    [[nodiscard]] Schema partial(const Type& whole) const {
        Schema schema = whole.kind == Kind::name ? of(*all_.find(whole.name)) : of(whole);
        schema.erase("required");
        return schema;
    }

    [[nodiscard]] Schema either(const Type& type) const {
        std::vector<const Type*> others;
        for (const Type& part : type.parts) {
            if (part.kind != Kind::null) others.push_back(&part);
        }
        Schema schema = of(*others.front());
        const auto all_are = [&](auto matches) {
            return std::all_of(others.begin(), others.end(), [&](const Type* part) { return matches(part->kind); });
        };
        if (all_are([](Kind kind) { return kind == Kind::text; })) {
            for (std::size_t i = 1; i < others.size(); ++i) schema["enum"].push_back(others[i]->name);
        } else if (others.size() > 1 && all_are([](Kind kind) { return kind <= Kind::boolean; })) {
            schema["type"] = Schema::array({schema["type"]});
            for (std::size_t i = 1; i < others.size(); ++i) schema["type"].push_back(of(*others[i])["type"]);
        } else if (others.size() > 1) {
            schema = {{"oneOf", Schema::array()}};
            for (const Type* part : others) schema["oneOf"].push_back(of(*part));
        }
        return type.may_be_null() ? or_null(std::move(schema)) : schema;
    }

    [[nodiscard]] Schema object(const std::vector<Field>& fields) const {
        Schema schema = {{"type", "object"}};
        add_fields(fields, schema);
        return schema;
    }

    void add_fields(const std::vector<Field>& fields, Schema& schema) const {
        for (const Field& field : fields) {
            if (!field.optional) schema["required"].push_back(field.key);
        }
        for (const Field& field : fields) schema["properties"][field.key] = of(field);
    }

    /// The live values of a section of the scene file; what is there already stays.
    static void add_section(const std::string& section, Values needed, Schema& schema) {
        if (section.empty()) return;
        for (const params::Parameter& parameter : params::live_section(section).parameters) {
            if (parameter.live.empty()) continue;
            const bool must = needed == Values::all || (needed == Values::required && parameter.required);
            Schema& required = schema["required"];
            if (must && std::find(required.begin(), required.end(), parameter.live) == required.end()) {
                required.push_back(parameter.live);
            }
            if (required.is_null()) schema.erase("required");
            Schema& properties = schema["properties"];
            if (!properties.contains(parameter.live)) properties[parameter.live] = of_parameter(parameter);
        }
    }

    static Schema of_parameter(const params::Parameter& parameter) {
        Schema schema = {{"type", parameter.kind == params::ParameterKind::choice ? "string" : "number"}};
        if (!parameter.choices.empty()) schema["enum"] = parameter.choices;
        if (!parameter.absent.empty()) schema = or_null(std::move(schema));
        const params::Range& range = parameter.range;
        if (std::isfinite(range.low)) schema[range.low_included ? "minimum" : "exclusiveMinimum"] = range.low;
        if (std::isfinite(range.high)) schema[range.high_included ? "maximum" : "exclusiveMaximum"] = range.high;
        schema["description"] = parameter.help + (parameter.absent.empty() ? "" : " null: " + parameter.absent + ".");
        return schema;
    }

    const Protocol& all_;
};

class DocumentWriter {
  public:
    explicit DocumentWriter(const Protocol& all) : all_(all), schemas_(all) {}

    [[nodiscard]] Schema document() const {
        Schema paths = Schema::object();
        for (const RouteDescription& route : all_.routes) {
            Schema& item = paths[route.path];
            std::string method = route.method;
            std::transform(method.begin(), method.end(), method.begin(),
                           [](unsigned char c) { return std::tolower(c); });
            item[method] = operation(route);
            for (const Field& field : route.path_parameters) {
                if (item["parameters"].size() < route.path_parameters.size()) {
                    item["parameters"].push_back(parameter("path", field));
                }
            }
        }
        return {{"openapi", "3.1.0"},
                {"info", Schema::parse(all_.info)},
                {"security", Schema::array({{{"token", Schema::array()}}})},
                {"paths", paths},
                {"components", components()}};
    }

  private:
    [[nodiscard]] Schema components() const {
        Schema responses = Schema::object(), schemas = Schema::object();
        for (const auto& [status, doc] : all_.errors) {
            const Schema refusal = {{"schema", reference("schemas", "Refusal")}};
            responses[status] = {{"description", doc}, {"content", {{"application/json", refusal}}}};
        }
        for (const TypeDescription& type : all_.types) schemas[type.name] = schemas_.of(type);
        for (const UnionDescription& one : all_.unions) schemas[one.name] = schemas_.of(one);
        const Schema token = {{"type", "http"}, {"scheme", "bearer"}, {"description", all_.token}};
        return {{"securitySchemes", {{"token", token}}}, {"responses", responses}, {"schemas", schemas}};
    }

    [[nodiscard]] Schema operation(const RouteDescription& route) const {
        Schema operation = {{"summary", route.does}};
        if (!route.more.empty()) operation["description"] = route.more;
        operation["x-caller"] = caller_name(route.who);
        Schema answer = {{"description", route.answer_doc}, {"content", content(route.answer)}};
        operation["responses"][std::to_string(route.status)] = std::move(answer);
        std::vector<std::string> errors = route.errors;
        if (route.who != Caller::anyone) errors.insert(errors.end(), {"401", "403"});
        std::sort(errors.begin(), errors.end());
        for (const std::string& status : errors) operation["responses"][status] = reference("responses", status);
        for (const Field& field : route.query) operation["parameters"].push_back(parameter("query", field));
        if (route.who == Caller::control || route.who == Caller::person) {
            const Field header{
                .key = "Talus-Person", .optional = true, .type = of_kind(Kind::string), .doc = all_.person};
            operation["parameters"].push_back(parameter("header", header));
        }
        if (route.body) operation["requestBody"] = {{"required", true}, {"content", content(*route.body)}};
        if (route.who == Caller::anyone) operation["security"] = Schema::array();
        return operation;
    }

    [[nodiscard]] Schema content(const Content& content) const {
        Schema types = Schema::object();
        for (const std::string& media : content.media) types[media] = Schema::object();
        if (content.media.empty()) types["application/json"] = {{"schema", schemas_.of(content.type)}};
        return types;
    }

    [[nodiscard]] Schema parameter(const char* in, const Field& field) const {
        Schema parameter = {{"name", field.key}, {"in", in}, {"required", !field.optional}};
        if (!field.doc.empty()) parameter["description"] = field.doc;
        parameter["schema"] = schemas_.of(field.type);
        return parameter;
    }

    const Protocol& all_;
    SchemaWriter schemas_;
};

}  // namespace

const std::string& openapi_document() {
    static const std::string document = DocumentWriter(protocol()).document().dump(2) + "\n";
    return document;
}

}  // namespace talus::serve
