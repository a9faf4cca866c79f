#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calibrate/calibration.hpp"
#include "core/result.hpp"

namespace talus::calibrate {

/// The result for one factor, in the unit of its key.
struct FactorResult {
    double best = 0;                                         ///< of the run of least misfit
    double median = 0, low = 0, high = 0;                    ///< of the posterior, with its central 95 %
    double prior_low = 0, prior_high = 0;                    ///< central 95 % of the prior
    double kept = 0;                                         ///< width of the posterior's 95 % in shares of the prior's
    double r_hat = 0, effective = 0;                         ///< of the chains
    enum class End { none, low, high } against = End::none;  ///< the end of the range at which the posterior lies
};

/// The result for one observation.
struct ObservationResult {
    double best = 0;                       ///< computed by the run of least misfit; NaN: debris did not reach the place
    double deviation = 0;                  ///< of that, as deviation_of
    double prior_low = 0, prior_high = 0;  ///< 5th and 95th percentile of the design's runs
    double median = 0, low = 0, high = 0;  ///< of runs that the posterior expects, with 95 %
    double left_out = 0;                   ///< root mean square error of the emulator for a run left out of its fit
    double explained = 0;                  ///< share of the runs' variance that it explains
    double noise = 0;                      ///< standard deviation of runs around the emulator
    double reach_told = 1;  ///< share of the runs for which the emulator predicts correctly whether debris arrives
    /// Of two models: the factor on the fast one in the emulator, and mean and standard deviation of the difference of
    /// the runs' predictions, the fast model's taken off, over the places where both ran and have a value.
    double rho = 0, model_difference = observe::never, model_spread = observe::never;
    std::size_t pairs = 0;
};

/// Runs of the faster model, if there is one.
struct FastRuns {
    std::size_t made = 0, failed = 0;
    double wall_time = 0;  ///< s, of all together
};

/// All numerical results of a calibration.
struct CalibrationSummary {
    std::vector<FactorResult> factors;
    std::vector<ObservationResult> observations;
    std::size_t complete = 0, failed = 0;
    FastRuns fast;
    double checks_within = observe::never;  ///< share of the checks within the 95 % interval of the emulators
    std::vector<std::string> warnings;      ///< limitations that a reader must know, one sentence each
};
[[nodiscard]] CalibrationSummary summarise(const Calibration& calibration);

/// Misfit over the first two factors, by the emulators, at the best values found for all others (between rounds,
/// without a posterior yet: for fewer others).
struct MisfitMap {
    std::size_t cells = 0;       ///< along each factor
    std::vector<double> x, y;    ///< limits of the cells, cells + 1 of each, in the units of the keys; no y: one factor
    std::vector<double> misfit;  ///< by rows of y
};
[[nodiscard]] MisfitMap misfit_map(const Calibration& calibration);

/// The share of a distribution (not a list) that lies below a value.
[[nodiscard]] double share_below(const stats::Distribution& distribution, double value);

/// runs.csv, factors.csv, observations.csv, misfit_map.csv, posterior.csv, calibration.json, results.json, report.html,
/// misfit_map.svg and best_fit/scene.toml, the scene of the best fit, into the folder. `own_files`: the scene's files
/// are copied to best_fit too (of the built-in scene or a bundle). Errors name the file and the cause.
[[nodiscard]] Status write_calibration(const Calibration& calibration, const run::SceneSource& source, bool own_files,
                                       const std::filesystem::path& folder);

/// Everything except draws and the map; values that do not exist are null.
[[nodiscard]] nlohmann::ordered_json calibration_json(const Calibration& calibration);

/// What the report shows, as data: results.json.
[[nodiscard]] nlohmann::ordered_json calibration_results(const Calibration& calibration,
                                                         const CalibrationSummary& summary, const MisfitMap& map);

/// The self-contained page: showing `results` from calibration_results().
[[nodiscard]] std::string calibration_report(const nlohmann::ordered_json& results);

}  // namespace talus::calibrate
