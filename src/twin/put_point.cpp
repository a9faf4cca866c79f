// Gauges and notes: what is put at one place.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/put.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

/// x_m and y_m; empty where neither is given. Errors: one of them alone, beside the terrain.
Result<std::optional<PlanPoint>> read_place(const json& action, const ActionContext& context) {
    TALUS_ASSIGN(const auto x, read_number(action, "x_m", {}, "m"));
    TALUS_ASSIGN(const auto y, read_number(action, "y_m", {}, "m"));
    if (!x && !y) return std::optional<PlanPoint>();
    if (!x || !y) return Error{fmt::format("{}: missing; a place is x_m and y_m", x ? "y_m" : "x_m")};
    const PlanPoint at = {*x, *y};
    if (std::isnan(context.scene.terrain.elevation_at(at))) {
        return Error{fmt::format("x_m = {:.10g}, y_m = {:.10g}: not on the terrain", at.x, at.y)};
    }
    return std::optional(at);
}

}  // namespace

Result<terrain::Gauge> read_gauge_place(const json& action, const ActionContext& context, const Setup& setup,
                                        const GaugeSetup* existing, const std::string& name) {
    TALUS_TRY(check_keys(action, {"action", "id", "name", "x_m", "y_m", "chainage_m"}));
    terrain::Gauge gauge;
    if (existing != nullptr) gauge = *existing->body;
    gauge.name = name;
    const bool taken = std::any_of(setup.gauges.begin(), setup.gauges.end(), [&](const GaugeSetup& other) {
        return &other != existing && other.body->name == name;
    });
    if (taken) return Error{fmt::format("name = {}: another gauge has this name", shown(json(name)))};
    TALUS_ASSIGN(const auto place, read_place(action, context));
    TALUS_ASSIGN(const auto chainage, read_number(action, "chainage_m", {}, "m"));
    if (place && chainage) return Error{"chainage_m: only one of chainage_m and x_m, y_m can be given"};
    if (existing == nullptr && !place && !chainage) {
        return Error{"x_m: missing; a new gauge needs x_m and y_m, or chainage_m"};
    }
    if (place) {
        gauge.at = *place;
        gauge.chainage = std::numeric_limits<double>::quiet_NaN();
    }
    if (chainage) {
        const terrain::FlowPath& path = context.scene.flow_path;
        if (path.empty()) return Error{"chainage_m: the scene has no flow path; give x_m and y_m"};
        if (!(*chainage >= 0 && *chainage <= path.length())) {
            return Error{fmt::format("chainage_m = {:.6g}: must be from 0 to {:.1f} m, the length of the flow path",
                                     *chainage, path.length())};
        }
        gauge.chainage = *chainage;
        gauge.at = path.point_at(*chainage);
    }
    return gauge;
}

Result<Note> read_note(const json& action, const ActionContext& context, const Note* existing,
                       const std::string& name) {
    TALUS_TRY(check_keys(action, {"action", "id", "name", "x_m", "y_m"}));
    if (existing == nullptr && !action.contains("name")) return Error{"name: missing; it is what the note says"};
    TALUS_ASSIGN(const auto place, read_place(action, context));
    if (existing == nullptr && !place) return Error{"x_m: missing; a new note needs x_m and y_m"};
    return Note{name, place.value_or(existing != nullptr ? existing->at : PlanPoint{})};
}

}  // namespace talus::twin
