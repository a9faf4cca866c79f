#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"
#include "messages/messages.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"
#include "twin/scenario.hpp"

/// The results of a scenario's run so far. Each function copies what it needs of it; a function that is returned is the
/// rest of the work, which any thread can do while the run continues.
namespace talus::twin {

/// The scene with the present setup, and the result.
[[nodiscard]] std::pair<scene::Scene, run::RunResult> outcome_of(const Scenario& scenario);
/// The key figures, as in results.json.
[[nodiscard]] std::function<messages::Figures()> figures_of(const Scenario& scenario);
/// What results.json has.
[[nodiscard]] nlohmann::json results_json(const Scenario& scenario);
/// `{"run_out": ..., "gauges": [...], "crs_wkt": ...}`, as talus.h says.
[[nodiscard]] nlohmann::json measures_json(const Scenario& scenario);

/// One of run_layers(); NaN: no value. SI units. The last has cells of the terrain, the others those of the maps. Now,
/// or at the recorded frame at or before a time, s (see past_layer; erosion is exact). Errors: no such layer, nothing
/// recorded by that time.
[[nodiscard]] Result<std::function<Grid<float>()>> layer_of(const Scenario& scenario, const std::string& name,
                                                            std::optional<double> time = {});
/// What passed at a point, over the recording.
[[nodiscard]] std::function<messages::ProbeSeries()> probe_at(const Scenario& scenario, const PlanPoint& p);

/// A file of a run, made when it is asked for.
struct RunFile {
    std::string name, type, what;
    std::function<std::string()> bytes;
};
/// The files that need no disk: tables and maps, as write_products() writes them. None before the first step.
[[nodiscard]] std::vector<RunFile> page_files_of(const Scenario& scenario);
/// Writes all files as `talus run` would, into an existing empty folder.
[[nodiscard]] std::function<Status(const std::filesystem::path& folder)> products_of(const Scenario& scenario);

/// Results of the same version are the same.
struct Version {
    std::uint64_t step = 0, revision = 0, hash = 0;
    friend bool operator==(const Version&, const Version&) = default;
};
[[nodiscard]] Version version_of(const Scenario& scenario);

}  // namespace talus::twin
