#include <algorithm>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/vector.hpp"
#include "scene/grid_cell.hpp"
#include "scene/known_ground.hpp"
#include "scene/load.hpp"
#include "scene/polygons.hpp"

namespace talus::scene {
namespace {

/// The rectangle around a structure, as far as there is terrain.
Result<Polygon> area_around(const std::string& at, const Scene& scene) {
    const params::ZoomSpec& spec = scene.spec.zoom;
    std::vector<std::string> names;
    for (const terrain::Building& building : scene.buildings) {
        if (building.name == spec.structure) {
            Extent e = extent_of(building).grown(spec.margin);
            // Nothing comes from beyond the terrain; a hundredth of a cell is for rounding.
            const Extent known = covered_extent(scene.terrain).grown(-0.01 * scene.terrain.cell());
            e = {std::max(e.x_min, known.x_min), std::max(e.y_min, known.y_min), std::min(e.x_max, known.x_max),
                 std::min(e.y_max, known.y_max)};
            return Polygon{{{e.x_min, e.y_min}, {e.x_max, e.y_min}, {e.x_max, e.y_max}, {e.x_min, e.y_max}}, {}};
        }
        names.push_back(building.name);
    }
    const std::string nearest = params::nearest_word(spec.structure, names);
    return Error{fmt::format("{} = \"{}\" is no building and no barrier of the scene; {}", at,
                             one_line(spec.structure, 80),
                             nearest.empty() ? "it has none" : "nearest name: " + nearest)};
}

Result<Polygon> area_from_file(const std::string& at, Scene& scene) {
    const params::ZoomSpec& spec = scene.spec.zoom;
    const Result<geo::PolygonLayer> layer = load_polygons("zoom", spec.polygon_file, spec.layer, scene);
    if (!layer) return Error{at + ": " + layer.error().message};
    std::vector<Polygon> parts;
    for (const geo::PolygonFeature& feature : layer->features) {
        parts.insert(parts.end(), feature.parts.begin(), feature.parts.end());
    }
    if (parts.size() != 1 || !parts.front().holes.empty()) {
        return Error{fmt::format("{}: has {} polygons{}; a zoom is one, without holes", at, parts.size(),
                                 parts.size() == 1 ? " with holes" : "")};
    }
    return std::move(parts.front());
}

/// Debris may not start within the area: it has to cross the boundary.
Status check_sources(const std::string& at, const Polygon& area, const Scene& scene) {
    const auto lies_within = [&](const char* what, const std::string& name) {
        return Error{fmt::format("{}: {} \"{}\" lies in the area of the zoom, whose debris has to cross its boundary",
                                 at, what, name)};
    };
    for (const terrain::Release& release : scene.releases) {
        for (const terrain::ReleasePatch& patch : release.patches) {
            if (overlap_of(area, patch.polygon).area > 0) return lies_within("release", release.name);
        }
    }
    for (const terrain::Inflow& inflow : scene.inflows) {
        for (const Polygon& part : inflow.area) {
            if (overlap_of(area, part).area > 0) return lies_within("inflow", inflow.name);
        }
        constexpr int parts = 256;
        for (int k = 0; k <= parts && !inflow.over_area(); ++k) {
            const double s = static_cast<double>(k) / parts;
            const PlanPoint p{inflow.from.x + s * (inflow.to.x - inflow.from.x),
                              inflow.from.y + s * (inflow.to.y - inflow.from.y)};
            if (contains(area, p)) return lies_within("inflow", inflow.name);
        }
    }
    return {};
}

}  // namespace

Status load_zoom(const ParsedScene& parsed, Scene& scene) {
    const params::ZoomSpec& spec = scene.spec.zoom;
    if (!spec.wanted() || scene.spec.solver.model != params::ModelChoice::particles) return {};
    const std::string key = !spec.structure.empty() ? "structure"
                            : !spec.polygon.empty() ? "polygon_m"
                                                    : "polygon_file";
    const std::string at = parsed.at("zoom." + key);
    Polygon area{spec.polygon, {}};
    if (!spec.structure.empty()) {
        TALUS_ASSIGN(area, area_around(at, scene));
    } else if (!spec.polygon_file.empty()) {
        TALUS_ASSIGN(area, area_from_file(at, scene));
    }
    TALUS_TRY(check_area(scene.terrain, area, at, true));
    if (!scene.bed.empty()) {
        return Error{at + ": a zoom is refused where debris entrains its bed, whose state it does not take over"};
    }
    if (scene.spec.material.pore_pressure == params::PorePressure::dilatancy) {
        return Error{at +
                     ": a zoom is refused beside material.pore_pressure = \"dilatancy\", whose solid fraction it does "
                     "not take over"};
    }
    TALUS_TRY(check_sources(at, area, scene));
    TALUS_TRY(refuse_for_depth_averaged(parsed, scene, "leave out the zoom"));
    scene.zoom = std::move(area);
    return {};
}

void leave_out_zoom(Scene& scene, const std::string& who) {
    if (!scene.zoom) return;
    scene.zoom.reset();
    scene.notes.push_back(fmt::format("[zoom] is left out: {} runs the whole event with particles", who));
}

}  // namespace talus::scene
