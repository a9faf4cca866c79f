#include "serve/schema.hpp"

#include <algorithm>

namespace talus::test {
namespace {

using nlohmann::json;

bool has_type(const json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "null") return value.is_null();
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    return false;
}

bool has_any_type(const json& value, const json& types) {
    if (types.is_string()) return has_type(value, types.get<std::string>());
    return std::any_of(types.begin(), types.end(),
                       [&](const json& type) { return has_type(value, type.get<std::string>()); });
}

}  // namespace

std::vector<std::string> differences(const json& value, const json& schema, const json& document,
                                     const std::string& where) {
    if (schema.contains("$ref")) {
        const std::string target = schema["$ref"].get<std::string>().substr(1);
        return differences(value, document.at(json::json_pointer(target)), document, where);
    }
    if (schema.contains("oneOf")) {
        // What is wrong by the alternative that comes nearest.
        std::vector<std::string> least;
        int fitting = 0;
        for (const json& alternative : schema["oneOf"]) {
            std::vector<std::string> here = differences(value, alternative, document, where);
            fitting += here.empty() ? 1 : 0;
            if (&alternative == &schema["oneOf"].front() || here.size() < least.size()) least = std::move(here);
        }
        if (fitting > 1) return {where + " is of " + std::to_string(fitting) + " kinds at once"};
        return least;
    }
    std::vector<std::string> found;
    const auto add = [&](const std::vector<std::string>& more) { found.insert(found.end(), more.begin(), more.end()); };
    if (schema.contains("type") && !has_any_type(value, schema["type"])) {
        return {where + " is " + value.dump().substr(0, 60) + ", not " + schema["type"].dump()};
    }
    if (schema.contains("enum")) {
        const json& allowed = schema["enum"];
        if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
            found.push_back(where + " = " + value.dump() + " is not in " + allowed.dump());
        }
    }
    if (value.is_array() && schema.contains("items")) {
        if (value.size() < schema.value("minItems", std::size_t{0}) ||
            value.size() > schema.value("maxItems", value.size())) {
            found.push_back(where + " has " + std::to_string(value.size()) + " items");
        }
        for (std::size_t i = 0; i < value.size(); ++i) {
            add(differences(value[i], schema["items"], document, where + "[" + std::to_string(i) + "]"));
        }
    }
    if (!value.is_object()) return found;
    for (const json& key : schema.value("required", json::array())) {
        if (!value.contains(key.get<std::string>()))
            found.push_back(where + "." + key.get<std::string>() + " is missing");
    }
    const json properties = schema.value("properties", json::object());
    for (const auto& [key, item] : value.items()) {
        const std::string place = where + "." + key;
        if (properties.contains(key)) {
            add(differences(item, properties[key], document, place));
        } else if (schema.contains("additionalProperties")) {
            add(differences(item, schema["additionalProperties"], document, place));
        } else if (!properties.empty()) {
            found.push_back(place + " is not described");
        }
    }
    return found;
}

}  // namespace talus::test
