#include "pack/check.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/fields.hpp"
#include "scene/hydrograph.hpp"
#include "scene/particle_spacing.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/map_cell.hpp"
#include "terrain/wall_effort.hpp"

namespace talus::pack {
namespace {

constexpr double farthest = 1e8;  // m, of any place
constexpr double highest = 1e5;   // m
constexpr double most_wall_pieces = 5e6, most_chainage_rows = 1e6;

bool sized(const Grid<float>& grid) {
    const GridGeometry& g = grid.geometry;
    const bool placed = std::abs(g.x_min) < farthest && std::abs(g.y_min) < farthest && g.cell > 0 && g.cell < farthest;
    return placed && g.columns > 0 && g.rows > 0 && grid.values.size() == g.size();
}

bool placed(const std::vector<PlanPoint>& points) {
    return std::all_of(points.begin(), points.end(),
                       [](const PlanPoint& p) { return std::abs(p.x) < farthest && std::abs(p.y) < farthest; });
}

bool closed(const std::vector<Polygon>& polygons) {
    const auto ring = [](const Ring& points) { return points.size() >= 3 && placed(points); };
    return std::all_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) {
        return ring(polygon.outer) && std::all_of(polygon.holes.begin(), polygon.holes.end(), ring);
    });
}

Error of(const char* kind, std::size_t index, const char* what) {
    return Error{fmt::format("{}[{}] {}", kind, index, what)};
}

Status check_values(const params::SceneSpec& spec) {
    std::string refused;
    params::for_each_value(spec, [&](const params::Section& section, std::size_t index,
                                     const params::Parameter& parameter, const params::ParameterValue& value) {
        if (!refused.empty() || !params::is_given(value)) return;
        const std::string problem = params::problem_with(parameter, value);
        if (problem.empty()) return;
        refused = fmt::format("{} = {} is refused; it {}", key_path(section, index, parameter),
                              params::plain_text(value), problem);
    });
    if (!refused.empty()) return Error{refused};
    return {};
}

Status check_rules(const params::SceneSpec& spec, double spacing) {
    for (const params::Section& section : params::scene_sections()) {
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            const auto broken = broken_rule(section, spec, index, spacing);
            if (broken) return Error{key_path(section, index, *section.find(broken->key)) + broken->text};
        }
    }
    return {};
}

Status check_releases(const scene::Scene& scene) {
    for (std::size_t i = 0; i < scene.releases.size(); ++i) {
        const terrain::Release& release = scene.releases[i];
        if (!(release.volume > 0 && std::isfinite(release.volume))) return of("release", i, "has no volume");
        if (release.thickness_raster && !sized(*release.thickness_raster)) return of("release", i, "has no raster");
        if (!release.thickness_raster && release.patches.empty()) return of("release", i, "has no area");
        double before = -1;
        for (const params::PressureSample& row : release.water) {
            if (!(row.time > before && std::isfinite(row.time) && row.ratio >= 0 && row.ratio <= 1)) {
                return of("release", i, "has water that rises out of order");
            }
            before = row.time;
        }
        for (const terrain::ReleasePatch& patch : release.patches) {
            if (!closed({patch.polygon}) || !(patch.thickness > 0 && patch.thickness < highest)) {
                return of("release", i, "has a polygon without an area or a thickness");
            }
        }
    }
    return {};
}

