#include "scene/load.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "core/coordinate_text.hpp"
#include "core/decimals.hpp"
#include "core/hash.hpp"
#include "core/phases.hpp"
#include "core/try.hpp"
#include "geo/file_name.hpp"
#include "geo/orthophoto.hpp"
#include "geo/terrain_frame.hpp"
#include "scene/grid_cell.hpp"
#include "scene/limits.hpp"
#include "scene/options.hpp"
#include "scene/output_defaults.hpp"
#include "scene/particle_spacing.hpp"
#include "scene/plausibility.hpp"
#include "scene/suspect_ground.hpp"
#include "scene/viscosity_limit.hpp"
#include "scene/warning.hpp"

namespace talus::scene {
namespace {

/// "scene.toml" in the folder "valley" is called valley, "valley.toml" too.
std::string title_from(const std::filesystem::path& file) {
    std::string stem = file.stem().string();
    if (stem != "scene") return stem;
    const std::string folder = std::filesystem::absolute(file).lexically_normal().parent_path().filename().string();
    return folder.empty() ? stem : folder;
}

void hash_file(InputFile& input) {
    std::ifstream in(input.path, std::ios::binary);
    std::vector<char> block(1 << 20);
    StateHash hash;
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0) {
        hash.add(block.data(), static_cast<std::size_t>(in.gcount()));
        input.bytes += static_cast<std::uint64_t>(in.gcount());
    }
    input.hash = to_hex(hash.value());
}

/// Adds `sign` times the depths of a raster, the mean over each cell, to the ground. No data counts as none.
Status add_depths(const ParsedScene& parsed, const std::string& key, const std::string& file, double sign,
                  geo::Raster& ground, Scene& scene) {
    if (file.empty()) return {};
    const Result<geo::Raster> depths = read_value_raster(file, ground.crs);
    if (!depths) return Error{parsed.at("terrain." + key) + ": " + depths.error().message};
    record_input("terrain " + key, file, scene);
    const GridGeometry& g = ground.grid.geometry;
    const int parts = std::clamp(static_cast<int>(std::ceil(g.cell / depths->grid.geometry.cell - 1e-6)), 1, 64);
    double volume = 0;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            double sum = 0;
            for (int k = 0; k < parts * parts; ++k) {
                const int column_part = k % parts, row_part = k / parts;
                const double east = (column_part + 0.5) / parts, north = (row_part + 0.5) / parts;
                const float depth =
                    value_at(depths->grid, {g.x_min + (column + east) * g.cell, g.y_min + (row + north) * g.cell});
                if (depth > 0) sum += depth;
            }
            const double depth = sum / (parts * parts);
            ground.grid.at(column, row) += static_cast<float>(sign * depth);
            volume += depth * g.cell * g.cell;
        }
    }
    if (!(volume > 0)) {
        return Error{fmt::format("{}: {}: has no depth above 0 on the terrain", parsed.at("terrain." + key), file)};
    }
    scene.notes.push_back(fmt::format("terrain: {} by {:.6g} m3 of {}", sign > 0 ? "raised" : "lowered", volume, key));
    return {};
}

}  // namespace

bool follows_debris(const Scene& scene) {
    const params::SceneSpec& s = scene.spec;
    return scene.flow_path_origin == PathOrigin::traced && s.observations.empty() && s.superelevations.empty() &&
           s.arrivals.empty() && s.observed_run_outs.empty() &&
           std::all_of(s.gauges.begin(), s.gauges.end(), [](const auto& gauge) { return !gauge.chainage; });
}

double total_volume(const Scene& scene) {
    double volume = 0;
    for (const terrain::Release& release : scene.releases) volume += release.volume;
    for (const terrain::Inflow& inflow : scene.inflows) volume += inflow.volume();
    return volume;
}

