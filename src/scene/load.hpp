#pragma once

#include <string>
#include <vector>

#include "geo/terrain_frame.hpp"
#include "geo/vector.hpp"
#include "scene/parse.hpp"
#include "scene/scene.hpp"

/// The parts of load_scene. Each adds its changes of the inputs to the scene's notes.
namespace talus::scene {

/// Loads and checks everything that the parsed scene names.
[[nodiscard]] Result<Scene> assemble_scene(const ParsedScene& parsed);

/// Fills scene.terrain and the data about its file.
[[nodiscard]] Status load_terrain(const ParsedScene& parsed, Scene& scene);

/// Fills scene.zones and the values derived from them. The terrain must be loaded.
[[nodiscard]] Status load_zones(const ParsedScene& parsed, Scene& scene);

/// Fills scene.releases. The terrain must be loaded.
[[nodiscard]] Status load_releases(const ParsedScene& parsed, Scene& scene);

/// Fills scene.bed_layers and scene.bed. The terrain must be loaded.
[[nodiscard]] Status load_bed(const ParsedScene& parsed, Scene& scene);

/// Fills scene.buildings. The terrain and the releases must be loaded.
[[nodiscard]] Status load_buildings(const ParsedScene& parsed, Scene& scene);

/// Fills scene.inflows. The terrain must be loaded.
[[nodiscard]] Status load_inflows(const ParsedScene& parsed, Scene& scene);

/// Adds the barriers to scene.buildings. Terrain, releases and buildings must be loaded.
[[nodiscard]] Status load_barriers(const ParsedScene& parsed, Scene& scene);

/// Plan area of a building on a release, m2; touching outlines do not count.
[[nodiscard]] double shared_area(const terrain::Release& release, const terrain::Building& building);

/// Fills scene.flow_path from its file, or by tracing. The terrain and the releases must be loaded.
[[nodiscard]] Status load_flow_path(const ParsedScene& parsed, Scene& scene);

/// Checks what was observed against terrain, flow path and buildings, and fills scene.deposit_outlines, affected_areas
/// and elevation_changes. All of these are loaded. A chainage beyond the path is an error, but of an [[observation]] a
/// note: it is only drawn.
[[nodiscard]] Status load_observations(const ParsedScene& parsed, Scene& scene);

/// What that checks of observations without a file: chainages, also of an [[observation]], places, names of buildings.
[[nodiscard]] Status check_observed_places(const ParsedScene& parsed, const Scene& scene);

/// Fills scene.gauges. Terrain and flow path must be loaded.
[[nodiscard]] Status load_gauges(const ParsedScene& parsed, Scene& scene);

/// Fills scene.cross_sections. Terrain must be loaded.
[[nodiscard]] Status load_cross_sections(const ParsedScene& parsed, Scene& scene);

/// Fills scene.zoom where particles are run. All else must be loaded. Errors: an area that reaches beyond known ground
/// or holds a release or an inflow, a bed, what the depth-averaged model does not have.
[[nodiscard]] Status load_zoom(const ParsedScene& parsed, Scene& scene);

/// Checks that triggers and alarms name what exists. All of it is loaded.
[[nodiscard]] Status check_alerts(const ParsedScene& parsed, const Scene& scene);

/// Notes what its file says about a terrain beside its elevations.
void note_terrain_file(const geo::TerrainFrame& frame, Scene& scene);

/// Reads polygons, adds their file to scene.inputs and notes what was done to them: another reference system, closed
/// lines. `label`: "zoom".
[[nodiscard]] Result<geo::PolygonLayer> load_polygons(const std::string& label, const std::string& file,
                                                      const std::string& layer, Scene& scene);

/// Adds the file, and for a Shapefile the files that belong to it, to scene.inputs.
void record_input(const std::string& role, const std::string& path, Scene& scene);

/// "(824355.0, 825830.0)".
[[nodiscard]] std::string place_text(const PlanPoint& p);

/// "x 822497.5 to 826497.5, y 823997.5 to 828497.5".
[[nodiscard]] std::string extent_text(const Extent& extent);

/// The largest area of known ground: the hull of the cell centres.
[[nodiscard]] Extent covered_extent(const terrain::Terrain& terrain);

}  // namespace talus::scene
