#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "geo/raster.hpp"
#include "params/spec.hpp"
#include "scene/bed_layer.hpp"
#include "scene/zone.hpp"
#include "terrain/bed.hpp"
#include "terrain/buildings.hpp"
#include "terrain/cross_section.hpp"
#include "terrain/flow_path.hpp"
#include "terrain/gauge.hpp"
#include "terrain/ground_cover.hpp"
#include "terrain/inflow.hpp"
#include "terrain/release.hpp"
#include "terrain/terrain.hpp"

namespace talus::scene {

/// A file that the scene read.
struct InputFile {
    std::string role;  ///< "terrain", "release head scarp", ...
    std::string path;
    std::uint64_t bytes = 0;
    std::string hash;  ///< FNV-1a 64, hexadecimal
};

/// Where the flow path comes from: the scene's file, a trace downhill before the run, or the debris of a run.
enum class PathOrigin { file, traced, followed };

/// The release or inflow whose thickness `solver.target_layers` counts.
struct ThinnestSource {
    std::string name;      ///< with its kind: `release "scar"`
    double thickness = 0;  ///< mean, normal to the slope, m
};

/// A scene file with all its inputs loaded, checked and transformed to the terrain's CRS.
struct Scene {
    std::filesystem::path file;
    params::SceneSpec spec;
    std::set<std::string> given_keys;  ///< by file, variant or command line: "material.viscosity", "release[0].file"
    geo::Crs crs;
    std::string vertical_unit;
    double nodata_share = 0;
    terrain::Terrain terrain;
    std::vector<Zone> zones;
    terrain::GroundCover cover;          ///< of the zones
    std::vector<std::uint16_t> zone_at;  ///< by cell of the terrain, for display: 1 + the last zone there; 0: none
    std::vector<terrain::Release> releases;
    std::vector<BedLayer> bed_layers;
    terrain::Bed bed;  ///< of the layers
    std::vector<terrain::Inflow> inflows;
    std::optional<ThinnestSource> thinnest;     ///< where solver.target_layers is given
    std::vector<terrain::Building> buildings;   ///< barriers behind them
    std::vector<std::size_t> barrier_sections;  ///< of each barrier: index of its section
    terrain::FlowPath flow_path;
    PathOrigin flow_path_origin = PathOrigin::file;
    std::vector<terrain::Gauge> gauges;
    std::vector<terrain::CrossSection> cross_sections;
    std::optional<Polygon> zoom;                         ///< its area, with particles; nothing: no zoom
    std::vector<std::vector<Polygon>> deposit_outlines;  ///< as in SceneSpec::deposit_outlines
    std::vector<std::vector<Polygon>> affected_areas;    ///< as in SceneSpec::affected_areas
    std::vector<Grid<float>> elevation_changes;          ///< m; as in SceneSpec::elevation_changes
    std::vector<InputFile> inputs;
    std::vector<std::string> notes;  ///< what was done to the inputs: reprojections, defaults, traced path
    double load_time = 0;            ///< s of wall time that load_scene() took
};

/// Whether a run takes the path that debris followed in place of a traced one. Not if the chainages of observations
/// refer to that.
[[nodiscard]] bool follows_debris(const Scene& scene);

/// Takes the zoom out of a scene for a command that has none, with a note. `who`: "the live twin".
void leave_out_zoom(Scene& scene, const std::string& who);

/// Total volume of all releases and inflows, m3.
[[nodiscard]] double total_volume(const Scene& scene);

/// Reads a scene file, its values checked against the field table; relative paths are resolved against its folder,
/// `${NAME}` in a path against the environment. `overrides`: "section.key=value", applied after the file.
[[nodiscard]] Result<params::SceneSpec> parse_scene(const std::filesystem::path& file,
                                                    const std::vector<std::string>& overrides = {});

/// Loads everything that the scene names. Errors as listed at the readers, and: release outside the terrain or over
/// nodata, no thickness above zero, overlapping releases, buildings outside.
[[nodiscard]] Result<Scene> load_scene(const std::filesystem::path& file,
                                       const std::vector<std::string>& overrides = {});

}  // namespace talus::scene
