#include "serve/openapi.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "openapi_file.hpp"
#include "params/fields.hpp"

namespace talus::serve {
namespace {

using Schema = nlohmann::ordered_json;  // its keys stay in order

Schema schema_of(const params::Parameter& parameter) {
    Schema schema = {{"type", parameter.kind == params::ParameterKind::choice ? "string" : "number"}};
    if (!parameter.absent.empty()) schema["type"] = {schema["type"], "null"};
    if (!parameter.choices.empty()) schema["enum"] = parameter.choices;
    const params::Range& range = parameter.range;
    if (std::isfinite(range.low)) schema[range.low_included ? "minimum" : "exclusiveMinimum"] = range.low;
    if (std::isfinite(range.high)) schema[range.high_included ? "maximum" : "exclusiveMaximum"] = range.high;
    schema["description"] = parameter.help + (parameter.absent.empty() ? "" : " null: " + parameter.absent + ".");
    return schema;
}

/// Calls f(parameter) for the live parameters of the section.
template <class F>
void for_each_live(const std::string& section, const F& f) {
    for (const params::Parameter& parameter : params::live_section(section).parameters) {
        if (!parameter.live.empty()) f(parameter);
    }
}

/// A key that several actions have is described for each of them.
void add_action(const std::string& action, const std::string& section, Schema& properties) {
    for_each_live(section, [&](const params::Parameter& parameter) {
        Schema schema = schema_of(parameter);
        schema["description"] = action + ": " + schema["description"].get<std::string>();
        if (properties.contains(parameter.live)) {
            const Schema& other = properties[parameter.live];
            const bool nullable = other["type"].is_array() || schema["type"].is_array();
            schema = {{"type", nullable ? Schema({"number", "null"}) : Schema("number")},
                      {"description",
                       other["description"].get<std::string>() + " " + schema["description"].get<std::string>()}};
        }
        properties[parameter.live] = std::move(schema);
    });
}

void fill_in(Schema& node) {
    if (node.is_structured()) {
        for (Schema& child : node) fill_in(child);
    }
    if (!node.is_object()) return;
    for (const char* kind : {"x-section", "x-section-input"}) {
        if (!node.contains(kind)) continue;
        const bool output = std::string(kind) == "x-section";
        for_each_live(node[kind].get<std::string>(), [&](const params::Parameter& parameter) {
            if (output || parameter.required) node["required"].push_back(parameter.live);
            if (!node["properties"].contains(parameter.live)) {
                node["properties"][parameter.live] = schema_of(parameter);
            }
        });
        node.erase(kind);
    }
    if (node.contains("x-actions")) {
        const Schema actions = node["x-actions"];
        for (const auto& [action, section] : actions.items()) add_action(action, section, node["properties"]);
        node.erase("x-actions");
    }
}

}  // namespace

const std::string& openapi_document() {
    static const std::string document = [] {
        Schema all = Schema::parse(openapi_file::openapi_json);
        fill_in(all);
        return all.dump(2) + "\n";
    }();
    return document;
}

}  // namespace talus::serve
