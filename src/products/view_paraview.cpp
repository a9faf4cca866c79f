#include "products/view.hpp"

#include <algorithm>
#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/try.hpp"
#include "paraview_files.hpp"
#include "products/text_file.hpp"
#include "products/vtk_file.hpp"

namespace talus::products {
namespace {

std::string colour_text(const report::Colour& colour) {
    return fmt::format("[{:.3f}, {:.3f}, {:.3f}]", colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
}

/// A plan direction from where debris came from to where it went; unit.
PlanPoint downhill(const View& view) {
    const observe::RunOut& run_out = view.result.observation.run_out;
    const double x = run_out.toe.x - run_out.crown.x, y = run_out.toe.y - run_out.crown.y, length = std::hypot(x, y);
    return length > 0 ? PlanPoint{x / length, y / length} : PlanPoint{0, -1};
}

/// Text as Python writes it.
std::string python_text(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

/// The script that opens everything, with the numbers of this run before it.
std::string script_text(const View& view, const std::filesystem::path& written_to) {
    const std::string script(paraview_files::view_paraview_py);
    const std::size_t imports_end = script.find("\n\n", script.find("from paraview"));
    const PlanPoint direction = downhill(view);
    return script.substr(0, imports_end) +
           fmt::format(
               "\n\nWRITTEN_TO = {}\nGREATEST_SPEED = {:.4g}  # m/s, of the whole run\nGROUND = {}\n"
               "DOWNHILL = [{:.3f}, {:.3f}]",
               python_text(written_to.string()), std::max(view.greatest_speed(), 0.01), colour_text(ground_colour),
               direction.x, direction.y) +
           script.substr(imports_end);
}

Status write_structures(const View& view, const std::filesystem::path& file) {
    TriangleMesh all;
    std::vector<std::uint32_t> rows;
    std::vector<std::uint8_t> hit, colours;
    std::vector<float> pressures;
    const auto& impacts = view.result.observation.buildings;
    for (const View::Structure& structure : view.structures()) {
        const observe::BuildingImpact impact =
            structure.index < impacts.size() ? impacts[structure.index] : observe::BuildingImpact{};
        for (std::size_t k = 0; k < structure.mesh.corners.size(); k += 3) {
            rows.push_back(static_cast<std::uint32_t>(structure.index));
            hit.push_back(impact.hit ? 1 : 0);
            pressures.push_back(static_cast<float>(impact.peak_impact_pressure / 1e3));
            colours.insert(colours.end(), {structure.colour.red, structure.colour.green, structure.colour.blue});
        }
        all.add(structure.mesh);
    }
    if (all.corners.empty()) return {};
    VtkPolyData data(all.points);
    data.on_cells("row_of_buildings_csv", rows)
        .on_cells("hit", hit)
        .on_cells("peak_impact_pressure_kPa", pressures)
        .on_cells("colour", colours, 3);
    return data.write_triangles(file, view.scene.terrain.frame().origin, {}, all.corners);
}

Status write_surfaces(const View& view, const std::filesystem::path& folder) {
    std::vector<VtkFrame> frames;
    for (std::size_t k = 0; k < view.times.size(); ++k) {
        TALUS_ASSIGN(const DebrisMesh mesh, view.surface.debris(k));
        const std::string name = fmt::format("surface_{:06}.vtp", k);
        VtkPolyData data(mesh.points);
        data.on_points("depth_m", mesh.depth).on_points("speed_mps", mesh.speed);
        TALUS_TRY(data.write_triangles(folder / name, view.scene.terrain.frame().origin, view.times[k], mesh.corners));
        frames.push_back({view.times[k], name});
    }
    return write_vtk_collection(folder / "surface.pvd", frames);
}

}  // namespace

Status write_paraview_view(const View& view, const std::filesystem::path& folder,
                           const std::filesystem::path& final_folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) return Error{fmt::format("{}: cannot be made: {}", folder.string(), failed.message())};
    const TriangleMesh ground = view.surface.ground();
    std::vector<float> elevations;
    const WorldPoint origin = view.scene.terrain.frame().origin;
    for (const LocalPoint& p : ground.points) elevations.push_back(p.z + static_cast<float>(origin.z));
    VtkPolyData terrain(ground.points);
    terrain.on_points("elevation_m", elevations);
    TALUS_TRY(terrain.write_triangles(folder / "terrain.vtp", origin, {}, ground.corners));
    TALUS_TRY(write_structures(view, folder / "structures.vtp"));
    TALUS_TRY(write_surfaces(view, folder));
    return write_text_file(folder / "run.py", script_text(view, final_folder));
}

}  // namespace talus::products
