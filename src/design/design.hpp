#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "design/barrier_run.hpp"
#include "design/capacity.hpp"
#include "ensemble/ensemble.hpp"
#include "ensemble/plan.hpp"
#include "run/variants.hpp"
#include "run/verdict.hpp"
#include "scene/scene.hpp"

/// The least height of a barrier for which at most a share of the runs of an ensemble, or of their volume, passes; what
/// it holds and what it must bear.
namespace talus::design {

/// What is wanted.
struct DesignRequest {
    ensemble::EnsemblePlan plan;
    run::SceneSource source;
    std::string scene_name;
    std::filesystem::path folder;
    std::string barrier;                    ///< its name in the scene
    std::vector<std::string> lines;         ///< beside its own: "NAME=x,y x,y ..." or "NAME=FILE" with a line
    double share = 0.05;                    ///< that may pass
    bool of_volume = false;                 ///< of all runs together; else of runs
    double low = 1, high = 10, step = 0.5;  ///< heights, m
    bool confirm = false;                   ///< the deciding runs again with particles
    std::optional<double> boulder_diameter;
    std::optional<double> deposition_slope;  ///< degrees; absent: half the slope of the ground
};

/// One ensemble: a line with a barrier of some height, or without any.
struct Part {
    std::size_t line = 0;  ///< of Design::lines
    double height = 0;     ///< m; 0: without the barrier
    bool particles = false;
    run::SceneSource source;
    std::shared_ptr<const ensemble::PlannedRuns> runs;
    std::vector<std::size_t> numbers;  ///< of the plan's runs
    std::filesystem::path folder;
    std::shared_ptr<const nlohmann::ordered_json> definition;
};

struct Design {
    DesignRequest request;
    std::shared_ptr<const scene::Scene> scene;  ///< as given
    std::shared_ptr<const ensemble::PlannedRuns> runs;
    std::vector<SiteLine> lines;  ///< the first is the barrier's own
    std::vector<double> heights;
    [[nodiscard]] std::size_t most_runs() const;
    [[nodiscard]] std::size_t missing_runs() const;  ///< of most_runs(), where none of an earlier call is there
};

/// Loads and checks all that a run will need. Errors: no such barrier, a line that is refused, a share that is not from
/// 0 to 1, heights that are no grid, as PlannedRuns::make.
[[nodiscard]] Result<Design> plan_design(const DesignRequest& request);

/// Runs a part, or what is missing of it. False: it was interrupted.
using PartRunner = std::function<Result<bool>(const Part&)>;
/// Makes the folder of a part, for this call and for others beside it. Errors: the folder is of another part, or cannot
/// be made.
[[nodiscard]] Status open_part(const Part& part);
/// Runs a part that is open, with options of the caller: how many at once, progress, which shard.
[[nodiscard]] Result<ensemble::EnsembleOutcome> run_part(const Design& design, const Part& part,
                                                         ensemble::EnsembleOptions options);

/// The runs of one height.
struct Trial {
    double height = 0;
    std::vector<std::optional<BarrierRun>> runs;  ///< none: it failed
    double passing_runs = 0;                      ///< share
    double passing_volume = 0;                    ///< share of what crosses the line without a barrier
    bool enough = false;                          ///< no more passes than is allowed
};

/// Of a value over the runs, by nearest rank.
struct Spread {
    double median = 0, p84 = 0, p95 = 0, greatest = 0;
};
[[nodiscard]] Spread spread_of(std::vector<double> values);

struct LineResult {
    SiteLine line;
    double length = 0;
    int side = 1;  ///< from which debris comes
    std::vector<std::optional<BarrierRun>> undisturbed;
    std::vector<Trial> trials;              ///< by height
    std::optional<std::size_t> found;       ///< of trials
    std::vector<std::string> not_monotone;  ///< a sentence each
    Spread speed, depth, discharge, volume;
    double slope = 0, deposition_slope = 0;           ///< tangents
    Storage level, sloped;                            ///< at the height found, or the greatest
    std::vector<std::pair<double, double>> capacity;  ///< (height, level volume) for the curve
    std::vector<std::size_t> confirmed_runs;          ///< repeated with particles
    std::vector<std::optional<BarrierRun>> confirmed;
    run::RunVerdict verdict;
    std::size_t failed = 0;

    [[nodiscard]] const Trial& shown() const { return trials[found.value_or(trials.size() - 1)]; }
};

struct DesignResult {
    const Design* design = nullptr;
    std::vector<LineResult> lines;
};

/// Searches every line. Nothing: interrupted. Errors: of the runner; fewer than two complete runs.
[[nodiscard]] Result<std::optional<DesignResult>> search(const Design& design, const PartRunner& run);

/// design.html, runs.csv, heights.csv, loads.csv, results.json into the folder, over those of an earlier call.
[[nodiscard]] Status write_design(const DesignResult& result);
[[nodiscard]] nlohmann::ordered_json design_results(const DesignResult& result);
[[nodiscard]] Result<std::string> design_sheet(const DesignResult& result, const nlohmann::ordered_json& results);

}  // namespace talus::design
