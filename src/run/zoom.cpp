#include "run/zoom.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/fields.hpp"
#include "run/depth_run.hpp"
#include "scene/particle_spacing.hpp"
#include "scene/viscosity_limit.hpp"

namespace talus::run {
namespace {

double distance_to(const Ring& ring, const PlanPoint& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const PlanPoint &a = ring[k], &b = ring[(k + 1) % ring.size()];
        const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
        const double share = squared > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
        nearest = std::min(nearest, std::hypot(p.x - a.x - share * dx, p.y - a.y - share * dy));
    }
    return nearest;
}

/// The terrain without what lies farther from the area: particles that get there have left it and are removed.
terrain::Terrain cut_to(const terrain::Terrain& terrain, const Polygon& area, double surroundings) {
    Grid<float> elevation = terrain.elevation();
    const GridGeometry& g = elevation.geometry;
    const double reach = surroundings + g.cell;
    const Extent near = extent_of(area).grown(reach);
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const PlanPoint centre = g.centre(column, row);
            if (near.contains(centre) && (contains(area, centre) || distance_to(area.outer, centre) <= reach)) continue;
            elevation.at(column, row) = std::numeric_limits<float>::quiet_NaN();
        }
    }
    return terrain::Terrain(std::move(elevation));
}

/// The momentum of inflows, per density, m4/s: the integral of discharge times velocity in plan.
PlanPoint momentum_of(const std::vector<terrain::Inflow>& inflows, const terrain::Terrain& terrain) {
    PlanPoint sum{0, 0};
    for (const terrain::Inflow& inflow : inflows) {
        double momentum = 0;
        for (std::size_t k = 0; k + 1 < inflow.hydrograph.size(); ++k) {
            const params::InflowSample &a = inflow.hydrograph[k], &b = inflow.hydrograph[k + 1];
            momentum += (b.time - a.time) *
                        (2 * a.discharge * a.velocity + 2 * b.discharge * b.velocity + a.discharge * b.velocity +
                         b.discharge * a.velocity) /
                        6;
        }
        const double dx = inflow.to.x - inflow.from.x, dy = inflow.to.y - inflow.from.y, width = std::hypot(dx, dy);
        const PlanPoint towards{dy / width, -dx / width};
        const PlanPoint middle{(inflow.from.x + inflow.to.x) / 2, (inflow.from.y + inflow.to.y) / 2};
        const LocalPoint at = terrain.frame().to_local({middle.x, middle.y, 0});
        const auto normal = terrain.sample(double{at.x}, double{at.y}).normal;
        // Along the ground to plan: the horizontal part of the unit vector in the direction of flow.
        const double rise = -(normal.x * towards.x + normal.y * towards.y) / normal.z;
        const double in_plan = momentum / std::sqrt(1 + rise * rise);
        sum.x += in_plan * towards.x;
        sum.y += in_plan * towards.y;
    }
    return sum;
}

Result<double> spacing_of(const scene::Scene& scene, double thickness) {
    const params::ZoomSpec& zoom = scene.spec.zoom;
    const double spacing = zoom.particle_spacing ? *zoom.particle_spacing
                           : zoom.target_layers  ? scene::spacing_of_layers(thickness, *zoom.target_layers)
                                                 : particle_spacing(scene);
    const params::Parameter& key = params::parameter_of("zoom", "particle_spacing_m");
    if (!key.range.contains(spacing)) {
        return Error{fmt::format(
            "zoom.target_layers = {:.6g} is refused; over {:.3g} m, the greatest thickness of what crosses the "
            "boundary, it "
            "puts particles {:.4g} m apart, which must be {} m",
            zoom.target_layers.value_or(0), thickness, spacing, key.range.text())};
    }
    return spacing;
}

}  // namespace

double ZoomRecord::first_time() const {
    const auto first = std::find_if(discharge.begin(), discharge.end(), [](double q) { return q > 0; });
    return static_cast<double>(first - discharge.begin()) * BoundaryFlow::interval;
}

