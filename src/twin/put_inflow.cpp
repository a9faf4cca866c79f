#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/hydrograph.hpp"
#include "twin/hydrograph_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

PlanPoint shifted(const PlanPoint& p, const PlanPoint& by) {
    return {p.x + by.x, p.y + by.y};
}

/// Location of the inflow: across a line or over an area.
Status read_place(const json& action, const terrain::Terrain& terrain, bool exists, terrain::Inflow& inflow) {
    TALUS_ASSIGN(const auto line, read_points(action, "line", false, 2, 2));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(action, "polygon", "inflow", exists));
    if (line && drawn) return Error{fmt::format("{}: cannot go with line; send one of them", drawn.key)};
    if (!exists && !line && !drawn.ring) return missing("line or polygon", "inflow");
    if (line) {
        inflow.from = (*line)[0];
        inflow.to = (*line)[1];
        inflow.area.clear();
        inflow.spec.direction.reset();
    }
    if (drawn.ring) inflow.from = inflow.to = {};
    if (drawn.by && !inflow.over_area()) {
        inflow.from = shifted(inflow.from, *drawn.by);
        inflow.to = shifted(inflow.to, *drawn.by);
    } else if (drawn) {
        TALUS_TRY(redraw(drawn, terrain, true, inflow.area));
    }
    const bool over_area = inflow.over_area();
    inflow.spec.file.clear();
    inflow.spec.polygon_file.clear();
    inflow.spec.polygon = over_area ? inflow.area.front().outer : Ring();
    inflow.spec.line = over_area ? std::vector<PlanPoint>() : std::vector{inflow.from, inflow.to};
    return over_area ? Status() : scene::check_line(inflow, terrain, drawn.by ? "move_m" : "line");
}

}  // namespace

double particles_in_all(const Setup& setup, const InflowSetup* existing, const terrain::Inflow& inflow,
                        double spacing) {
    double volume = inflow.volume();
    for (const InflowSetup& other : setup.inflows) {
        if (&other != existing) volume += other.body->volume();
    }
    for (const ReleaseSetup& release : setup.releases) volume += release.body->volume;
    return volume / std::pow(spacing, 3);
}

Result<terrain::Inflow> read_inflow(const json& action, const ActionContext& context, const Setup& setup,
                                    const InflowSetup* existing, const std::string& name) {
    TALUS_TRY(
        check_keys(action, live_keys("inflow"), {"action", "id", "name", "line", "polygon", "move_m", "hydrograph"}));
    terrain::Inflow inflow;
    if (existing != nullptr) inflow = *existing->body;
    inflow.name = name;
    const params::SolverSpec& solver = context.scene.spec.solver;
    TALUS_TRY(read_place(action, context.scene.terrain, existing != nullptr, inflow));
    TALUS_TRY(read_values(action, inflow.spec));
    TALUS_TRY(check_rules(inflow.spec, solver, context.particle_spacing));
    if (existing == nullptr && !action.contains("hydrograph")) return missing("hydrograph", "inflow");
    // Also checked if unchanged: an inflow over an area may be too slow for a line.
    const json rows = action.contains("hydrograph") ? action["hydrograph"] : list_json(inflow.hydrograph);
    TALUS_ASSIGN(inflow.hydrograph, read_hydrograph_rows(rows, inflow.spec));
    TALUS_TRY(scene::check_hydrograph(inflow, solver, "hydrograph"));
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
