#include "products/series.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/raster_series.hpp"
#include "products/view.hpp"
#include "products/writers.hpp"

namespace talus::products {
namespace {

/// Elevations at the centres of the cells; NaN: unknown.
Grid<float> terrain_on(const GridGeometry& geometry, const terrain::Terrain& terrain) {
    Grid<float> heights(geometry);
    for (int row = 0; row < geometry.rows; ++row) {
        for (int column = 0; column < geometry.columns; ++column) {
            heights.at(column, row) = static_cast<float>(terrain.elevation_at(geometry.centre(column, row)));
        }
    }
    return heights;
}

geo::RasterSeries quantity_of(const SeriesFrames& frames, std::size_t k, const GridGeometry& grid) {
    const SeriesQuantity& quantity = series_quantities[k];
    return {quantity.name, quantity.description, quantity.unit,
            [&frames, k, grid](std::size_t frame, int row, float* values) {
                return frames.read(k, frame, grid, row, values);
            }};
}

}  // namespace

Series::Series(const scene::Scene& scene, std::filesystem::path folder, std::filesystem::path final_folder)
    : scene_(scene),
      folder_(std::move(folder)),
      final_folder_(final_folder.empty() ? folder_ : std::move(final_folder)) {}

bool Series::wants(std::string_view format) const {
    const auto& formats = scene_.spec.outputs.series;
    return std::find(formats.begin(), formats.end(), format) != formats.end();
}

Status Series::add(const run::Frame& frame) {
    if (!frames_) {
        std::error_code failed;
        std::filesystem::create_directories(folder_, failed);
        if (failed) return Error{fmt::format("{}: cannot be made: {}", folder_.string(), failed.message())};
        frames_.emplace(folder_ / ".frames");
        if (wants("paraview") && frame.particles != nullptr) particles_.emplace(folder_ / "paraview");
        if (wants("usd") && frame.particles != nullptr) points_.emplace(folder_ / ".points");
    }
    if (particles_) TALUS_TRY(particles_->write_frame(*frame.frame, *frame.particles));
    if (points_) TALUS_TRY(points_->add(*frame.particles));
    return frames_->add(frame, scene_.spec.material.rest_density);
}

Status Series::finish(const run::RunResult& result) {
    if (!frames_) return {};
    if (particles_) TALUS_TRY(particles_->finish());
    TALUS_TRY(write_maps(result));
    TALUS_TRY(write_views(result));
    points_.reset();
    times_ = frames_->times();
    frames_.reset();
    return {};
}

Status Series::write_maps(const run::RunResult& result) const {
    if (!wants("geotiff") && !wants("netcdf")) return {};
    const GridGeometry& grid = result.observation.maps.peak_depth.geometry;
    std::vector<geo::RasterSeries> quantities;
    for (std::size_t k = 0; k < series_quantities.size(); ++k) quantities.push_back(quantity_of(*frames_, k, grid));
    geo::SeriesFile file{grid, frames_->times(), scene_.crs, origin_of(scene_, result)};
    if (wants("geotiff")) {
        for (const geo::RasterSeries& quantity : quantities) {
            TALUS_TRY(write_cog_series((folder_ / (quantity.name + ".tif")).string(), file, quantity));
        }
    }
    if (!wants("netcdf")) return {};
    file.metadata = plain_origin_of(scene_, result);
    return write_netcdf_series((folder_ / "maps.nc").string(), file, terrain_on(grid, scene_.terrain), quantities);
}

Status Series::write_views(const run::RunResult& result) const {
    if (!wants("gltf") && !wants("3dtiles") && !wants("usd") && !wants("paraview")) return {};
    TALUS_ASSIGN(const DebrisSurface surface,
                 DebrisSurface::make(scene_.terrain, result.observation.maps.peak_depth, *frames_));
    const View view{scene_, result, surface, frames_->times()};
    if (wants("gltf") || wants("3dtiles")) TALUS_TRY(write_glb(view, folder_ / "run.glb"));
    if (wants("3dtiles")) TALUS_TRY(write_tileset(view, folder_ / "tileset.json", "run.glb"));
    if (wants("usd")) TALUS_TRY(write_usda(view, points_ ? &*points_ : nullptr, folder_ / "run.usda"));
    return wants("paraview") ? write_paraview_view(view, folder_ / "paraview", final_folder_ / "paraview") : Status();
}

}  // namespace talus::products
