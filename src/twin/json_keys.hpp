#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "params/fields.hpp"

/// Reads JSON from clients and files. Every error is one sentence that names key, value and allowed values.
namespace talus::twin {

/// Errors: a key that is not among the allowed ones.
[[nodiscard]] Status check_keys(const nlohmann::json& object, std::initializer_list<std::string_view> allowed);

/// With the allowed keys in two lists.
[[nodiscard]] Status check_keys(const nlohmann::json& object, const std::vector<std::string>& allowed,
                                std::initializer_list<std::string_view> also);

/// Empty where the key is absent or null. Errors: not a number, outside the range. `unit` is for the message.
[[nodiscard]] Result<std::optional<double>> read_number(const nlohmann::json& object, const std::string& key,
                                                        const params::Range& range, const std::string& unit);

/// Empty where absent or null. Errors: not a text, empty, longer than `longest` bytes. Control characters are removed.
[[nodiscard]] Result<std::optional<std::string>> read_text(const nlohmann::json& object, const std::string& key,
                                                           std::size_t longest = 80);

/// `[[x, y], ...]`; empty where absent or null. If `closed`, a repeated last point of a ring is removed. Errors: not
/// such an array, fewer than `fewest` points or more than `most`, a number that is not finite.
[[nodiscard]] Result<std::optional<std::vector<PlanPoint>>> read_points(const nlohmann::json& object,
                                                                        const std::string& key, bool closed,
                                                                        std::size_t fewest, std::size_t most);

/// `[east, north]`, m; empty where absent or null. Errors: not two finite numbers.
[[nodiscard]] Result<std::optional<PlanPoint>> read_shift(const nlohmann::json& object, const std::string& key);

/// The value as written, shortened.
[[nodiscard]] std::string shown(const nlohmann::json& value);

[[nodiscard]] nlohmann::json to_json(const std::vector<PlanPoint>& points);

/// The outer ring, then holes.
[[nodiscard]] nlohmann::json to_json(const Polygon& polygon);
[[nodiscard]] nlohmann::json polygons_json(const std::vector<Polygon>& polygons);

}  // namespace talus::twin