Status check_inflows(const scene::Scene& scene) {
    const params::Section& rows = params::live_section("hydrograph");
    for (std::size_t i = 0; i < scene.inflows.size(); ++i) {
        const terrain::Inflow& inflow = scene.inflows[i];
        if (inflow.hydrograph.size() < scene::min_rows || inflow.hydrograph.size() > scene::max_rows) {
            return of("inflow", i, "has no hydrograph");
        }
        params::SceneSpec row;
        row.hydrograph.resize(1);
        double before = -1;
        for (const params::InflowSample& sample : inflow.hydrograph) {
            row.hydrograph[0] = sample;
            for (const params::Parameter& parameter : rows.parameters) {
                const params::ParameterValue value = parameter.get(row, 0);
                if (!params::is_given(value) || problem_with(parameter, value).empty()) continue;
                return of("inflow", i, "has a hydrograph with values out of their ranges");
            }
            if (!(sample.time > before)) return of("inflow", i, "has a hydrograph that goes back in time");
            before = sample.time;
        }
        if (!closed(inflow.area) || !placed({inflow.from, inflow.to})) return of("inflow", i, "has no place");
        if (!inflow.over_area()) TALUS_TRY(scene::check_line(inflow, scene.terrain, fmt::format("inflow[{}]", i)));
        TALUS_TRY(scene::check_hydrograph(inflow, scene.spec.solver, fmt::format("inflow[{}]", i)));
    }
    return {};
}

Status check_structures(const scene::Scene& scene) {
    const auto& buildings = scene.buildings;
    for (std::size_t i = 0; i < buildings.size(); ++i) {
        const terrain::Building& b = buildings[i];
        const bool roofs = b.part_roof_elevations.empty() || b.part_roof_elevations.size() == b.footprint.size();
        if (!closed(b.footprint) || !roofs || std::isnan(b.height) || std::isnan(b.resistance.pressure) ||
            std::isnan(b.resistance.force_per_metre)) {
            return of("building", i, "has no shape");
        }
        const bool behind = i + scene.barrier_sections.size() >= buildings.size();
        if (b.barrier.has_value() != behind) return of("building", i, "is not in its place");
        if (b.barrier && (b.barrier->line.size() < 2 || !placed(b.barrier->line)))
            return of("barrier", i, "has no line");
    }
    for (const std::size_t section : scene.barrier_sections) {
        if (section >= scene.spec.barriers.size()) return Error{"a barrier has no section"};
    }
    if (terrain::WallEffort(buildings, 0).pieces() > most_wall_pieces) {
        return Error{fmt::format("its {} buildings overlap too much", buildings.size())};
    }
    return {};
}

Status check_places(const scene::Scene& scene) {
    const std::vector<PlanPoint>& path = scene.flow_path.points();
    const Extent extent = scene.terrain.elevation().geometry.extent();
    const Extent near = extent.grown(std::max(extent.width(), extent.height()));
    for (const PlanPoint& p : path) {
        if (!near.contains(p)) return Error{"its flow path leaves the terrain"};
    }
    if (scene.flow_path.length() / scene.spec.outputs.chainage_interval > most_chainage_rows) {
        return Error{"its flow path has too many rows"};
    }
    for (std::size_t i = 0; i < scene.gauges.size(); ++i) {
        if (!placed({scene.gauges[i].at})) return of("gauge", i, "has no place");
    }
    for (std::size_t i = 0; i < scene.cross_sections.size(); ++i) {
        const terrain::CrossSection& section = scene.cross_sections[i];
        if (section.line.size() < 2 || !placed(section.line) || !(section.interval > 0 && section.interval < 1e6)) {
            return of("cross_section", i, "has no line");
        }
    }
    if (scene.zoom && !closed({*scene.zoom})) return Error{"its zoom has no area"};
    for (const auto* outlines : {&scene.deposit_outlines, &scene.affected_areas}) {
        for (const auto& outline : *outlines) {
            if (!closed(outline)) return Error{"an observed outline has no area"};
        }
    }
    for (std::size_t i = 0; i < scene.elevation_changes.size(); ++i) {
        if (!sized(scene.elevation_changes[i])) return of("elevation_change", i, "has no raster");
    }
    return {};
}

