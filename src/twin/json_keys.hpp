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

/// Reading JSON that comes from outside. Every error is one sentence that names key, value and what is allowed.
namespace talus::twin {

/// Errors: a key that is not among the allowed ones.
[[nodiscard]] Status check_keys(const nlohmann::json& object, std::initializer_list<std::string_view> allowed);

/// Those that are allowed are in two lists.
[[nodiscard]] Status check_keys(const nlohmann::json& object, const std::vector<std::string>& allowed,
                                std::initializer_list<std::string_view> also);

/// Nothing where the key is absent or null. Errors: no number, outside the range. `unit` is for the message.
[[nodiscard]] Result<std::optional<double>> read_number(const nlohmann::json& object, const std::string& key,
                                                        const Range& range, const std::string& unit);

/// Nothing where absent or null. Errors: no text, empty, longer than `longest` bytes; control characters are left out.
[[nodiscard]] Result<std::optional<std::string>> read_text(const nlohmann::json& object, const std::string& key,
                                                           std::size_t longest = 80);

/// `[[x, y], ...]`; nothing where absent or null. A repeated last point of a ring may be given and is left out if
/// `closed`. Errors: not such an array, fewer than `fewest` points or more than `most`, a number that is not finite.
[[nodiscard]] Result<std::optional<std::vector<PlanPoint>>> read_points(const nlohmann::json& object,
                                                                        const std::string& key, bool closed,
                                                                        std::size_t fewest, std::size_t most);

/// `[east, north]`, m; nothing where absent or null. Errors: not two finite numbers.
[[nodiscard]] Result<std::optional<PlanPoint>> read_shift(const nlohmann::json& object, const std::string& key);

/// The value as written, shortened.
[[nodiscard]] std::string shown(const nlohmann::json& value);

[[nodiscard]] nlohmann::json to_json(const std::vector<PlanPoint>& points);

/// The outer ring, then holes.
[[nodiscard]] nlohmann::json to_json(const Polygon& polygon);
[[nodiscard]] nlohmann::json polygons_json(const std::vector<Polygon>& polygons);

}  // namespace talus::twin
