#include "scene/grid_cell.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "params/fields.hpp"
#include "scene/limits.hpp"

namespace talus::scene {
namespace {

/// Below it a gully 5 m wide has two cells; measured on the terrain of Sham Tseng.
constexpr double coarsest_default_cell = 2.5;
constexpr double most_cells = 1e8;

/// `section`: of the structure, "barrier[2]" or "buildings".
std::optional<Lacking> lacking_structure(const Scene& scene, const terrain::Building& building,
                                         const std::string& section) {
    const auto lacking = [&](const std::string& key, std::string_view which) {
        const std::string& why = params::parameter_of(building.barrier ? "barrier" : "buildings", key).lacking;
        return Lacking{fmt::format("{}.{}", section, key), fmt::format("{}, and \"{}\" {}", why, building.name, which)};
    };
    if (building.barrier && building.barrier->passing_share) return lacking("passing_share", "is one");
    if (building.barrier && building.barrier->clearance) return lacking("clearance_m", "has a clearance");
    if (building.resistance == terrain::Resistance{}) return {};
    const bool per_metre = std::isfinite(building.resistance.force_per_metre);
    const bool of_each = !building.barrier && !scene.spec.buildings.resistance_attribute.empty();
    return lacking(per_metre ? "resistance_Npm"
                   : of_each ? "resistance_attribute"
                             : "resistance_Pa",
                   "has a resistance");
}

}  // namespace

double grid_cell(const Scene& scene) {
    const double cell = scene.terrain.cell();
    return scene.spec.solver.grid_cell.value_or(cell / std::ceil(cell / coarsest_default_cell - 1e-9));
}

std::optional<Lacking> depth_averaged_lacks(const Scene& scene) {
    for (std::size_t r = 0; r < scene.releases.size(); ++r) {
        if (scene.releases[r].water.empty()) continue;
        return Lacking{fmt::format("release[{}].pore_pressure_hydrograph", r),
                       params::parameter_of("release", "pore_pressure_hydrograph").lacking};
    }
    std::size_t barriers = 0;
    const auto barrier_section = [&] {
        const std::size_t number = barriers++;
        const std::vector<std::size_t>& sections = scene.barrier_sections;
        return number < sections.size() ? sections[number] : number;  // the live twin adds some that have no section
    };
    for (const terrain::Building& building : scene.buildings) {
        const std::string section = building.barrier ? fmt::format("barrier[{}]", barrier_section()) : "buildings";
        if (auto lacking = lacking_structure(scene, building, section)) return lacking;
    }
    return {};
}

Status refuse_for_depth_averaged(const ParsedScene& parsed, const Scene& scene, const std::string& otherwise) {
    if (const auto lacking = depth_averaged_lacks(scene)) {
        return Error{fmt::format("{}: the depth-averaged model {}; remove it, or {}", parsed.at(lacking->key),
                                 lacking->why, otherwise)};
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
    return {};
}

namespace {

/// Keys that the scene gives and that are of this use.
std::vector<std::string> given_keys(const Scene& scene, params::KeyUse use) {
    std::vector<std::string> given;
    for (const params::Section& section : params::scene_sections()) {
        for (const params::Parameter& parameter : section.parameters) {
            std::string key = section.name + "." + parameter.key;
            if (parameter.use == use && scene.given_keys.contains(key)) given.push_back(std::move(key));
        }
    }
    return given;
}

}  // namespace

std::vector<std::string> depth_averaged_notes(const Scene& scene) {
    std::vector<std::string> unused = given_keys(scene, params::KeyUse::particles);
    const auto dense = [](const terrain::Inflow& inflow) { return inflow.has_density(); };
    if (std::any_of(scene.inflows.begin(), scene.inflows.end(), dense)) {
        unused.emplace_back("the density of hydrographs");
    }
    const params::MaterialSpec& material = scene.spec.material;
    if (material.kinematic_viscosity && !material.viscosity_on_ground) {
        unused.emplace_back("material.kinematic_viscosity_m2ps without viscosity_on_ground");
    }
    std::vector<std::string> notes;
    if (!unused.empty()) {
        notes.push_back(fmt::format("the depth-averaged model does not use {}", fmt::join(unused, ", ")));
    }
    notes.push_back(fmt::format(
        "depth-averaged model on cells of {:.4g} m: one velocity over the depth; buildings and barriers are "
        "whole cells, forces on them are weight and momentum flux of the flow beside them; no friction inside, {}no "
        "splash",
        grid_cell(scene), scene.spec.solver.flight ? "" : "no falls, "));
    return notes;
}

void note_unused_by_particles(Scene& scene) {
    if (scene.zoom) return;
    const std::vector<std::string> unused = given_keys(scene, params::KeyUse::depth_averaged);
    if (unused.empty()) return;
    scene.notes.push_back(
        fmt::format("particles do not use {}: only the depth-averaged model does", fmt::join(unused, ", ")));
}

Status check_depth_averaged(const ParsedScene& parsed, Scene& scene) {
    TALUS_TRY(refuse_for_depth_averaged(parsed, scene, "use solver.model = \"particles\""));
    TALUS_TRY(check_series(parsed, scene, grid_cell(scene), 0));
    for (std::string& note : depth_averaged_notes(scene)) scene.notes.push_back(std::move(note));
    return {};
}

}  // namespace talus::scene
