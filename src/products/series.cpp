#include "products/series.hpp"

#include <algorithm>
#include <array>
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

/// What a format writes.
struct SeriesFiles {
    std::string_view format;
    std::array<std::string_view, 3> files;
};
/// In the order in which they are written.
constexpr std::array<SeriesFiles, 6> series_files = {{{"geotiff", {"depth.tif", "speed.tif", "pressure.tif"}},
                                                      {"netcdf", {"maps.nc"}},
                                                      {"gltf", {"run.glb"}},
                                                      {"3dtiles", {"tileset.json", "run.glb"}},
                                                      {"usd", {"run.usda"}},
                                                      {"paraview", {"paraview"}}}};

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

/// Nearly all of the work of a format is done between the rows that it reads.
void Series::watch_rows(const Watch& watch) {
    frames_->watch([this, &watch]() -> Status {
        const double of_format = to_read_ > 0 ? std::min(1.0, read_++ / to_read_) : 0;
        const double share =
            (static_cast<double>(written_) + of_format) / static_cast<double>(scene_.spec.outputs.series.size());
        return watch(share) ? Status() : Status(Error{"the writing of the series was ended"});
    });
}

/// Rows of frames that a format reads: of a drawn one, depth and speed of the frames of its animation.
double Series::rows_of(const run::RunResult& result, const DebrisSurface* surface) const {
    const GridGeometry& map = result.observation.maps.peak_depth.geometry;
    if (surface == nullptr) return static_cast<double>(series_quantities.size() * frames_->times().size()) * map.rows;
    const GridGeometry& lattice = surface->lattice();
    return 2.0 * static_cast<double>(surface->animated().size()) * lattice.rows * lattice.cell / map.cell;
}

std::vector<std::string> Series::finish(const run::RunResult& result, const Watch& watch) {
    if (!frames_) return {};
    if (watch) watch_rows(watch);
    std::vector<std::string> missing;
    std::optional<DebrisSurface> surface;
    std::string no_surface;
    if (wants("gltf") || wants("3dtiles") || wants("usd") || wants("paraview")) {
        auto made = DebrisSurface::make(scene_.terrain, result.observation.maps.peak_depth, *frames_);
        if (made) {
            surface.emplace(std::move(*made));
        } else {
            no_surface = made.error().message;
        }
    }
    for (const SeriesFiles& one : series_files) {
        if (!wants(one.format)) continue;
        const bool drawn = one.format != "netcdf" && one.format != "geotiff";
        read_ = 0;
        to_read_ = rows_of(result, drawn && surface ? &*surface : nullptr);
        const Status written = drawn && !surface ? Status(Error{no_surface})
                                                 : write_format(one.format, result, surface ? &*surface : nullptr);
        ++written_;
        if (written) continue;
        missing.push_back(written.error().message);
        for (const std::string_view name : one.files) {
            const bool shared = name == "run.glb" && one.format == "3dtiles" && wants("gltf");
            std::error_code ignored;
            if (!name.empty() && !shared) std::filesystem::remove_all(folder_ / name, ignored);
        }
    }
    points_.reset();
    times_ = frames_->times();
    frames_.reset();
    return missing;
}

Status Series::write_format(std::string_view format, const run::RunResult& result, const DebrisSurface* surface) {
    if (surface == nullptr) return write_maps(result, format == "netcdf");
    const View view{scene_, result, *surface, frames_->times()};
    if (format == "netcdf" || format == "geotiff") return write_maps(result, format == "netcdf");
    if (format == "gltf") return write_glb(view, folder_ / "run.glb");
    if (format == "3dtiles") {
        if (!wants("gltf")) TALUS_TRY(write_glb(view, folder_ / "run.glb"));
        return write_tileset(view, folder_ / "tileset.json", "run.glb");
    }
    if (format == "usd") return write_usda(view, points_ ? &*points_ : nullptr, folder_ / "run.usda");
    if (particles_) TALUS_TRY(particles_->finish());
    return write_paraview_view(view, folder_ / "paraview", final_folder_ / "paraview");
}

Status Series::write_maps(const run::RunResult& result, bool netcdf) const {
    const GridGeometry& grid = result.observation.maps.peak_depth.geometry;
    std::vector<geo::RasterSeries> quantities;
    for (std::size_t k = 0; k < series_quantities.size(); ++k) quantities.push_back(quantity_of(*frames_, k, grid));
    geo::SeriesFile file{grid, frames_->times(), scene_.crs, origin_of(scene_, result)};
    if (netcdf) {
        file.metadata = plain_origin_of(scene_, result);
        return write_netcdf_series((folder_ / "maps.nc").string(), file, terrain_on(grid, scene_.terrain), quantities);
    }
    for (const geo::RasterSeries& quantity : quantities) {
        TALUS_TRY(write_cog_series((folder_ / (quantity.name + ".tif")).string(), file, quantity));
    }
    return {};
}

}  // namespace talus::products