void note_terrain_file(const geo::TerrainFrame& frame, Scene& scene) {
    if (frame.eight_bit) {
        scene.notes.emplace_back(
            "terrain: the file holds 8-bit numbers, of which there are 256: these are rarely elevations; if it is a "
            "hillshade or another picture, use the raster of elevations that it was made from");
    }
    if (frame.holes_read_0) {
        scene.notes.emplace_back(
            "terrain: parts of the file are holes, which were never written, and it declares no nodata value: they are "
            "read as 0 m");
    }
}

Status load_terrain(const ParsedScene& parsed, Scene& scene) {
    const params::TerrainSpec& spec = parsed.spec.terrain;
    const bool local = spec.crs == params::CrsChoice::local;
    Result<geo::Raster> raster = geo::read_terrain_raster(spec.file, spec.band, spec.extent, local);
    if (!raster) {
        std::string message = parsed.at("terrain.file") + ": " + raster.error().message;
        std::error_code code;
        if (!spec.obtain.empty() && !std::filesystem::exists(spec.file, code)) {
            message += "; to obtain the file: " + spec.obtain;
        }
        return Error{message};
    }
    record_input("terrain", spec.file, scene);
    TALUS_ASSIGN(const geo::TerrainFrame frame, geo::read_terrain_frame(spec.file, spec.band, local));
    note_terrain_file(frame, scene);
    scene.crs = raster->crs;
    scene.vertical_unit = raster->vertical_unit;
    scene.nodata_share = raster->nodata_share;
    if (scene.crs.local) {
        scene.notes.emplace_back(
            "terrain: local coordinates, whose place on the globe is not known: results.kml is left out, and "
            "stac_item.json states no place");
    }
    if (scene.vertical_unit == "not stated") {
        scene.notes.emplace_back("terrain: the file does not state its vertical unit, taken as metres");
    }
    if (scene.nodata_share > 0) {
        scene.notes.push_back(
            fmt::format("terrain: {:.2g} % of it has no data; debris that gets there has left the terrain",
                        100 * scene.nodata_share));
    }
    TALUS_TRY(add_depths(parsed, "deposit", spec.deposit, 1, *raster, scene));
    TALUS_TRY(add_depths(parsed, "erosion", spec.erosion, -1, *raster, scene));
    scene.terrain = terrain::Terrain(std::move(raster->grid));
    if (!spec.orthophoto.empty()) {
        const Extent extent = scene.terrain.elevation().geometry.extent();
        if (Status s = check_orthophoto(spec.orthophoto, scene.crs, extent); !s) {
            return Error{parsed.at("terrain.orthophoto") + ": " + s.error().message};
        }
    }
    return {};
}

Result<geo::PolygonLayer> load_polygons(const std::string& label, const std::string& file, const std::string& layer,
                                        Scene& scene) {
    TALUS_ASSIGN(geo::PolygonLayer read, geo::read_polygons(file, layer, scene.crs));
    record_input(label, file, scene);
    if (!read.reprojection.empty()) scene.notes.push_back(label + ": " + read.reprojection);
    if (read.closed_lines == 1) scene.notes.push_back(label + ": a closed line is taken as a polygon");
    if (read.closed_lines > 1) {
        scene.notes.push_back(fmt::format("{}: {} closed lines are taken as polygons", label, read.closed_lines));
    }
    return read;
}

void record_input(const std::string& role, const std::string& name, Scene& scene) {
    const std::string path = geo::file_on_disk(name);
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code)) return;  // a GDAL name such as /vsizip/...: nothing to hash
    hash_file(scene.inputs.emplace_back(InputFile{role, path, 0, ""}));
    std::filesystem::path companion = path;
    if (companion.extension() != ".shp") return;
    for (const char* extension : {".dbf", ".shx", ".prj", ".cpg"}) {
        companion.replace_extension(extension);
        if (!std::filesystem::is_regular_file(companion, code)) continue;
        hash_file(scene.inputs.emplace_back(InputFile{role + " (" + extension + ")", companion.string(), 0, ""}));
    }
}

