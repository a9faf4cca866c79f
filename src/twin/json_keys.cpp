#include "twin/json_keys.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace talus::twin {

using nlohmann::json;

std::string shown(const json& value) {
    std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    if (text.size() > 60) text = text.substr(0, 60) + "...";
    return text;
}

Status check_keys(const json& object, const std::vector<std::string>& allowed,
                  std::initializer_list<std::string_view> also) {
    std::vector<std::string> names(also.begin(), also.end());
    names.insert(names.end(), allowed.begin(), allowed.end());
    for (const auto& [key, value] : object.items()) {
        if (std::find(names.begin(), names.end(), key) != names.end()) continue;
        return Error{fmt::format("{} = {}: no such key here; nearest known key: {}; allowed: {}", shown(json(key)),
                                 shown(value), params::nearest_word(key, names), fmt::join(names, ", "))};
    }
    return {};
}

Status check_keys(const json& object, std::initializer_list<std::string_view> allowed) {
    return check_keys(object, std::vector<std::string>(), allowed);
}

Result<std::optional<double>> read_number(const json& object, const std::string& key, const params::Range& range,
                                          const std::string& unit) {
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) return std::optional<double>();
    const double value = found->is_number() ? found->get<double>() : std::nan("");
    if (std::isfinite(value) && range.contains(value)) return std::optional(value);
    const std::string allowed = range.text();
    return Error{fmt::format("{} = {}: must be a number{}{}{}", key, shown(*found), allowed.empty() ? "" : " ", allowed,
                             unit.empty() ? "" : " (" + unit + ")")};
}

Result<std::optional<std::string>> read_text(const json& object, const std::string& key, std::size_t longest) {
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) return std::optional<std::string>();
    if (!found->is_string()) return Error{fmt::format("{} = {}: must be a text", key, shown(*found))};
    std::string text;
    for (const char c : found->get_ref<const std::string&>()) {
        if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) text += c;
    }
    if (text.empty() || text.size() > longest) {
        return Error{fmt::format("{} = {}: must be a text of 1 to {} bytes", key, shown(*found), longest)};
    }
    return std::optional(std::move(text));
}

Result<std::optional<std::vector<PlanPoint>>> read_points(const json& object, const std::string& key, bool closed,
                                                          std::size_t fewest, std::size_t most) {
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) return std::optional<std::vector<PlanPoint>>();
    const auto refused = [&] {
        return Error{
            fmt::format("{} = {}: must be {} to {} points [[x, y], ...] in metres", key, shown(*found), fewest, most)};
    };
    if (!found->is_array() || found->size() > most + 1) return refused();
    std::vector<PlanPoint> points;
    for (const json& point : *found) {
        if (!point.is_array() || point.size() != 2 || !point[0].is_number() || !point[1].is_number()) return refused();
        points.push_back({point[0].get<double>(), point[1].get<double>()});
        if (!std::isfinite(points.back().x) || !std::isfinite(points.back().y)) return refused();
    }
    if (closed && points.size() > 1 && points.front().x == points.back().x && points.front().y == points.back().y) {
        points.pop_back();
    }
    if (points.size() < fewest || points.size() > most) return refused();
    return std::optional(std::move(points));
}

Result<std::optional<PlanPoint>> read_shift(const json& object, const std::string& key) {
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) return std::optional<PlanPoint>();
    if (found->is_array() && found->size() == 2 && (*found)[0].is_number() && (*found)[1].is_number()) {
        const PlanPoint shift{(*found)[0].get<double>(), (*found)[1].get<double>()};
        if (std::isfinite(shift.x) && std::isfinite(shift.y)) return std::optional(shift);
    }
    return Error{fmt::format("{} = {}: must be [east, north] in metres", key, shown(*found))};
}

json to_json(const std::vector<PlanPoint>& points) {
    json array = json::array();
    for (const PlanPoint& p : points) array.push_back({p.x, p.y});
    return array;
}

json to_json(const Polygon& polygon) {
    json rings = json::array({to_json(polygon.outer)});
    for (const Ring& hole : polygon.holes) rings.push_back(to_json(hole));
    return rings;
}

json polygons_json(const std::vector<Polygon>& polygons) {
    json list = json::array();
    for (const Polygon& polygon : polygons) list.push_back(to_json(polygon));
    return list;
}

}  // namespace talus::twin
