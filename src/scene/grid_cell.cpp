#include "scene/grid_cell.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "scene/depth_averaged_keys.hpp"
#include "scene/limits.hpp"

namespace talus::scene {
namespace {

/// Below it a gully 5 m wide has two cells; measured on the terrain of Sham Tseng.
constexpr double coarsest_default_cell = 2.5;
constexpr double most_cells = 1e8;

/// What a scene has that the model lacks; the reasons stand beside its keys.
struct Refusal {
    const ParsedScene& parsed;
    const std::string& otherwise;

    [[nodiscard]] Status operator()(const std::string& place, std::string_view key, const std::string& which) const {
        return Error{fmt::format("{}: the depth-averaged model {}{}; remove it, or {}", parsed.at(place),
                                 depth_averaged_key(key)->why, which, otherwise)};
    }
};

Status check_structures(const Refusal& refuse, const Scene& scene) {
    for (const terrain::Building& building : scene.buildings) {
        const std::string place = building.barrier ? "barrier" : "buildings.file";
        const std::string which = fmt::format(", and \"{}\" ", building.name);
        if (building.barrier && building.barrier->passing_share) {
            return refuse(place, "barrier.passing_share", which + "is one");
        }
        if (building.barrier && building.barrier->clearance) {
            return refuse(place, "barrier.clearance_m", which + "has a clearance");
        }
        if (building.resistance != terrain::Resistance{}) {
            return refuse(place, building.barrier ? "barrier.resistance_Pa" : "buildings.resistance_Pa",
                          which + "has a resistance");
        }
    }
    return {};
}

}  // namespace

double grid_cell(const Scene& scene) {
    const double cell = scene.terrain.cell();
    return scene.spec.solver.grid_cell.value_or(cell / std::ceil(cell / coarsest_default_cell - 1e-9));
}

Status refuse_for_depth_averaged(const ParsedScene& parsed, const Scene& scene, const std::string& otherwise) {
    const Refusal refuse{parsed, otherwise};
    for (std::size_t k = 0; k < scene.spec.releases.size(); ++k) {
        if (!scene.spec.releases[k].pore_pressure_ratio) continue;
        return refuse(fmt::format("release[{}].pore_pressure_ratio", k), "release.pore_pressure_ratio", "");
    }
    TALUS_TRY(check_structures(refuse, scene));
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

Status check_depth_averaged(const ParsedScene& parsed, Scene& scene) {
    TALUS_TRY(refuse_for_depth_averaged(parsed, scene, "use solver.model = \"particles\""));
    const params::SceneSpec& spec = scene.spec;
    const double cell = grid_cell(scene);
    TALUS_TRY(check_series(parsed, scene, cell, 0));
    std::vector<std::string> unused;
    const auto dense = [](const terrain::Inflow& inflow) { return inflow.has_density(); };
    if (std::any_of(scene.inflows.begin(), scene.inflows.end(), dense)) {
        unused.emplace_back("the density of hydrographs");
    }
    for (const DepthAveragedKey& entry : depth_averaged_keys()) {
        const std::string key(entry.key);
        if (entry.use == KeyUse::noted && scene.given_keys.contains(key)) unused.push_back(key);
    }
    if (spec.material.kinematic_viscosity && !spec.material.viscosity_on_ground) {
        unused.emplace_back("material.kinematic_viscosity_m2ps without viscosity_on_ground");
    }
    if (!unused.empty()) {
        scene.notes.push_back(fmt::format("the depth-averaged model has no use for {}", fmt::join(unused, ", ")));
    }
    scene.notes.push_back(fmt::format(
        "depth-averaged model on cells of {:.4g} m: one velocity over the depth; buildings and barriers are "
        "whole cells, forces on them are weight and momentum flux of the flow beside them; no friction inside, no "
        "falls, no splash",
        cell));
    return {};
}

}  // namespace talus::scene