Result<ZoomedScene> zoom_in(const scene::Scene& scene, const RunOptions& options) {
    const std::string file = scene.file.string();
    scene::Scene event = scene;
    event.zoom.reset();
    event.spec.solver.model = params::ModelChoice::depth_averaged;
    event.gauges.clear();  // all results are those of the particles
    event.cross_sections.clear();
    std::optional<BoundaryFlow> flow;
    RunOptions recording = options;
    recording.on_frame = nullptr;
    recording.on_state = nullptr;
    recording.on_grid_step = [&](const depth::Solver& solver) {
        if (!flow) flow.emplace(solver, *scene.zoom);
        flow->record(solver);
    };
    TALUS_ASSIGN(const RunResult run, run_depth_averaged(event, recording, Inside::as_particles));
    if (run.status == RunStatus::fault) return Error{fmt::format("{}: zoom: {}", file, run.stop_reason)};
    if (run.status == RunStatus::interrupted) {
        return Error{file + ": interrupted before the particles of the zoom began"};
    }
    const BoundaryFlow::Volumes volumes = flow ? flow->volumes() : BoundaryFlow::Volumes{};
    const double thickness = flow ? flow->thickness() : 0;
    if (!(volumes.in > 0)) {
        return Error{file + ": the zoom is refused; no debris of the depth-averaged model crosses its boundary"};
    }
    const Result<double> spacing = spacing_of(scene, thickness);
    if (!spacing) return Error{file + ": " + spacing.error().message};
    if (const auto broken = scene::too_viscous(scene.spec.material, scene.spec.solver, *spacing)) {
        return Error{file + ": zoom: material." + broken->key + broken->text};
    }
    ZoomedScene zoomed{std::move(event), {}};
    ZoomRecord& record = zoomed.record;
    record.around = scene.spec.zoom.structure;
    record.area = *scene.zoom;
    record.surroundings = scene.spec.zoom.surroundings;
    record.event_volume = total_volume(scene);
    record.particle_spacing = *spacing;
    record.thickness = thickness;
    record.grid_cell = run.grid_cell;
    record.simulated_time = run.simulated_time;
    record.wall_time = run.wall_time;
    record.energy = run.observation.energy;
    record.volumes = volumes;
    record.discharge = flow->discharge();

    scene::Scene& particles = zoomed.scene;
    particles.spec.solver = scene.spec.solver;
    particles.gauges = scene.gauges;
    particles.cross_sections = scene.cross_sections;
    particles.spec.solver.particle_spacing = *spacing;
    particles.spec.solver.target_layers.reset();
    particles.spec.solver.target_particle_count.reset();
    // Inflows bring the pore pressure of their debris, where it is not that of the material all the time.
    for (const terrain::Release& release : particles.releases) {
        double& ratio = particles.spec.material.pore_pressure_ratio;
        ratio = std::max(ratio, release.spec.pore_pressure_ratio.value_or(0));
    }
    particles.releases.clear();
    particles.inflows = flow->inflows(*spacing);
    if (particles.inflows.empty()) {
        return Error{
            fmt::format("{}: the zoom is refused; {:.3g} m3 cross its boundary, less than a particle of "
                        "{:.3g} m",
                        file, volumes.in, *spacing)};
    }
    particles.flow_path_origin = scene::PathOrigin::file;  // chainages are along that of the whole event
    particles.terrain = cut_to(scene.terrain, *scene.zoom, record.surroundings);

    const double density = scene.spec.material.rest_density;
    const PlanPoint crossed = flow->momentum(), brought = momentum_of(particles.inflows, scene.terrain);
    record.pieces = particles.inflows.size();
    record.brought_volume = total_volume(particles);
    record.momentum = {density * crossed.x, density * crossed.y};
    record.brought_momentum = {density * brought.x, density * brought.y};
    return Result<ZoomedScene>(std::move(zoomed));
}

}  // namespace talus::run
