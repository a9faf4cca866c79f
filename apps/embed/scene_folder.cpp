#include "scene_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "call.hpp"
#include "core/try.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "grid_geometry.hpp"
#include "products/text_file.hpp"

namespace talus::embed {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view terrain_file = "terrain.tif", release_file = "release.tif",
                           buildings_file = "buildings.gpkg";

constexpr float lowest_elevation = -12000, highest_elevation = 9000;  // m, as for rasters
constexpr double highest_building = 1000;                             // m, as buildings.default_height_m

/// `fits`: whether a value is one that `allowed` names.
template <class Fits>
Status check_values(const GridGeometry& geometry, const float* values, const char* what, const char* allowed,
                    const Fits& fits) {
    TALUS_TRY(need(values, what));
    const float* const end = values + geometry.size();
    const float* const wrong = std::find_if_not(values, end, fits);
    if (wrong == end) return {};
    const std::ptrdiff_t k = wrong - values;
    return Error{
        fmt::format("{}[{}, {}] = {}: must be {}", what, k / geometry.columns, k % geometry.columns, *wrong, allowed)};
}

Status check_rasters(const talus_arrays& arrays, const GridGeometry& geometry) {
    TALUS_TRY(check_values(geometry, arrays.elevation, "elevation", "-12000 to 9000 (m), or NaN where it is not known",
                           [](float z) { return std::isnan(z) || (z >= lowest_elevation && z <= highest_elevation); }));
    TALUS_TRY(check_values(geometry, arrays.release, "release", "a thickness in m, 0 or more",
                           [](float h) { return h >= 0 && !std::isinf(h); }));
    const auto any = [&](const float* values, const auto& is) {
        return std::any_of(values, values + geometry.size(), is);
    };
    if (!any(arrays.elevation, [](float z) { return !std::isnan(z); })) return Error{"elevation: is NaN everywhere"};
    if (!any(arrays.release, [](float h) { return h > 0; })) return Error{"release: is 0 everywhere"};
    return {};
}

Status write_raster(const fs::path& file, const GridGeometry& geometry, const float* values, const char* what,
                    const geo::Crs& crs) {
    Grid<float> grid(geometry);
    grid.values.assign(values, values + geometry.size());
    return geo::write_cog(file.string(), {&grid, what, "m"}, crs);
}

/// Buildings lie as far apart as their size says, which may be that of a later version.
Result<std::vector<talus_building>> buildings_of(const talus_arrays& arrays) {
    std::vector<talus_building> buildings;
    if (arrays.building_count == 0) return buildings;
    constexpr std::size_t most = 1'000'000;
    if (arrays.building_count > most) {
        return Error{fmt::format("building_count = {}: must be at most {}", arrays.building_count, most)};
    }
    TALUS_TRY(check_size(arrays.buildings, "buildings"));
    const auto* const bytes = reinterpret_cast<const std::byte*>(arrays.buildings);
    for (std::size_t k = 0; k < arrays.building_count; ++k) {
        const auto* const given = reinterpret_cast<const talus_building*>(bytes + k * arrays.buildings->size);
        if (given->size != arrays.buildings->size) {
            return Error{fmt::format("buildings[{}].size = {}: must be that of buildings[0], {}", k, given->size,
                                     arrays.buildings->size)};
        }
        buildings.push_back(*given);
    }
    return buildings;
}

Status check_building(const talus_building& building, std::size_t k) {
    constexpr std::size_t most_points = 1'000'000;
    TALUS_TRY(need(building.x_y, fmt::format("buildings[{}].x_y", k).c_str()));
    if (building.point_count < 3 || building.point_count > most_points) {
        return Error{fmt::format("buildings[{}].point_count = {}: an outline has 3 to {} corners", k,
                                 building.point_count, most_points)};
    }
    for (std::size_t i = 0; i < 2 * building.point_count; ++i) {
        if (!std::isfinite(building.x_y[i])) {
            return Error{fmt::format("buildings[{}].x_y[{}] = {}: must be a finite number", k, i, building.x_y[i])};
        }
    }
    if (!(building.height > 0 && building.height <= highest_building)) {
        return Error{fmt::format("buildings[{}].height = {}: must be greater than 0 and at most {} (m)", k,
                                 building.height, highest_building)};
    }
    return {};
}

Status write_buildings(const fs::path& file, const std::vector<talus_building>& buildings, const GridGeometry& grid,
                       const geo::Crs& crs) {
    std::vector<geo::OutputFeature> features;
    const double x_max = grid.x_min + grid.columns * grid.cell, y_max = grid.y_min + grid.rows * grid.cell;
    bool any_inside = false;
    for (std::size_t k = 0; k < buildings.size(); ++k) {
        const talus_building& building = buildings[k];
        TALUS_TRY(check_building(building, k));
        Ring outline;
        for (std::size_t i = 0; i < building.point_count; ++i) {
            const PlanPoint& p = outline.emplace_back(PlanPoint{building.x_y[2 * i], building.x_y[2 * i + 1]});
            any_inside = any_inside || (p.x >= grid.x_min && p.x <= x_max && p.y >= grid.y_min && p.y <= y_max);
        }
        const std::string name = building.name != nullptr ? building.name : fmt::format("building {}", k + 1);
        features.push_back({{{std::move(outline), {}}}, {}, {name, building.height}});
    }
    if (!any_inside) {
        return Error{fmt::format("buildings: none of {} has a corner on the grid, x {} to {}, y {} to {}",
                                 buildings.size(), grid.x_min, x_max, grid.y_min, y_max)};
    }
    return geo::write_geopackage_layer(file.string(), "buildings", {{"name", true}, {"height_m", false}}, features,
                                       crs);
}

Status write_files(const talus_arrays& arrays, const fs::path& folder, const fs::path& scene_file) {
    TALUS_TRY(need(arrays.crs, "crs"));
    TALUS_ASSIGN(const geo::Crs crs, geo::crs_from_text(arrays.crs));
    TALUS_ASSIGN(const GridGeometry geometry, geometry_of(arrays.grid, 2));
    TALUS_TRY(check_rasters(arrays, geometry));
    TALUS_ASSIGN(const std::vector<talus_building> buildings, buildings_of(arrays));
    TALUS_TRY(write_raster(folder / terrain_file, geometry, arrays.elevation, "elevation", crs));
    TALUS_TRY(write_raster(folder / release_file, geometry, arrays.release, "release", crs));
    std::string text = fmt::format(
        "[scene]\ntitle = \"from arrays\"\n\n[terrain]\nfile = \"{}\"\n\n"
        "[[release]]\nname = \"release\"\nthickness_raster = \"{}\"\nthickness_direction = \"vertical\"\n",
        terrain_file, release_file);
    if (!buildings.empty()) {
        TALUS_TRY(write_buildings(folder / buildings_file, buildings, geometry, crs));
        text += fmt::format(
            "\n[buildings]\nfile = \"{}\"\nlayer = \"buildings\"\nheight_attribute = \"height_m\"\nname_attribute = "
            "\"name\"\n",
            buildings_file);
    }
    return products::write_text_file(scene_file, text);
}

void replace_all(std::string& text, const std::string& from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
    }
}

}  // namespace

