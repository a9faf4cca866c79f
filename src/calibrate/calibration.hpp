#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calibrate/search.hpp"
#include "core/result.hpp"
#include "ensemble/ensemble_folder.hpp"
#include "ensemble/fast_model.hpp"
#include "ensemble/plan.hpp"
#include "ensemble/predict.hpp"
#include "ensemble/run_record.hpp"
#include "run/time_left.hpp"
#include "run/variants.hpp"
#include "scene/scene.hpp"

/// Back-analysis: finds the values of a scene that explain field observations, by runs of that scene.
namespace talus::calibrate {

struct CalibrationPlan {
    std::vector<ensemble::Factor> factors;  ///< free values with ranges or priors
    SearchOptions search;
    std::optional<ensemble::FastModel> fast = {};  ///< where search.fast_runs is above 0
};

struct CalibrationProgress {
    SearchPhase phase = SearchPhase::design;
    bool fast = false;                           ///< counts the runs of the fast model, which are under way
    std::size_t done = 0, failed = 0, most = 0;  ///< runs so far, and their maximum number
    double least_misfit = observe::never;
    double wall_remaining = 0;  ///< s, an estimate, at most; NaN: too little is done to say
};

/// A run that has just been completed.
struct CalibrationRun {
    std::size_t run = 0;
    SearchPhase phase = SearchPhase::design;
    bool fast = false;               ///< of the fast model
    std::vector<double> values;      ///< of the factors
    double misfit = observe::never;  ///< as SearchRun::misfit
};

/// A calibration and its results.
struct Calibration {
    const scene::Scene* scene = nullptr;  ///< as given, before factors
    std::vector<ensemble::Factor> factors;
    std::vector<ensemble::ObservedValue> observed;
    SearchResult result;
    std::vector<ensemble::RunRecord> records, fast_records;  ///< as result.runs and result.fast_runs
    std::string fault;                        ///< why there is no result: no run is complete; empty: there is one
    std::vector<std::string> best_overrides;  ///< "section.key=value" that make the scene that of the best run
    double wall_time = 0;                     ///< s, of this call
};

struct CalibrationOptions {
    int runs_at_once = 1, threads_per_run = 1;  ///< as in EnsembleOptions
    bool retry_failed = false;
    const std::atomic<bool>* stop_requested = nullptr;
    std::function<void(const CalibrationProgress&)> on_progress = {};  ///< from any thread, one at a time
    std::function<void(const CalibrationRun&)> on_run = {};            ///< likewise, for each run of this call
    /// After each round, from the caller's thread: emulators and runs so far; no posterior and no records yet.
    std::function<void(const Calibration&)> on_fit = {};
    std::function<void(const std::string&)> on_refused = {};  ///< as in EnsembleOptions
};

/// The factors as runs of the scene. Errors: as PlannedRuns::make; a factor without a range; too few runs, also of the
/// fast model; nothing observed, or beyond the flow path.
[[nodiscard]] Result<ensemble::PlannedRuns> plan_calibration(const CalibrationPlan& plan,
                                                             const run::SceneSource& source, const scene::Scene& base);

/// The same runs by the depth-averaged model, for CalibrationPlan::fast. Errors: as ensemble::fast_model.
[[nodiscard]] Result<ensemble::FastModel> plan_fast_model(const CalibrationPlan& plan, const run::SceneSource& source,
                                                          const scene::Scene& base);

/// The definition that identifies a calibration, for EnsembleFolder::open; `kind`: "calibration", or that of other
/// runs.
[[nodiscard]] nlohmann::ordered_json calibration_definition(const std::string& kind, const CalibrationPlan& plan,
                                                            const ensemble::PlannedRuns& runs,
                                                            const run::SceneSource& source, const scene::Scene& base,
                                                            const std::vector<ensemble::ObservedValue>& observed,
                                                            const std::string& scene_name);

/// Runs of one model: their maximum number, those made, and the clock of all.
struct ModelRuns {
    std::size_t most = 0;
    std::vector<ensemble::RunRecord>* records = nullptr;
    run::WorkClock* clock = nullptr;
};

/// Predictions of the scene's observations by its runs, which are stored in the folder; existing ones are reused.
/// `observed`: to evaluate their misfit; `made.records` receives the runs. `other`: of the other model of two, which
/// the estimate of what remains includes; `fast`: this is the faster one. All must outlive the model.
[[nodiscard]] ForwardModel scene_model(ensemble::PlannedRuns& runs, const run::SceneSource& source,
                                       const std::vector<ensemble::ObservedValue>& observed,
                                       const ensemble::EnsembleFolder& folder, const CalibrationOptions& options,
                                       ModelRuns made, ModelRuns other = {}, bool fast = false);

/// Computes the runs missing in the folder and finds the values that explain `observed` (as observed_values(base), or
/// other values of the same). Runs of plan.fast are kept in its folder "fast". Errors: a record cannot be written, or
/// is of another calibration.
[[nodiscard]] Result<Calibration> calibrate(const CalibrationPlan& plan, ensemble::PlannedRuns runs,
                                            const run::SceneSource& source, const scene::Scene& base,
                                            const std::vector<ensemble::ObservedValue>& observed,
                                            const ensemble::EnsembleFolder& folder, const CalibrationOptions& options);

}  // namespace talus::calibrate
