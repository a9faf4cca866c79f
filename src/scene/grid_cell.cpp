#include "scene/grid_cell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "scene/limits.hpp"

namespace talus::scene {
namespace {

/// Below it a gully 5 m wide has two cells; measured on the terrain of Sham Tseng.
constexpr double coarsest_default_cell = 2.5;
constexpr double most_cells = 1e8;

/// Keys that mean something to particles only: all others of their sections are used.
constexpr std::array particle_keys = {"material.building_friction_coefficient",
                                      "material.internal_friction_coefficient",
                                      "material.viscosity",
                                      "material.inertial_friction_coefficient",
                                      "material.inertial_number",
                                      "material.grain_diameter_m",
                                      "material.grain_density_kgpm3",
                                      "solver.particle_spacing_m",
                                      "solver.target_layers",
                                      "solver.target_particle_count",
                                      "solver.particle_limit",
                                      "solver.time_step_s",
                                      "solver.displacement_limit",
                                      "solver.largest_time_step_s",
                                      "solver.smallest_time_step_s",
                                      "solver.iteration_count",
                                      "solver.extra_iteration_count",
                                      "solver.kernel",
                                      "solver.internal_friction",
                                      "solver.support_ratio",
                                      "solver.under_relaxation",
                                      "solver.constraint_relaxation",
                                      "solver.depenetration_speed_mps",
                                      "solver.rest_duration_s",
                                      "solver.compression_limit",
                                      "outputs.map_cell_m",
                                      "outputs.impact_filter_window_s",
                                      "outputs.impact_patch_edge_m"};

std::optional<Lacking> lacking_structure(const terrain::Building& building) {
    const std::string key = building.barrier ? "barrier" : "buildings.file";
    const std::string name = fmt::format("\"{}\" ", building.name);
    if (building.barrier && building.barrier->passing_share) {
        return Lacking{key, "has no nets, and " + name + "is one"};
    }
    if (building.barrier && building.barrier->clearance) {
        return Lacking{key, "has nothing below a structure, and " + name + "has a clearance"};
    }
    if (building.resistance != terrain::Resistance{}) {
        return Lacking{key, "has no structures that fail, and " + name + "has a resistance"};
    }
    return {};
}

}  // namespace

bool for_particles_only(std::string_view key) {
    return std::find(particle_keys.begin(), particle_keys.end(), key) != particle_keys.end();
}

double grid_cell(const Scene& scene) {
    const double cell = scene.terrain.cell();
    return scene.spec.solver.grid_cell.value_or(cell / std::ceil(cell / coarsest_default_cell - 1e-9));
}

std::optional<Lacking> depth_averaged_lacks(const Scene& scene) {
    for (std::size_t k = 0; k < scene.releases.size(); ++k) {
        if (!scene.releases[k].spec.pore_pressure_ratio) continue;
        return Lacking{fmt::format("release[{}].pore_pressure_ratio", k),
                       "has one pore pressure for all debris, that of the material"};
    }
    for (const terrain::Building& building : scene.buildings) {
        if (auto lacking = lacking_structure(building)) return lacking;
    }
    return {};
}

std::vector<std::string> depth_averaged_notes(const Scene& scene) {
    std::vector<std::string> unused;
    const auto dense = [](const terrain::Inflow& inflow) { return inflow.has_density(); };
    if (std::any_of(scene.inflows.begin(), scene.inflows.end(), dense)) {
        unused.emplace_back("the density of hydrographs");
    }
    for (const char* key : particle_keys) {
        if (scene.given_keys.contains(key)) unused.emplace_back(key);
    }
    const params::MaterialSpec& material = scene.spec.material;
    if (material.kinematic_viscosity && !material.viscosity_on_ground) {
        unused.emplace_back("material.kinematic_viscosity_m2ps without viscosity_on_ground");
    }
    std::vector<std::string> notes;
    if (!unused.empty()) {
        notes.push_back(fmt::format("the depth-averaged model has no use for {}", fmt::join(unused, ", ")));
    }
    notes.push_back(fmt::format(
        "depth-averaged model on cells of {:.4g} m: one velocity over the depth; buildings and barriers are "
        "whole cells, forces on them are weight and momentum flux of the flow beside them; no friction inside, no "
        "falls, no splash",
        grid_cell(scene)));
    return notes;
}

Status check_depth_averaged(const ParsedScene& parsed, Scene& scene) {
    if (const auto lacking = depth_averaged_lacks(scene)) {
        return Error{fmt::format("{}: the depth-averaged model {}; remove it, or use solver.model = \"particles\"",
                                 parsed.at(lacking->key), lacking->why)};
    }
    const Extent e = scene.terrain.elevation().geometry.extent();
    const double cell = grid_cell(scene), cells = e.width() * e.height() / (cell * cell);
    if (cells > most_cells) {
        return Error{
            fmt::format("{} = {:.4g} is refused; the grid would have {:.3g} cells, and may have {:.3g}: it must "
                        "be at least {:.3g} (m)",
                        parsed.at("solver.grid_cell_m"), cell, cells, most_cells,
                        std::ceil(1e3 * std::sqrt(e.width() * e.height() / most_cells)) / 1e3)};
    }
    TALUS_TRY(check_series(parsed, scene, cell, 0));
    for (std::string& note : depth_averaged_notes(scene)) scene.notes.push_back(std::move(note));
    return {};
}

}  // namespace talus::scene
