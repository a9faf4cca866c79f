#pragma once

#include <vector>

#include "report/chart.hpp"
#include "report/table.hpp"
#include "run/comparison.hpp"
#include "run/run_result.hpp"
#include "run/verdict.hpp"
#include "scene/scene.hpp"

/// The content of reports as data: results.json, described in docs/results.md.
namespace talus::report {

constexpr int results_version = 3;

/// The head of every results.json: `format`, version, program and time; then, if given, the scene's description.
[[nodiscard]] Json results_head(std::string_view format);
[[nodiscard]] Json results_head(std::string_view format, const scene::Scene& scene);

[[nodiscard]] Json run_results(const scene::Scene& scene, const run::RunResult& result,
                               const std::vector<run::Comparison>& comparisons);

// Its parts. Null where there is nothing to tell.
/// What `[report]` says: client, reference, ...; null where it says nothing.
[[nodiscard]] Json title_block(const params::ReportSpec& report);
/// `beyond_limits`: which checks of the verdict are, as text; null: none.
[[nodiscard]] Json status(const run::RunResult& result, const run::RunVerdict& verdict);
[[nodiscard]] Json beyond_limits(const run::RunVerdict& verdict);
/// A verdict as the template `verdict` shows it: `name` says whose; empty: the only one.
[[nodiscard]] Json named_verdict(std::string_view name, const Json& verdict);
/// What was not at rest at the end: volume, share, greatest speed.
[[nodiscard]] Json still_moving(const run::RunResult& result);
/// Compression of the debris, and what to change if it was too high; null in the depth-averaged model.
[[nodiscard]] Json compression(const scene::Scene& scene, const run::RunResult& result);
[[nodiscard]] Json key_figures(const scene::Scene& scene, const run::RunResult& result);
[[nodiscard]] Json quality(const scene::Scene& scene, const run::RunResult& result);
/// Computed front velocities compared with those observed in the field.
[[nodiscard]] Json observations(const scene::Scene& scene, const run::RunResult& result);
/// Classes of a guideline and the area of each.
[[nodiscard]] Json intensity(const scene::Scene& scene, const run::RunResult& result);
[[nodiscard]] Json buildings(const scene::Scene& scene, const run::RunResult& result);
[[nodiscard]] Json barriers(const run::RunResult& result);
/// Force over time on the structures that were hit.
[[nodiscard]] Json force_chart(const run::RunResult& result);
/// Front velocity, ground profile and arrival time against chainage, one below the other.
[[nodiscard]] Json front_chart(const scene::Scene& scene, const run::RunResult& result);
/// Extends both ranges to include the front velocities observed in the field.
void include_observations(const scene::Scene& scene, ValueRange& chainages, ValueRange& speeds);
/// Draws these velocities with one standard deviation to either side.
void mark_observations(const scene::Scene& scene, Plot& velocity);
/// Energy, volumes, largest speed and, of particles, compression over time.
[[nodiscard]] Json time_chart(const run::RunResult& result);
[[nodiscard]] Json zones(const scene::Scene& scene);
[[nodiscard]] Json inflow(const scene::Scene& scene, const run::RunResult& result);
/// When the releases failed in which water rises.
[[nodiscard]] Json initiation(const run::RunResult& result);
[[nodiscard]] Json erosion(const scene::Scene& scene, const run::RunResult& result);
[[nodiscard]] Json comparison(const run::Comparison& comparison, const scene::Scene& scene, const run::RunResult& base);
/// A run as a curve among others.
struct NamedRun {
    std::string name;
    const run::RunResult* result = nullptr;
};
/// Front velocity and arrival time against chainage, all runs in one plot: the first as a broad line.
[[nodiscard]] Json fronts_chart(const scene::Scene& scene, const std::vector<NamedRun>& runs);
/// Depth and speed over time at the gauges of a scene, of one run or several of them. Null: there are none.
[[nodiscard]] Json gauges(const std::vector<NamedRun>& runs);
/// Discharge over time through the cross-sections of a scene, of one run or several of them. Null: there are none.
[[nodiscard]] Json cross_sections(const std::vector<NamedRun>& runs);
/// What was zoomed, and the balance of volume and momentum across its boundary.
[[nodiscard]] Json zoom(const run::RunResult& result);
/// Whether a chainage of the flow path lies outside a zoom. Without a path there is no such place.
[[nodiscard]] bool outside_zoom(const scene::Scene& scene, const run::RunResult& result, double chainage);
/// What debris left whose run-out is at least that; where a scene takes a part of its terrain, which key has more of
/// it.
[[nodiscard]] std::string left_text(const scene::Scene& scene, const run::RunResult& result);
/// Which laws the scene uses.
[[nodiscard]] Json method(const scene::Scene& scene);
[[nodiscard]] Json chosen_values(const scene::Scene& scene, const run::RunResult& result);
/// The keys that the scene sets, and those at their defaults with their number. The depth-averaged model is not shown
/// the defaults of particles.
[[nodiscard]] Json parameters(const scene::Scene& scene);
[[nodiscard]] Json defaults(const scene::Scene& scene);
/// The defaults on which the result rests, for each that the scene does not set, with their number.
[[nodiscard]] Json not_set(const scene::Scene& scene, const run::RunResult& result);
[[nodiscard]] Json inputs(const scene::Scene& scene);
[[nodiscard]] Json computation(const scene::Scene& scene, const run::RunResult& result);

/// Decimals of lengths that belong to the scene: `least`, and those more that a terrain of less than 10 m needs.
[[nodiscard]] int length_decimals(const scene::Scene& scene, int least = 0);

/// "at chainage 88 m", or the coordinates where the path does not pass.
[[nodiscard]] std::string place(const scene::Scene& scene, const PlanPoint& at);

/// "1 building", "2 buildings"
[[nodiscard]] std::string plural(std::size_t n, std::string_view word);

}  // namespace talus::report
