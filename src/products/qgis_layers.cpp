// What the layer definition has beside the maps and vectors of a run: the ground below them, and maps over time.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/raster.hpp"
#include "products/series_frames.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"

namespace talus::products {
namespace {

/// The cells of a grid in a place and around it: half its size on every side, so that a map shows where it lies.
Grid<float> cells_around(const Grid<float>& grid, const Extent& place) {
    const GridGeometry& whole = grid.geometry;
    const double margin = 0.5 * std::max(place.x_max - place.x_min, place.y_max - place.y_min) + 20 * whole.cell;
    const auto index = [&whole](double distance, int count) {
        return static_cast<int>(std::clamp(std::floor(distance / whole.cell), 0.0, static_cast<double>(count)));
    };
    const int west = index(place.x_min - margin - whole.x_min, whole.columns - 1);
    const int south = index(place.y_min - margin - whole.y_min, whole.rows - 1);
    const int east = std::max(west + 1, index(place.x_max + margin - whole.x_min, whole.columns));
    const int north = std::max(south + 1, index(place.y_max + margin - whole.y_min, whole.rows));
    Grid<float> part(GridGeometry{whole.x_min + west * whole.cell, whole.y_min + south * whole.cell, whole.cell,
                                  east - west, north - south});
    for (int row = 0; row < part.geometry.rows; ++row) {
        const float* from = &grid.at(west, south + row);
        std::copy(from, from + part.geometry.columns, &part.at(0, row));
    }
    return part;
}

/// The map of peaks whose colours a quantity over time has.
const report::HazardMap& peak_map_of(const SeriesQuantity& quantity) {
    const auto& maps = report::hazard_maps();
    return *std::find_if(maps.begin(), maps.end(), [&](const report::HazardMap& map) {
        return map.file == std::string("peak_") + quantity.name;
    });
}

}  // namespace

void add_terrain(const scene::Scene& scene, const Extent& place, const std::filesystem::path& folder,
                 LayerDefinition& layers, std::vector<WriteJob>& jobs) {
    const std::string style = report::qgis_hillshade_style();
    layers.add_raster("Terrain, hillshade", "terrain.tif", style, true);
    jobs.push_back({"terrain", [&scene, place, folder, style]() -> Status {
                        const Grid<float> elevation = cells_around(scene.terrain.elevation(), place);
                        const std::string stem = (folder / "terrain").string();
                        TALUS_TRY(write_cog(stem + ".tif", {&elevation, "elevation of the terrain", "m"}, scene.crs));
                        return write_text_file(stem + ".qml", style);
                    }});
}

void add_maps_over_time(const scene::Scene& scene, const run::RunResult& result, const std::vector<double>& times,
                        const std::filesystem::path& folder, LayerDefinition& layers) {
    // A format that could not be written has left nothing.
    const auto has = [&](const std::string& file) {
        std::error_code ignored;
        return std::filesystem::exists(folder / "series" / file, ignored);
    };
    const bool netcdf = has("maps.nc");
    if (times.empty()) return;
    constexpr std::size_t most = 100;  // QGIS opens each as a layer
    const std::size_t step = (times.size() + most - 1) / most;
    const double interval = scene.spec.outputs.series_interval;
    for (const SeriesQuantity& quantity : series_quantities) {
        const std::string geotiff = quantity.name + std::string(".tif");
        const bool in_geotiff = has(geotiff);
        if (!in_geotiff && !netcdf) continue;
        const report::HazardMap& map = peak_map_of(quantity);
        const double greatest = report::greatest(result.observation.maps.*map.grid) * map.factor;
        std::vector<LayerDefinition::Frame> frames;
        for (std::size_t k = 0; k < times.size(); k += step) {
            frames.push_back(
                {fmt::format("{} s", std::round(100 * times[k]) / 100),
                 in_geotiff ? "./series/" + geotiff : fmt::format("NETCDF:\"./series/maps.nc\":{}", quantity.name),
                 qgis_style(map, greatest, k + 1), times[k],
                 k + step < times.size() ? times[k + step] : times.back() + interval});
        }
        std::string title = quantity.name;
        title.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(title.front())));
        layers.add_over_time(title + " over time", frames);
    }
}

}  // namespace talus::products
