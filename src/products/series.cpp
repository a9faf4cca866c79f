#include "products/series.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/raster_series.hpp"
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

Series::Series(const scene::Scene& scene, std::filesystem::path folder) : scene_(scene), folder_(std::move(folder)) {}

bool Series::wants(const char* format) const {
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
    }
    if (particles_) TALUS_TRY(particles_->write_frame(*frame.frame, *frame.particles));
    return frames_->add(frame, scene_.spec.material.rest_density);
}

Status Series::finish(const run::RunResult& result) {
    if (!frames_) return {};
    if (particles_) TALUS_TRY(particles_->finish());
    const GridGeometry& grid = result.observation.maps.peak_depth.geometry;
    std::vector<geo::RasterSeries> quantities;
    for (std::size_t k = 0; k < series_quantities.size(); ++k) quantities.push_back(quantity_of(*frames_, k, grid));
    geo::SeriesFile file{grid, frames_->times(), scene_.crs, origin_of(scene_, result)};
    if (wants("geotiff")) {
        for (const geo::RasterSeries& quantity : quantities) {
            TALUS_TRY(write_cog_series((folder_ / (quantity.name + ".tif")).string(), file, quantity));
        }
    }
    if (wants("netcdf")) {
        // Names of the conventions, for programs that show where a file is from.
        for (auto& [key, value] : file.metadata) {
            if (key == "TIFFTAG_SOFTWARE") key = "source";
            std::transform(key.begin(), key.end(), key.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        }
        TALUS_TRY(
            write_netcdf_series((folder_ / "maps.nc").string(), file, terrain_on(grid, scene_.terrain), quantities));
    }
    frames_.reset();
    return {};
}

}  // namespace talus::products