/// Entries of the file and what was loaded for them.
Status check_counts(const scene::Scene& scene) {
    const params::SceneSpec& spec = scene.spec;
    const std::vector<std::tuple<const char*, std::size_t, std::size_t>> counts{
        {"release", spec.releases.size(), scene.releases.size()},
        {"inflow", spec.inflows.size(), scene.inflows.size()},
        {"zone", spec.zones.size(), scene.zones.size()},
        {"bed", spec.beds.size(), scene.bed_layers.size()},
        {"gauge", spec.gauges.size(), scene.gauges.size()},
        {"deposit_outline", spec.deposit_outlines.size(), scene.deposit_outlines.size()},
        {"affected_area", spec.affected_areas.size(), scene.affected_areas.size()},
        {"elevation_change", spec.elevation_changes.size(), scene.elevation_changes.size()},
        {"barrier section", scene.barrier_sections.size(),
         std::min(scene.barrier_sections.size(), scene.buildings.size())},
    };
    for (const auto& [what, wanted, there] : counts) {
        if (wanted != there) return Error{fmt::format("it has {} entries of {} and data for {}", wanted, what, there)};
    }
    if (scene.releases.empty() && scene.inflows.empty()) return Error{"it has no release and no inflow"};
    return {};
}

}  // namespace

Status check_terrain(const Grid<float>& elevation) {
    const GridGeometry& g = elevation.geometry;
    if (!sized(elevation) || g.columns < 2 || g.rows < 2) return Error{"its terrain has no grid"};
    bool known = false;
    for (const float z : elevation.values) {
        if (std::isnan(z)) continue;
        if (!(std::abs(static_cast<double>(z)) < highest)) return Error{"its terrain has impossible heights"};
        known = true;
    }
    if (!known) return Error{"its terrain has no data"};
    return {};
}

Status check_parts(const scene::Scene& scene) {
    TALUS_TRY(check_values(scene.spec));
    TALUS_TRY(check_counts(scene));
    const GridGeometry& terrain = scene.terrain.elevation().geometry;
    for (std::size_t i = 0; i < scene.zones.size(); ++i) {
        const scene::Zone& zone = scene.zones[i];
        if (!closed(zone.outline)) return of("zone", i, "has no area");
        if (!zone.cells) continue;
        const auto& cells = zone.cells->cell;
        const bool inside = std::all_of(cells.begin(), cells.end(), [&](std::size_t c) { return c < terrain.size(); });
        if (!inside || zone.cells->value.size() != cells.size()) return of("zone", i, "has no raster");
    }
    if (scene.bed_layers.size() > terrain::Bed::max_materials) return Error{"it has too many beds"};
    for (std::size_t i = 0; i < scene.bed_layers.size(); ++i) {
        const scene::BedLayer& layer = scene.bed_layers[i];
        if (layer.depth_raster && !sized(*layer.depth_raster)) return of("bed", i, "has no raster");
        for (const scene::BedLayer::Part& part : layer.parts) {
            if (!closed({part.polygon}) || !(part.depth >= 0 && part.depth < highest)) {
                return of("bed", i, "has a polygon without an area or a depth");
            }
        }
    }
    return {};
}

double map_cells(const scene::Scene& scene) {
    const double spacing = particle_spacing(scene);
    const double cell = scene.spec.outputs.map_cell.value_or(terrain::default_map_cell(scene.terrain.cell(), spacing));
    const Extent extent = scene.terrain.elevation().geometry.extent();
    return extent.width() * extent.height() / (cell * cell);
}

Status check_scene(const scene::Scene& scene) {
    TALUS_TRY(check_releases(scene));
    TALUS_TRY(check_inflows(scene));
    TALUS_TRY(check_structures(scene));
    TALUS_TRY(check_places(scene));
    if (scene.spec.solver.target_layers.has_value() != scene.thinnest.has_value() ||
        (scene.thinnest && !(scene.thinnest->thickness > 0 && scene.thinnest->thickness < highest))) {
        return Error{"it does not know the thickness that solver.target_layers counts"};
    }
    const double spacing = particle_spacing(scene);
    if (!params::parameter_of("solver", "particle_spacing_m").range.contains(spacing)) {
        return Error{fmt::format("its particles would be {:.4g} m apart", spacing)};
    }
    TALUS_TRY(check_rules(scene.spec, spacing));
    return sim::check_particle_count(scene.releases, scene.inflows, scene.spec.solver, spacing);
}

}  // namespace talus::pack
