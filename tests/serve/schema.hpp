#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace talus::test {

/// What of `value` is not as `schema` has it, a line each: type, enum, required, properties, items and
/// additionalProperties of JSON Schema, references within `document`, and, stricter than JSON Schema, keys that no
/// property describes.
std::vector<std::string> differences(const nlohmann::json& value, const nlohmann::json& schema,
                                     const nlohmann::json& document, const std::string& where = "");

}  // namespace talus::test
