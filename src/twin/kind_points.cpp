// Gauges and notes: what is at one place.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/gauges_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/outline.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

/// x_m and y_m of a file.
Result<PlanPoint> read_place(const json& file) {
    const auto x = read_number(file, "x_m", {}, "m"), y = read_number(file, "y_m", {}, "m");
    if (!x || !*x) return not_of_a_setup("x_m", file);
    if (!y || !*y) return not_of_a_setup("y_m", file);
    return PlanPoint{**x, **y};
}

/// x_m and y_m of an action; empty where neither is given. Errors: one of them alone, beside the terrain.
Result<std::optional<PlanPoint>> put_place(const json& given, const ActionContext& context) {
    TALUS_ASSIGN(const auto x, read_number(given, "x_m", {}, "m"));
    TALUS_ASSIGN(const auto y, read_number(given, "y_m", {}, "m"));
    if (!x && !y) return std::optional<PlanPoint>();
    if (!x || !y) return Error{fmt::format("{}: missing; a place is x_m and y_m", x ? "y_m" : "x_m")};
    const PlanPoint at = {*x, *y};
    if (std::isnan(context.scene.terrain.elevation_at(at))) {
        return Error{fmt::format("x_m = {:.10g}, y_m = {:.10g}: not on the terrain", at.x, at.y)};
    }
    return std::optional(at);
}

}  // namespace

json Gauges::body(const Body& gauge) {
    return gauge_place(gauge);
}

Status Gauges::read(const json& file, const scene::Scene&, Body& gauge) {
    TALUS_TRY(check_keys(file, {"name", "x_m", "y_m", "chainage_m"}));
    TALUS_ASSIGN(gauge.name, read_name(file));
    TALUS_ASSIGN(gauge.at, read_place(file));
    TALUS_ASSIGN(const auto chainage, read_number(file, "chainage_m", {}, "m"));
    gauge.chainage = chainage.value_or(std::numeric_limits<double>::quiet_NaN());
    return {};
}

/// At a place or at a chainage.
Status Gauges::put(const Put<Entry>& put, Body& gauge) {
    TALUS_TRY(check_keys(put.given, {"name", "x_m", "y_m", "chainage_m"}));
    gauge.name = put.name;
    const std::vector<Entry>& all = put.setup.gauges;
    const bool taken = std::any_of(all.begin(), all.end(), [&](const Entry& other) {
        return &other != put.existing && other.body->name == put.name;
    });
    if (taken) return Error{fmt::format("name = {}: another gauge has this name", shown(json(put.name)))};
    TALUS_ASSIGN(const auto place, put_place(put.given, put.context));
    TALUS_ASSIGN(const auto chainage, read_number(put.given, "chainage_m", {}, "m"));
    if (place && chainage) return Error{"chainage_m: only one of chainage_m and x_m, y_m can be given"};
    if (put.existing == nullptr && !place && !chainage) {
        return Error{"x_m: missing; a new gauge needs x_m and y_m, or chainage_m"};
    }
    if (place) {
        gauge.at = *place;
        gauge.chainage = std::numeric_limits<double>::quiet_NaN();
    }
    if (chainage) {
        const terrain::FlowPath& path = put.context.scene.flow_path;
        if (path.empty()) return Error{"chainage_m: the scene has no flow path; give x_m and y_m"};
        if (!(*chainage >= 0 && *chainage <= path.length())) {
            return Error{fmt::format("chainage_m = {:.6g}: must be from 0 to {:.1f} m, the length of the flow path",
                                     *chainage, path.length())};
        }
        gauge.chainage = *chainage;
        gauge.at = path.point_at(*chainage);
    }
    return {};
}

std::string Gauges::told(const Entry& gauge, const Put<Entry>& put) {
    const std::string where = std::isnan(gauge.body->chainage)
                                  ? fmt::format("E {:.1f}, N {:.1f} m", gauge.body->at.x, gauge.body->at.y)
                                  : fmt::format("chainage {:.1f} m", gauge.body->chainage);
    return fmt::format(" {}: {}{}", put.done("added"), where, put.from_restart());
}

json Notes::body(const Body& note) {
    return {{"name", note.name}, {"x_m", note.at.x}, {"y_m", note.at.y}};
}

Status Notes::read(const json& file, const scene::Scene&, Body& note) {
    TALUS_TRY(check_keys(file, {"name", "x_m", "y_m"}));
    TALUS_ASSIGN(note.name, read_name(file));
    TALUS_ASSIGN(note.at, read_place(file));
    return {};
}

Status Notes::put(const Put<Entry>& put, Body& note) {
    TALUS_TRY(check_keys(put.given, {"name", "x_m", "y_m"}));
    const bool anew = put.existing == nullptr;
    if (anew && !put.given.contains("name")) return Error{"name: missing; it is what the note says"};
    TALUS_ASSIGN(const auto place, put_place(put.given, put.context));
    if (anew && !place) return Error{"x_m: missing; a new note needs x_m and y_m"};
    note = {put.name, place.value_or(note.at)};
    return {};
}

}  // namespace talus::twin
