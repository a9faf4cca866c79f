#include "scene_folder.hpp"

#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "products/text_file.hpp"

namespace talus::embed {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view terrain_file = "terrain.tif", release_file = "release.tif",
                           buildings_file = "buildings.gpkg";

Result<GridGeometry> geometry_of(const talus_grid& grid) {
    constexpr std::int32_t most = 1 << 20;
    if (!(grid.cell > 0)) return Error{fmt::format("grid.cell = {}: must be above 0", grid.cell)};
    for (const auto& [name, count] : {std::pair{"columns", grid.columns}, std::pair{"rows", grid.rows}}) {
        if (count < 2 || count > most) return Error{fmt::format("grid.{} = {}: must be 2 to {}", name, count, most)};
    }
    return GridGeometry{grid.x_min, grid.y_min, grid.cell, grid.columns, grid.rows};
}

Status write_raster(const fs::path& file, const GridGeometry& geometry, const float* values, const char* what,
                    const geo::Crs& crs) {
    if (values == nullptr) return Error{fmt::format("{} is NULL", what)};
    Grid<float> grid(geometry);
    grid.values.assign(values, values + geometry.size());
    return geo::write_cog(file.string(), {&grid, what, "m"}, crs);
}

Status write_buildings(const fs::path& file, const talus_arrays& arrays, const geo::Crs& crs) {
    std::vector<geo::OutputFeature> features;
    for (std::size_t k = 0; k < arrays.building_count; ++k) {
        const talus_building& building = arrays.buildings[k];
        if (building.x_y == nullptr || building.point_count < 3) {
            return Error{fmt::format("buildings[{}].point_count = {}: an outline has at least 3 corners", k,
                                     building.x_y == nullptr ? 0 : building.point_count)};
        }
        Ring outline;
        for (std::size_t i = 0; i < building.point_count; ++i) {
            outline.push_back({building.x_y[2 * i], building.x_y[2 * i + 1]});
        }
        const std::string name = building.name != nullptr ? building.name : fmt::format("building {}", k + 1);
        features.push_back({{{std::move(outline), {}}}, {}, {name, building.height}});
    }
    return geo::write_geopackage_layer(file.string(), "buildings", {{"name", true}, {"height_m", false}}, features,
                                       crs);
}

Status write_files(const talus_arrays& arrays, const fs::path& folder, const fs::path& scene_file) {
    if (arrays.crs == nullptr) return Error{"crs is NULL"};
    TALUS_ASSIGN(const geo::Crs crs, geo::crs_from_text(arrays.crs));
    TALUS_ASSIGN(const GridGeometry geometry, geometry_of(arrays.grid));
    TALUS_TRY(write_raster(folder / terrain_file, geometry, arrays.elevation, "elevation", crs));
    TALUS_TRY(write_raster(folder / release_file, geometry, arrays.release, "release", crs));
    std::string text = fmt::format(
        "[scene]\ntitle = \"from arrays\"\n\n[terrain]\nfile = \"{}\"\n\n"
        "[[release]]\nname = \"release\"\nthickness_raster = \"{}\"\nthickness_direction = \"vertical\"\n",
        terrain_file, release_file);
    if (arrays.building_count > 0) {
        if (arrays.buildings == nullptr) return Error{"buildings is NULL"};
        TALUS_TRY(write_buildings(folder / buildings_file, arrays, crs));
        text += fmt::format(
            "\n[buildings]\nfile = \"{}\"\nlayer = \"buildings\"\nheight_attribute = \"height_m\"\nname_attribute = "
            "\"name\"\n",
            buildings_file);
    }
    return products::write_text_file(scene_file, text);
}

}  // namespace

Result<fs::path> write_scene_folder(const talus_arrays& arrays, const fs::path& folder) {
    std::error_code error;
    const bool made = fs::create_directories(folder, error);
    if (error) return Error{fmt::format("{}: cannot be created: {}", folder.string(), error.message())};
    if (!fs::is_empty(folder, error) || error) return Error{folder.string() + ": is not empty"};
    const fs::path scene_file = folder / "scene.toml";
    if (Status written = write_files(arrays, folder, scene_file); !written) {
        for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) fs::remove_all(entry, error);
        if (made) fs::remove(folder, error);
        return Error{written.error().message};
    }
    return scene_file;
}

}  // namespace talus::embed
