#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "products/report_map.hpp"
#include "run/comparison.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// The parts of the report as HTML, each from the scene and the result alone. Names ending in _figure draw.
namespace talus::report {

[[nodiscard]] std::string banners(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string key_results(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string run_quality(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string observation_table(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string building_table(const Scene& scene, const RunResult& result);
/// What failed, and a table of barriers; nothing where there is neither.
[[nodiscard]] std::string barrier_table(const RunResult& result);
[[nodiscard]] std::string chosen_values(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string parameter_table(const Scene& scene);
[[nodiscard]] std::string method(const Scene& scene);
[[nodiscard]] std::string assumptions(const Scene& scene);
[[nodiscard]] std::string input_table(const Scene& scene);
[[nodiscard]] std::string computation_table(const Scene& scene, const RunResult& result);

/// Front velocity, ground profile and arrival time against chainage, one below the other.
[[nodiscard]] std::string front_figure(const Scene& scene, const RunResult& result);
/// Released volume and what was picked up upstream, against chainage.
[[nodiscard]] std::string erosion_figure(const RunResult& result);
/// A <section> on what debris picked up; empty for a scene without a bed.
[[nodiscard]] std::string erosion_section(const Scene& scene, const RunResult& result, int figure);
/// Force over time on the structures that were hit.
[[nodiscard]] bool has_structure_figure(const RunResult& result);
[[nodiscard]] std::string structure_figure(const RunResult& result);
/// What nets held, let through and did not keep from going over them, over time; "" where debris met none.
[[nodiscard]] std::string net_figure(const RunResult& result);
/// Energy, volumes, largest speed and compression over time.
[[nodiscard]] std::string time_figure(const RunResult& result);

/// A <section> with the hydrographs; nothing without inflows.
[[nodiscard]] std::string inflow_section(const Scene& scene, const RunResult& result, int figure);

/// Whether there are zones or a bed to be drawn.
[[nodiscard]] bool has_zone_figure(const Scene& scene);
/// A <section> with the map of zones and bed over the `maps`' hillshade; empty where there are none. Errors: a picture
/// could not be encoded.
[[nodiscard]] Result<std::string> zone_section(const Scene& scene, const MapContent& content, const MapFigures& maps,
                                               int figure);

/// What must not be overlooked of the comparisons: a scene that is not converged under refinement.
[[nodiscard]] std::string comparison_banners(const std::vector<Comparison>& comparisons);
/// A <section> per comparison: verdict, table, and the fronts of all runs over each other.
[[nodiscard]] std::string comparison_sections(const std::vector<Comparison>& comparisons, const Scene& scene,
                                              const RunResult& base, int first_figure);

}  // namespace talus::report
