#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "params/fields.hpp"
#include "params/spec.hpp"

/// Keys of a zone or a bed in JSON are those of the scene file, with the same ranges.
namespace talus::twin {

/// The keys by which people change a zone or a bed in a running session.
[[nodiscard]] std::span<const char* const> zone_keys();
[[nodiscard]] std::span<const char* const> bed_keys();

/// The values of those keys; null: not given.
[[nodiscard]] nlohmann::json values_json(const ZoneSpec& spec);
[[nodiscard]] nlohmann::json values_json(const BedSpec& spec);

/// Takes what the object gives; a null takes a value away that may be left out. Errors name key, value and what is
/// allowed.
[[nodiscard]] Status read_values(const nlohmann::json& object, ZoneSpec& spec);
[[nodiscard]] Status read_values(const nlohmann::json& object, BedSpec& spec);

}  // namespace talus::twin
