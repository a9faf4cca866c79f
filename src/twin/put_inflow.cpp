#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/hydrograph.hpp"
#include "twin/hydrograph_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

PlanPoint shifted(const PlanPoint& p, const PlanPoint& by) {
    return {p.x + by.x, p.y + by.y};
}

/// Where it comes in: across a line or over an area.
Status read_place(const json& action, const Terrain& terrain, bool exists, Inflow& inflow) {
    TALUS_ASSIGN(auto line, read_points(action, "line", false, 2, 2));
    TALUS_ASSIGN(auto polygon, read_points(action, "polygon", true, 3, most_points));
    TALUS_ASSIGN(const auto by, read_move(action, line ? "line" : "polygon", "inflow", exists));
    if (line && polygon) return Error{"polygon: cannot go with line; send one of them"};
    if (!exists && !line && !polygon) return missing("line or polygon", "inflow");
    if (line) {
        inflow.from = (*line)[0];
        inflow.to = (*line)[1];
        inflow.area.clear();
        inflow.direction.reset();
    }
    if (polygon) {
        TALUS_TRY(check_ring(terrain, *polygon, "polygon", true));
        inflow.area = {{std::move(*polygon), {}}};
        inflow.from = inflow.to = {};
    }
    if (by && inflow.over_area()) {
        for (Polygon& part : inflow.area) {
            part = moved(std::move(part), *by);
            TALUS_TRY(check_ground(terrain, part, "move_m", true));
        }
    } else if (by) {
        inflow.from = shifted(inflow.from, *by);
        inflow.to = shifted(inflow.to, *by);
    }
    return inflow.over_area() ? Status() : check_line(inflow, terrain, by ? "move_m" : "line");
}

Status read_direction(const json& action, Inflow& inflow) {
    if (!action.contains("direction_deg")) return {};
    TALUS_ASSIGN(const auto direction,
                 read_number(action, "direction_deg", find_section("inflow")->find("direction_deg")->range, "deg"));
    if (direction && !inflow.over_area()) {
        return Error{"direction_deg: is refused across a line, which has a direction of its own"};
    }
    inflow.direction.reset();
    if (direction) inflow.direction = *direction * std::numbers::pi / 180;
    return {};
}

/// What all that brings debris would make, with this inflow in place of `existing`.
double particles_in_all(const Setup& setup, const InflowSetup* existing, const Inflow& inflow, double spacing) {
    double volume = inflow.volume();
    for (const InflowSetup& other : setup.inflows) {
        if (&other != existing) volume += other.body->volume();
    }
    for (const ReleaseSetup& release : setup.releases) volume += release.body->volume;
    return volume / std::pow(spacing, 3);
}

}  // namespace

Result<Inflow> read_inflow(const json& action, const ActionContext& context, const Setup& setup,
                           const InflowSetup* existing, const std::string& name) {
    TALUS_TRY(check_keys(action, {"action", "id", "name", "line", "polygon", "move_m", "direction_deg", "hydrograph"}));
    Inflow inflow;
    if (existing != nullptr) inflow = *existing->body;
    inflow.name = name;
    TALUS_TRY(read_place(action, context.scene.terrain, existing != nullptr, inflow));
    TALUS_TRY(read_direction(action, inflow));
    if (action.contains("hydrograph")) {
        TALUS_ASSIGN(inflow.hydrograph, read_hydrograph_rows(action["hydrograph"], inflow.over_area()));
    } else if (existing == nullptr) {
        return missing("hydrograph", "inflow");
    } else {
        // What came over an area may be too still for a line.
        TALUS_TRY(read_hydrograph_rows(to_json(inflow.hydrograph), inflow.over_area()));
    }
    if (!(inflow.volume() > 0)) return Error{"hydrograph: brings no debris at all"};
    const SolverSpec& solver = context.scene.spec.solver;
    if (inflow.hydrograph.front().time >= solver.end_time) {
        return Error{
            fmt::format("hydrograph[0]: time_s = {:.6g} is refused; it must be below solver.end_time_s = "
                        "{:.6g}",
                        inflow.hydrograph.front().time, solver.end_time)};
    }
    const double particles = particles_in_all(setup, existing, inflow, context.particle_spacing);
    if (particles > solver.particle_limit) {
        return Error{
            fmt::format("hydrograph: {:.4g} m3 would make {:.0f} particles in all; solver.particle_limit "
                        "must be at least that, and is {}",
                        inflow.volume(), particles, solver.particle_limit)};
    }
    return inflow;
}

}  // namespace talus::twin
