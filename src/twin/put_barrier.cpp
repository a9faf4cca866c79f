#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "terrain/barrier.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t most_openings = 100;

bool is_null(const json& action, const char* key) {
    return action.contains(key) && action[key].is_null();
}

Result<BarrierOpening> read_opening(const json& entry, double spacing) {
    const json& object = entry.is_object() ? entry : json::object();
    if (Status s = check_keys(object, {"position_m", "width_m", "sill_height_m"}); !s) return s.error();
    const auto position = read_number(object, "position_m", {.low = 0}, "m");
    if (!position) return position.error();
    // As in a scene: nothing would get through a narrower one.
    const auto width = read_number(object, "width_m", {.low = std::ceil(2000 * spacing) / 1000}, "m");
    if (!width) return width.error();
    const auto sill = read_number(object, "sill_height_m", {.low = 0}, "m");
    if (!sill) return sill.error();
    if (!*position || !*width) {
        return Error{fmt::format("{}: must have position_m and width_m; sill_height_m may be left out", shown(entry))};
    }
    return BarrierOpening{**position, **width, sill->value_or(0)};
}

Status read_openings(const json& action, double spacing, BarrierShape& shape) {
    if (!action.contains("openings") || action["openings"].is_null()) return {};
    const json& list = action["openings"];
    if (!list.is_array() || list.size() > most_openings) {
        return Error{fmt::format("openings = {}: must be a list of at most {}", shown(list), most_openings)};
    }
    shape.openings.clear();
    for (std::size_t k = 0; k < list.size(); ++k) {
        const auto opening = read_opening(list[k], spacing);
        if (!opening) return Error{fmt::format("openings[{}]: {}", k, opening.error().message)};
        shape.openings.push_back(*opening);
    }
    return {};
}

}  // namespace

Result<Building> read_barrier(const json& action, const ActionContext& context, const Building* existing,
                              const std::string& name) {
    if (Status s = check_keys(action, {"action", "id", "name", "line", "height_m", "thickness_m", "passing_share",
                                       "openings", "resistance_Npm", "resistance_Pa"});
        !s) {
        return s.error();
    }
    auto line = read_points(action, "line", false, 2, most_points);
    if (!line) return line.error();
    const auto height = read_number(action, "height_m", {.low = 0, .high = 200, .low_included = false}, "m");
    if (!height) return height.error();
    // Thinner than a particle, debris on both sides would feel each other through it.
    const double thinnest = std::ceil(100 * context.particle_spacing / 2) / 100;
    const auto thickness = read_number(action, "thickness_m", {.low = thinnest, .high = 100}, "m");
    if (!thickness) return thickness.error();
    const auto passing = read_number(action, "passing_share", {.low = 0, .high = 1, .high_included = false}, "");
    if (!passing) return passing.error();
    constexpr Range positive{.low = 0, .low_included = false};
    const auto force = read_number(action, "resistance_Npm", positive, "N/m");
    if (!force) return force.error();
    const auto pressure = read_number(action, "resistance_Pa", positive, "Pa");
    if (!pressure) return pressure.error();
    BarrierShape shape;
    Resistance resistance;
    if (existing != nullptr) {
        shape = *existing->barrier;
        resistance = existing->resistance;
    } else {
        if (!*line) return missing("line", "barrier");
        if (!*height) return missing("height_m", "barrier");
        if (!*thickness) return missing("thickness_m", "barrier");
    }
    if (*line) shape.line = std::move(**line);
    if (*height) shape.crest_elevation.reset();
    shape.height = height->value_or(shape.height);
    shape.thickness = thickness->value_or(shape.thickness);
    if (*passing || is_null(action, "passing_share")) shape.passing_share = *passing;
    if (Status s = read_openings(action, context.particle_spacing, shape); !s) return s.error();
    Result<Building> body = make_barrier(context.scene.terrain, name, shape);
    if (!body) return body.error();
    constexpr double whatever_happens = std::numeric_limits<double>::infinity();
    const auto resists = [&](const char* key, const std::optional<double>& given, double before) {
        return is_null(action, key) ? whatever_happens : given.value_or(before);
    };
    body->resistance.force_per_metre = resists("resistance_Npm", *force, resistance.force_per_metre);
    body->resistance.pressure = resists("resistance_Pa", *pressure, resistance.pressure);
    return body;
}

}  // namespace talus::twin
