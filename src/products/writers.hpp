#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/phases.hpp"
#include "core/result.hpp"
#include "geo/vector.hpp"
#include "products/layer_definition.hpp"
#include "run/comparison.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// The parts of write_products, one per kind of file. Lengths in m, times in s unless a suffix says otherwise.
namespace talus::products {

/// Some files of a folder, to be written beside others.
struct WriteJob {
    std::string name;  ///< of the phase in the manifest
    std::function<Status()> write;
};

/// peak_depth.tif, ..., intensity.tif, and erosion_depth.tif where anything was eroded, each with a QGIS style beside
/// it. They are added to `layers`; a job writes each. `scene` and `result` must outlive the jobs.
void add_maps(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder,
              LayerDefinition& layers, std::vector<WriteJob>& jobs);

/// terrain.tif, the elevations of a place and around it, with a style that draws their hillshade. It is added to
/// `layers`, below all that is added before; a job writes it, which `scene` must outlive.
void add_terrain(const scene::Scene& scene, const Extent& place, const std::filesystem::path& folder,
                 LayerDefinition& layers, std::vector<WriteJob>& jobs);

/// Adds the maps over time to `layers`, from the GeoTIFF or else the NetCDF files of the folder's series. `times`: of
/// all frames, s; empty: there are none.
void add_maps_over_time(const scene::Scene& scene, const run::RunResult& result, const std::vector<double>& times,
                        const std::filesystem::path& folder, LayerDefinition& layers);

/// front.csv, run_out.csv, buildings.csv, structures_over_time.csv, timeseries.csv, and erosion.csv, gauges.csv and
/// discharge.csv where there is a bed, a gauge or a cross-section. A value that does not exist is an empty field.
/// `changed`: as for write_products.
[[nodiscard]] Status write_tables(const scene::Scene& scene, const run::RunResult& result,
                                  const std::filesystem::path& folder, std::string_view changed = {});

/// A row of buildings.csv and of the layer buildings of results.gpkg, numbers and texts by their columns. `building`:
/// nullptr where the scene has none.
[[nodiscard]] std::vector<std::pair<std::string, geo::Attribute>> building_row(const scene::Scene& scene,
                                                                               const observe::BuildingImpact& impact,
                                                                               const terrain::Building* building);

/// results.gpkg with the layers buildings, release, intensity (polygons of each class), inundation and deposit
/// (outlines of what is deeper than outputs.arrival_depth_m), flow_path and chainage (a short line across the path per
/// mark), gauges, cross_sections and zoom (its boundary) where there are any, contours where they are asked for, and
/// their styles for QGIS. They are added to `layers`. `missing`: as for write_products.
[[nodiscard]] Status write_vectors(const scene::Scene& scene, const run::RunResult& result,
                                   const std::filesystem::path& folder, LayerDefinition& layers,
                                   std::vector<std::string>* missing = nullptr);

/// A layer of results.gpkg as QGIS shows it.
struct WrittenLayer {
    std::string table, title, style;
};

/// Adds a layer contours_<map> to results.gpkg for every map of outputs.contours: lines with map, value and unit. Those
/// that were written are added to `written`, also where another one cannot be.
[[nodiscard]] Status write_contours(const scene::Scene& scene, const run::RunResult& result, const std::string& file,
                                    std::vector<WrittenLayer>& written);

/// results.kml, for Google Earth and phones: structures that were hit, with when and how hard, the outline of
/// inundation and bands of arrival time. None where the reference system is local.
[[nodiscard]] Status write_kml(const scene::Scene& scene, const run::RunResult& result,
                               const std::filesystem::path& folder);

/// stac_item.json: place, time, software and files of the run, as a catalogue of geodata reads them (SpatioTemporal
/// Asset Catalog 1.0.0). Lists the files in the folder: call it after they are written.
[[nodiscard]] Status write_stac_item(const scene::Scene& scene, const run::RunResult& result,
                                     const std::filesystem::path& folder);

/// convergence.csv, variants.csv: a row for the base and one per variant, with values, changes in percent and cost.
[[nodiscard]] Status write_comparisons(const std::vector<run::Comparison>& comparisons, const run::RunResult& base,
                                       const std::filesystem::path& folder);

/// manifest.json: everything needed to repeat and to assess the run. A value that does not exist is null. `written`:
/// how long the products before it took.
[[nodiscard]] Status write_manifest(const scene::Scene& scene, const run::RunResult& result,
                                    const std::vector<run::Comparison>& comparisons,
                                    const std::filesystem::path& folder, const std::vector<Phase>& written = {});

/// "given", "traced" or "followed".
[[nodiscard]] const char* origin_text(scene::PathOrigin origin);

/// "complete", "interrupted" or "fault".
[[nodiscard]] const char* status_text(run::RunStatus status);

/// What a map still says of its run when it lies alone in somebody's folder, by key of a GeoTIFF.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> origin_of(const scene::Scene& scene,
                                                                         const run::RunResult& result);

/// The same by the names that other formats use: "source", "title", "scene_hash", ...
[[nodiscard]] std::vector<std::pair<std::string, std::string>> plain_origin_of(const scene::Scene& scene,
                                                                               const run::RunResult& result);

/// The hash of the scene file.
[[nodiscard]] std::string scene_hash(const scene::Scene& scene);

/// The caveat that every product carries: " (reconstruction, partial: interrupted)", or nothing.
[[nodiscard]] std::string caveat(const scene::Scene& scene, const run::RunResult& result);

/// The scene's title and the caveat, which says nothing that the title says already.
[[nodiscard]] std::string title_of(const scene::Scene& scene, const run::RunResult& result);

}  // namespace talus::products
