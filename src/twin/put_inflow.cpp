#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

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
    auto line = read_points(action, "line", false, 2, 2);
    if (!line) return line.error();
    auto polygon = read_points(action, "polygon", true, 3, most_points);
    if (!polygon) return polygon.error();
    const auto by = read_move(action, *line ? "line" : "polygon", "inflow", exists);
    if (!by) return by.error();
    if (*line && *polygon) return Error{"polygon: cannot go with line; send one of them"};
    if (!exists && !*line && !*polygon) return missing("line or polygon", "inflow");
    if (*line) {
        inflow.from = (**line)[0];
        inflow.to = (**line)[1];
        inflow.area.clear();
        inflow.direction.reset();
    }
    if (*polygon) {
        if (Status s = check_ring(terrain, **polygon, "polygon", true); !s) return s;
        inflow.area = {{std::move(**polygon), {}}};
        inflow.from = inflow.to = {};
    }
    if (*by && inflow.over_area()) {
        for (Polygon& part : inflow.area) {
            part = moved(std::move(part), **by);
            if (Status s = check_ground(terrain, part, "move_m", true); !s) return s;
        }
    } else if (*by) {
        inflow.from = shifted(inflow.from, **by);
        inflow.to = shifted(inflow.to, **by);
    }
    return inflow.over_area() ? Status() : check_line(inflow, terrain, *by ? "move_m" : "line");
}

Status read_direction(const json& action, Inflow& inflow) {
    if (!action.contains("direction_deg")) return {};
    const auto direction =
        read_number(action, "direction_deg", find_section("inflow")->find("direction_deg")->range, "deg");
    if (!direction) return direction.error();
    if (*direction && !inflow.over_area()) {
        return Error{"direction_deg: is refused across a line, which has a direction of its own"};
    }
    inflow.direction.reset();
    if (*direction) inflow.direction = **direction * std::numbers::pi / 180;
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
    if (Status s =
            check_keys(action, {"action", "id", "name", "line", "polygon", "move_m", "direction_deg", "hydrograph"});
        !s) {
        return s.error();
    }
    Inflow inflow;
    if (existing != nullptr) inflow = *existing->body;
    inflow.name = name;
    if (Status s = read_place(action, context.scene.terrain, existing != nullptr, inflow); !s) return s.error();
    if (Status s = read_direction(action, inflow); !s) return s.error();
    if (action.contains("hydrograph")) {
        auto rows = read_hydrograph_rows(action["hydrograph"], inflow.over_area());
        if (!rows) return rows.error();
        inflow.hydrograph = std::move(*rows);
    } else if (existing == nullptr) {
        return missing("hydrograph", "inflow");
    } else if (const auto rows = read_hydrograph_rows(to_json(inflow.hydrograph), inflow.over_area()); !rows) {
        return rows.error();  // what came over an area may be too still for a line
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
