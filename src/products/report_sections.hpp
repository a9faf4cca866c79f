#pragma once

#include <string>

#include "scene/run.hpp"
#include "scene/scene.hpp"

/// The parts of the report as HTML, each from the scene and the result alone. Names ending in _figure draw.
namespace talus::report {

/// Mean and greatest compression above which a run counts as not converged.
inline constexpr double mean_compression_limit = 0.01, max_compression_limit = 0.03;

/// Whether the worst compression of the run stayed within both limits.
[[nodiscard]] bool converged(const Observation& observation);

/// What the front did at a chainage, interpolated between samples; NaN where debris never came.
[[nodiscard]] FrontSample front_at(const Observation& observation, double chainage);

[[nodiscard]] std::string banners(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string key_results(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string run_quality(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string observation_table(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string building_table(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string chosen_values(const Scene& scene, const RunResult& result);
[[nodiscard]] std::string parameter_table(const Scene& scene);
[[nodiscard]] std::string method(const Scene& scene);
[[nodiscard]] std::string assumptions(const Scene& scene);
[[nodiscard]] std::string input_table(const Scene& scene);
[[nodiscard]] std::string computation_table(const Scene& scene, const RunResult& result);

/// Front velocity, ground profile and arrival time against chainage, one below the other.
[[nodiscard]] std::string front_figure(const Scene& scene, const RunResult& result);
/// Energy, volumes, largest speed and compression over time.
[[nodiscard]] std::string time_figure(const RunResult& result);

}  // namespace talus::report