Result<SceneFolder> SceneFolder::write(const talus_arrays& arrays, const fs::path& folder) {
    std::error_code error;
    const fs::file_status there = fs::status(folder, error);
    if (fs::exists(there) && !fs::is_directory(there)) return Error{folder.string() + ": is not a folder"};
    const bool made = fs::create_directories(folder, error);
    if (error) return Error{fmt::format("{}: cannot be created: {}", folder.string(), error.message())};
    if (!fs::is_empty(folder, error) || error) return Error{folder.string() + ": is not empty"};
    SceneFolder written(folder, made);
    if (Status s = write_files(arrays, folder, written.scene_file()); !s) {
        return Error{written.in_words_of_arrays(s.error().message)};
    }
    return written;
}

SceneFolder::SceneFolder(SceneFolder&& other) noexcept
    : folder_(std::move(other.folder_)), made_(other.made_), temporary_(std::exchange(other.temporary_, false)) {}

SceneFolder::~SceneFolder() {
    std::error_code ignored;
    if (!temporary_) return;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) fs::remove_all(entry, ignored);
    if (made_) fs::remove(folder_, ignored);
}

fs::path SceneFolder::scene_file() const {
    return folder_ / "scene.toml";
}

std::string SceneFolder::in_words_of_arrays(std::string sentence) const {
    // Where in the scene file a key stands: its author is this library.
    const std::string scene = scene_file().string();
    for (std::size_t at = sentence.find(scene); at != std::string::npos; at = sentence.find(scene)) {
        std::size_t end = at + scene.size();
        if (end < sentence.size() && sentence[end] == ':') {
            end = sentence.find_first_not_of("0123456789", end + 1);
            if (end != std::string::npos && sentence[end] == ':') ++end;
            if (end != std::string::npos && sentence[end] == ' ') ++end;
        }
        sentence.erase(at, end == std::string::npos ? end : end - at);
    }
    for (const char* key :
         {"terrain.file: ", "release[0].thickness_raster: ", "buildings.file: ", "buildings.height_attribute: "}) {
        replace_all(sentence, key, "");
    }
    for (const auto& [file, name] : {std::pair{terrain_file, "elevation"}, std::pair{release_file, "release"},
                                     std::pair{buildings_file, "buildings"}}) {
        replace_all(sentence, (folder_ / file).string(), name);
    }
    return sentence;
}

}  // namespace talus::embed