std::string place_text(const PlanPoint& p) {
    const double size = std::max(std::abs(p.x), std::abs(p.y));
    const int decimals = decimals_for(size, 1);
    if (decimals > 1) return fmt::format("({:.{}f}, {:.{}f})", p.x, decimals, p.y, decimals);
    return fmt::format("({}, {})", coordinate_text(p.x), coordinate_text(p.y));
}

std::string extent_text(const Extent& e) {
    return fmt::format("x {} to {}, y {} to {}", coordinate_text(e.x_min), coordinate_text(e.x_max),
                       coordinate_text(e.y_min), coordinate_text(e.y_max));
}

Extent covered_extent(const terrain::Terrain& terrain) {
    return terrain.elevation().geometry.extent().grown(-terrain.cell() / 2);
}

/// What the result of a single run leaves open.
void note_solid_fraction(Scene& scene) {
    const params::MaterialSpec& material = scene.spec.material;
    if (material.pore_pressure != params::PorePressure::dilatancy || !material.solid_fraction) return;
    scene.notes.push_back(as_warning(fmt::format(
        "a solid fraction is known to 0.02 at best, and decides whether debris liquefies or stiffens: a single run "
        "with "
        "material.solid_fraction = {:.4g} says little; run the ensemble --vary material.solid_fraction={:.4g}:{:.4g}",
        *material.solid_fraction, *material.solid_fraction - 0.02, *material.solid_fraction + 0.02)));
}

Result<Scene> assemble_scene(const ParsedScene& parsed) {
    Scene scene;
    scene.file = parsed.file;
    scene.spec = parsed.spec;
    for (const auto& [key, place] : parsed.places) {
        if (key.find('.') != std::string::npos) scene.given_keys.insert(key);  // the others are sections
    }
    if (scene.spec.scene.title.empty()) scene.spec.scene.title = title_from(parsed.file);
    record_input("scene", parsed.file.string(), scene);
    TALUS_TRY(load_terrain(parsed, scene));
    TALUS_TRY(load_zones(parsed, scene));
    TALUS_TRY(load_releases(parsed, scene));
    TALUS_TRY(load_bed(parsed, scene));
    TALUS_TRY(load_inflows(parsed, scene));
    TALUS_TRY(settle_layers(parsed, scene));
    const bool particles = scene.spec.solver.model == params::ModelChoice::particles;
    const auto broken = too_viscous(scene.spec.material, scene.spec.solver, particle_spacing(scene));
    if (broken && particles) {
        return Error{parsed.at("material." + broken->key) + broken->text};
    }
    TALUS_TRY(load_buildings(parsed, scene));
    TALUS_TRY(load_barriers(parsed, scene));
    TALUS_TRY(load_flow_path(parsed, scene));
    shorten_outputs(scene);
    TALUS_TRY(load_observations(parsed, scene));
    TALUS_TRY(load_gauges(parsed, scene));
    TALUS_TRY(load_cross_sections(parsed, scene));
    TALUS_TRY(load_zoom(parsed, scene));
    TALUS_TRY(check_alerts(parsed, scene));
    TALUS_TRY(particles ? check_limits(parsed, scene) : check_depth_averaged(parsed, scene));
    TALUS_TRY(apply_option(parsed, scene));
    note_solid_fraction(scene);
    settle_geoid_height(scene);
    const ReachableGround reachable =
        reachable_ground(scene.terrain, scene.releases, travel_angle_deg / degrees_per_radian);
    TALUS_TRY(check_missing_data(parsed, reachable, scene));
    note_implausible_terrain(reachable, scene);
    if (particles) {
        note_coarse_particles(scene);
        note_unused_by_particles(scene);
    }
    return Result<Scene>(std::move(scene));
}

Result<Scene> load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    const StopWatch watch;
    TALUS_ASSIGN(ParsedScene parsed, parse_scene_with_places(file, overrides));
    TALUS_ASSIGN(Scene scene, assemble_scene(parsed));
    scene.load_time = watch.seconds();
    return Result<Scene>(std::move(scene));
}

}  // namespace talus::scene
