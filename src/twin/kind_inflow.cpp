#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/hydrograph.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/outline.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t longest_table = 200;  // rows that are still readable

/// Older journals have directions in radians. Returns degrees that convert back to exactly the same value, so that a
/// replay is exact.
double degrees_of(double radians) {
    const double middle = radians * 180 / std::numbers::pi;
    double low = middle, high = middle;
    for (int k = 0; k < 8; ++k) {
        for (const double degrees : {low, high}) {
            if (degrees * std::numbers::pi / 180 == radians) return degrees;
        }
        low = std::nextafter(low, -360.0);
        high = std::nextafter(high, 720.0);
    }
    return middle;
}

PlanPoint shifted(const PlanPoint& p, const PlanPoint& by) {
    return {p.x + by.x, p.y + by.y};
}

/// A list of rows as list_json writes it.
Status read_hydrograph(const json& rows, terrain::Inflow& inflow) {
    if (!rows.is_array() || rows.size() < scene::min_rows || rows.size() > scene::max_rows) {
        return Error{fmt::format("hydrograph = {}: must be a list of {} rows or more", shown(rows), scene::min_rows)};
    }
    params::SceneSpec read = scene_with(inflow.spec);
    TALUS_TRY(read_live_list(rows, "hydrograph", params::live_section("hydrograph"), read, 0));
    inflow.hydrograph = std::move(read.hydrograph);
    return {};
}

/// Location of the inflow: across a line or over an area.
Status put_place(const json& given, const terrain::Terrain& terrain, bool exists, terrain::Inflow& inflow) {
    TALUS_ASSIGN(const auto line, read_points(given, "line", false, 2, 2));
    TALUS_ASSIGN(const Redrawn drawn, read_redrawn(given, "polygon", "inflow", exists));
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

json Inflows::body(const Body& inflow) {
    json body = values_json(inflow.spec);
    body["name"] = inflow.name;
    if (!inflow.over_area()) body["line"] = to_json(std::vector<PlanPoint>{inflow.from, inflow.to});
    body["polygons"] = polygons_json(inflow.area);
    body["hydrograph"] = list_json(inflow.hydrograph);
    return body;
}

json Inflows::more(const Entry& inflow, Shown&) {
    json more = {{"volume_m3", inflow.body->volume()}};
    if (inflow.body->over_area()) more["line"] = nullptr;
    if (inflow.body->hydrograph.size() > longest_table) more["hydrograph"] = nullptr;
    return more;
}

Status Inflows::read(const json& file, const scene::Scene&, Body& inflow) {
    // "direction": of older journals, in radians.
    TALUS_TRY(check_keys(file, live_keys("inflow"), {"name", "line", "polygons", "hydrograph", "direction"}));
    inflow = {};
    const auto line = read_points(file, "line", false, 2, 2);
    TALUS_ASSIGN(const auto radians, read_number(file, "direction", {}, "rad"));
    TALUS_ASSIGN(inflow.name, read_name(file));
    TALUS_ASSIGN(inflow.area, read_polygons(file));
    if (!line || (line->has_value() != inflow.area.empty())) return not_of_a_setup("line", file);
    if (*line) {
        inflow.from = (**line)[0];
        inflow.to = (**line)[1];
        inflow.spec.line = **line;
    } else {
        inflow.spec.polygon = inflow.area.front().outer;
    }
    TALUS_TRY(read_values(file, inflow.spec));
    if (radians) inflow.spec.direction = degrees_of(*radians);
    return read_hydrograph(file.value("hydrograph", json()), inflow);
}

Status Inflows::put(const Put<Entry>& put, Body& inflow) {
    const json& given = put.given;
    TALUS_TRY(check_keys(given, live_keys("inflow"), {"name", "line", "polygon", "move_m", "hydrograph"}));
    const params::SolverSpec& solver = put.context.scene.spec.solver;
    inflow.name = put.name;
    TALUS_TRY(put_place(given, put.context.scene.terrain, put.existing != nullptr, inflow));
    TALUS_TRY(read_values(given, inflow.spec));
    TALUS_TRY(check_rules(inflow.spec, solver, put.context.particle_spacing));
    if (put.existing == nullptr && !given.contains("hydrograph")) return missing("hydrograph", name);
    // Also checked if unchanged: an inflow over an area may be too slow for a line.
    TALUS_TRY(
        read_hydrograph(given.contains("hydrograph") ? given["hydrograph"] : list_json(inflow.hydrograph), inflow));
    TALUS_TRY(scene::check_hydrograph(inflow, solver, "hydrograph"));
    const double particles = particles_in_all(put.setup, put.existing, inflow, put.context.particle_spacing);
    if (particles <= solver.particle_limit) return {};
    return Error{
        fmt::format("hydrograph: {:.4g} m3 would make {:.0f} particles in all; solver.particle_limit "
                    "must be at least that, and is {}",
                    inflow.volume(), particles, solver.particle_limit)};
}

std::string Inflows::told(const Entry& inflow, const Put<Entry>& put) {
    return fmt::format(" {}: {:.0f} m3{}", put.done("drawn"), inflow.body->volume(), put.from_restart());
}

}  // namespace talus::twin
