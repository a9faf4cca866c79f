#include "scene/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/decimals.hpp"
#include "scene/grid_cell.hpp"
#include "scene/particle_spacing.hpp"
#include "scene/warning.hpp"
#include "terrain/map_cell.hpp"

namespace talus::scene {
namespace {

std::string terrain_line(const Scene& scene) {
    const Grid<float>& elevation = scene.terrain.elevation();
    float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
    for (const float z : elevation.values) {
        lowest = std::min(lowest, std::isnan(z) ? lowest : z);
        highest = std::max(highest, std::isnan(z) ? highest : z);
    }
    const GridGeometry& g = elevation.geometry;
    const int decimals = decimals_for(std::max(g.extent().width(), g.extent().height()), 1);
    return fmt::format(
        "terrain     {} x {} cells of {:.6g} m, {}, {:.{}f} to {:.{}f} m (vertical unit: {}), nodata {:.2g} %{}\n",
        g.columns, g.rows, g.cell, scene.crs.label(), lowest, decimals, highest, decimals, scene.vertical_unit,
        100 * scene.nodata_share, scene.spec.terrain.extent ? ", cropped" : "");
}

std::string release_line(const Scene& scene, const terrain::Release& release) {
    double plan = 0;
    for (const terrain::ReleasePatch& patch : release.patches) plan += plan_area(patch.polygon);
    return fmt::format(
        "release     \"{}\": {:.6g} m3, {:.6g} m2 in plan, mean thickness {:.3g} m, starts at {:.4g} s\n", release.name,
        release.volume, plan, mean_thickness(scene.terrain, release), release.spec.start_time);
}

std::string particle_line(const Scene& scene, double volume, double spacing) {
    const double count = std::round(volume / (spacing * spacing * spacing));
    return fmt::format("particles   about {:.0f} with a spacing of {:.4g} m ({}{})\n", count, spacing,
                       scene.spec.solver.particle_spacing ? "" : "from ", spacing_key(scene.spec.solver));
}

std::string buildings_line(const Scene& scene) {
    if (scene.buildings.empty()) return "buildings   none\n";
    const auto assumed = std::count_if(scene.buildings.begin(), scene.buildings.end(),
                                       [](const terrain::Building& building) { return building.height_assumed; });
    const auto barriers = std::count_if(scene.buildings.begin(), scene.buildings.end(),
                                        [](const terrain::Building& building) { return building.barrier.has_value(); });
    std::string text = fmt::format("buildings   {}, {} with an assumed height\n",
                                   static_cast<std::ptrdiff_t>(scene.buildings.size()) - barriers, assumed);
    const auto nets = std::count_if(
        scene.buildings.begin(), scene.buildings.end(),
        [](const terrain::Building& building) { return building.barrier && building.barrier->passing_share; });
    if (barriers > 0)
        text += fmt::format("barriers    {}", barriers) + (nets > 0 ? fmt::format(", {} of them nets\n", nets) : "\n");
    return text;
}

}  // namespace

std::string describe_scene(const Scene& scene) {
    std::string out = "scene       " + scene.spec.scene.title + "\n";
    if (scene.spec.scene.reconstruction) out += "            its inputs are reconstructed, not surveyed\n";
    out += terrain_line(scene);
    const double volume = total_volume(scene);
    for (const terrain::Release& release : scene.releases) out += release_line(scene, release);
    for (const terrain::Inflow& inflow : scene.inflows) {
        out += fmt::format("inflow      \"{}\": {:.4g} m3 between {:.6g} and {:.6g} s\n", inflow.name, inflow.volume(),
                           inflow.hydrograph.front().time, inflow.hydrograph.back().time);
    }
    const bool particles = scene.spec.solver.model == params::ModelChoice::particles;
    const double spacing = particle_spacing(scene);
    out += particles ? particle_line(scene, volume, spacing)
                     : fmt::format("model       depth-averaged, on cells of {:.4g} m\n", grid_cell(scene));
    if (particles)
        out +=
            fmt::format("map cell    {:.4g} m\n",
                        scene.spec.outputs.map_cell.value_or(terrain::default_map_cell(scene.terrain.cell(), spacing)));
    out += buildings_line(scene);
    out += scene.flow_path.empty()
               ? "flow path   none\n"
               : fmt::format("flow path   {:.{}f} m, {}\n", scene.flow_path.length(),
                             decimals_for(scene.flow_path.length(), 0),
                             scene.flow_path_origin == PathOrigin::file ? "from its file"
                             : follows_debris(scene) ? "traced downhill from the release, a first guess until the run"
                                                     : "traced downhill from the release");
    for (const params::VariantSpec& variant : scene.spec.variants) {
        out += fmt::format("variant     {}: {}\n", variant.name, fmt::join(variant.set, ", "));
    }
    if (!scene.notes.empty()) out += "notes\n";
    const auto is_warning = [](const std::string& note) { return warning_in(note).has_value(); };
    std::vector<std::string> notes = scene.notes;
    std::stable_partition(notes.begin(), notes.end(), is_warning);
    for (const std::string& note : notes) out += "  - " + note + "\n";
    return out;
}

}  // namespace talus::scene
