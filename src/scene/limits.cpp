#include "scene/limits.hpp"

#include <algorithm>
#include <cmath>
#include <unistd.h>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/earth_fixed.hpp"
#include "scene/particle_spacing.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/map_cell.hpp"
#include "terrain/wall_effort.hpp"

namespace talus::scene {
namespace {

constexpr double max_map_cells = 4e8, max_front_rows = 1e6;
constexpr double max_series_frames = 10000, max_series_values = 1e10;
constexpr double max_cells_per_spacing = 50;
/// Of overlapping buildings and barriers, by an estimate that is some five times too high: half a gigabyte.
constexpr double max_wall_pieces = 5e7;
/// Measured with 20 million cells (docs/performance.md).
constexpr double bytes_per_terrain_cell = 20;

/// A key and the value in force: "scene.toml:12: outputs.map_cell_m = 0.01".
std::string key_with_value(const ParsedScene& parsed, const char* section, const char* key, double value) {
    return fmt::format("{} = {:.6g}", parsed.at(fmt::format("{}.{}", section, key)), value);
}

const char* thickness_key(const params::ReleaseSpec& spec) {
    if (spec.volume) return "volume_m3";
    return spec.thickness_attribute.empty() ? "thickness_raster" : "thickness_attribute";
}

/// However thickness is given, its mean must be at least the minimum of thickness_m: thinner debris would need
/// particles too small and too many.
Status check_thickness(const ParsedScene& parsed, const Scene& scene) {
    const double thinnest = params::parameter_of("release", "thickness_m").range.low;
    for (std::size_t i = 0; i < scene.releases.size(); ++i) {
        const terrain::Release& release = scene.releases[i];
        const double area = release_slope_area(scene.terrain, release);
        if (release.spec.thickness || release.volume >= thinnest * area) continue;
        return Error{
            fmt::format("{}: release \"{}\" of {:.4g} m3 over {:.4g} m2 of slope is {:.4g} m thick on average; "
                        "it must be at least {} m",
                        parsed.at(fmt::format("release[{}].{}", i, thickness_key(release.spec))), release.name,
                        release.volume, area, release.volume / area, thinnest)};
    }
    return {};
}

Status check_particles(const ParsedScene& parsed, const Scene& scene, double spacing) {
    const params::SolverSpec& solver = scene.spec.solver;
    const params::Range& allowed = params::parameter_of("solver", "particle_spacing_m").range;
    if (!allowed.contains(spacing)) {
        return Error{fmt::format("{} is refused; it puts the particles of {:.4g} m3 {:.4g} m apart, which must be {} m",
                                 fmt::format("{} = {:.6g}", parsed.at(spacing_key(solver)),
                                             solver.target_layers.value_or(solver.target_particle_count.value_or(
                                                 params::SolverSpec::usual_particle_count))),
                                 total_volume(scene), spacing, allowed.text())};
    }
    const Status counted = sim::check_particle_count(scene.releases, scene.inflows, solver, spacing);
    if (counted) return {};
    return Error{parsed.at(spacing_key(solver)) + ": " + counted.error().message};
}

Status check_outputs(const ParsedScene& parsed, const Scene& scene, double spacing) {
    const params::OutputSpec& outputs = scene.spec.outputs;
    const Extent extent = scene.terrain.elevation().geometry.extent();
    const double area = extent.width() * extent.height();
    const double cell = outputs.map_cell.value_or(terrain::default_map_cell(scene.terrain.cell(), spacing));
    if (area / (cell * cell) > max_map_cells) {
        return Error{
            fmt::format("{} is refused; maps of the terrain would have {:.3g} cells, and may have {:.3g}: it "
                        "must be at least {:.3g} (m)",
                        key_with_value(parsed, "outputs", "map_cell_m", cell), area / (cell * cell), max_map_cells,
                        std::ceil(1e3 * std::sqrt(area / max_map_cells)) / 1e3)};
    }
    if (cell < spacing / max_cells_per_spacing) {
        return Error{
            fmt::format("{} is refused; particles {:.4g} m apart would cover too many cells in every step: it "
                        "must be at least {:.3g} (m)",
                        key_with_value(parsed, "outputs", "map_cell_m", cell), spacing,
                        std::ceil(1e3 * spacing / max_cells_per_spacing) / 1e3)};
    }
    const double length = scene.flow_path.empty() ? 0 : scene.flow_path.length();
    if (length / outputs.chainage_interval > max_front_rows) {
        return Error{fmt::format("{} is refused; on a flow path of {:.0f} m it must be at least {:.3g} (m)",
                                 key_with_value(parsed, "outputs", "chainage_interval_m", outputs.chainage_interval),
                                 length, length / max_front_rows)};
    }
    return check_series(parsed, scene, cell, total_volume(scene) / (spacing * spacing * spacing));
}

Status check_walls(const ParsedScene& parsed, const Scene& scene) {
    const double pieces = terrain::WallEffort(scene.buildings, 0).pieces();
    if (pieces <= max_wall_pieces) return {};
    return Error{
        fmt::format("{}: {} buildings and barriers overlap so much that their walls would be cut into up to {:.2g} "
                    "pieces, and may be cut into {:.2g}; place them apart",
                    parsed.file.string(), scene.buildings.size(), pieces, max_wall_pieces)};
}

Status check_memory(const ParsedScene& parsed, const Scene& scene, double spacing) {
    const double particles = total_volume(scene) / (spacing * spacing * spacing);
    const double needed = memory_needed(scene, particles);
    const double there = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
    if (!(there > 0) || needed <= there) return {};
    constexpr double gigabyte = 1e9;
    return Error{fmt::format(
        "{}: {:.3g} particles {:.4g} m apart need about {:.3g} GB of memory, and this machine has "
        "{:.3g} GB; a larger spacing needs less",
        parsed.at(spacing_key(scene.spec.solver)), particles, spacing, needed / gigabyte, there / gigabyte)};
}

}  // namespace

double memory_needed(const Scene& scene, double particles) {
    return particles * bytes_per_particle +
           static_cast<double>(scene.terrain.elevation().geometry.size()) * bytes_per_terrain_cell;
}

Status check_series(const ParsedScene& parsed, const Scene& scene, double cell, double particles) {
    const params::OutputSpec& outputs = scene.spec.outputs;
    if (outputs.series.empty()) return {};
    const bool on_globe = std::find(outputs.series.begin(), outputs.series.end(), "3dtiles") != outputs.series.end();
    if (on_globe && !geo::earth_fixed(scene.crs, scene.terrain.frame().origin)) {
        return Error{fmt::format(
            "{}: \"3dtiles\" is refused; where on the globe the terrain's reference system ({}) lies is not known",
            parsed.at("outputs.series"), scene.crs.label())};
    }
    const Extent extent = scene.terrain.elevation().geometry.extent();
    const double cells = extent.width() * extent.height() / (cell * cell);
    const double end = scene.spec.solver.end_time, frames = end / outputs.series_interval + 1;
    const double most = std::min(max_series_frames, max_series_values / std::max(cells, particles));
    if (frames <= most) return {};
    return Error{fmt::format(
        "{} is refused; up to solver.end_time_s = {:.6g} these are {:.0f} frames of up to {:.3g} map cells{}, "
        "and there may be {:.0f}: it must be at least {:.3g} (s)",
        key_with_value(parsed, "outputs", "series_interval_s", outputs.series_interval), end, std::floor(frames), cells,
        particles > 0 ? fmt::format(" and {:.3g} particles", particles) : "", std::floor(most),
        std::ceil(1e3 * end / std::max(1.0, most - 1)) / 1e3)};
}

/// The places of tracks are in memory until the end.
Status check_tracks(const ParsedScene& parsed, const Scene& scene) {
    constexpr double most = 1e8;  // 4 GiB
    const params::OutputSpec& outputs = scene.spec.outputs;
    const double frames = scene.spec.solver.end_time / outputs.series_interval + 1;
    if (outputs.tracks * frames <= most) return {};
    return Error{fmt::format(
        "{} is refused; with a place every outputs.series_interval_s = {:.6g} up to solver.end_time_s = {:.6g} it must "
        "be at most {:.0f}",
        key_with_value(parsed, "outputs", "tracks", outputs.tracks), outputs.series_interval,
        scene.spec.solver.end_time, std::floor(most / frames))};
}

Status check_limits(const ParsedScene& parsed, const Scene& scene) {
    const double spacing = particle_spacing(scene);
    TALUS_TRY(check_thickness(parsed, scene));
    TALUS_TRY(check_particles(parsed, scene, spacing));
    TALUS_TRY(check_outputs(parsed, scene, spacing));
    TALUS_TRY(check_tracks(parsed, scene));
    TALUS_TRY(check_walls(parsed, scene));
    return check_memory(parsed, scene, spacing);
}

}  // namespace talus::scene
