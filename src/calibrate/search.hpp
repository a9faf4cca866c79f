#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "calibrate/fit.hpp"
#include "core/result.hpp"

/// Finds the values of factors that explain observations, with few runs of an expensive model.
namespace talus::calibrate {

enum class SearchPhase { design, search, check };
/// "design", "search", "check".
[[nodiscard]] const char* search_phase_name(SearchPhase phase);

struct SearchOptions {
    std::size_t runs = 100;     ///< at most, all together; of a faster model not counted
    std::size_t design = 0;     ///< of the space-filling design; 0: ten per factor (Loeppky, Sacks & Welch 2009)
    std::size_t checks = 10;    ///< runs at the end: the best place and draws from the posterior
    std::size_t at_once = 4;    ///< runs that are chosen together
    std::size_t fast_runs = 0;  ///< at most, of a faster model; 0: there is none
    std::uint64_t seed = 1;
};
/// Defaults of a search with two models.
inline constexpr std::size_t runs_beside_fast = 10, default_fast_runs = 100;

/// Minimum number of runs of a search over this number of factors, which is that of the fast ones where there are such.
[[nodiscard]] std::size_t min_runs(std::size_t factors);
/// Minimum number of runs of the model itself beside those of a faster one.
inline constexpr std::size_t min_runs_beside_fast = 3;

/// One run of a search.
struct SearchRun {
    std::vector<double> point;  ///< of the unit cube
    SearchPhase phase = SearchPhase::design;
    std::vector<double> predicted;  ///< as the observations; NaN: debris did not reach the place; empty: the run failed
    double misfit = 0;              ///< of observations and priors; NaN: failed
    double improvement = 0;         ///< expected when it was chosen; 0 if it was chosen otherwise
};

/// Prediction of a run by the emulators before it was made.
struct Check {
    std::size_t run = 0, observation = 0;
    double computed = 0, mean = 0, deviation = 0;  ///< computed NaN: debris did not reach the place
    double reached = 1;                            ///< probability that debris reaches the place

    /// Whether the run's result is within the expected 95 %.
    [[nodiscard]] bool expected() const;
};

struct SearchResult {
    std::vector<SearchRun> runs;
    std::vector<SearchRun> fast_runs;  ///< of the faster model, if there is one
    std::optional<std::size_t> best;   ///< run of the least misfit; none where all failed
    Fit fit;                           ///< of all runs
    Posterior posterior;
    std::vector<Check> checks;
    double improvement = 0;     ///< largest improvement still expected of another run at the end of the search, in
                                ///< misfit
    double emulator_share = 0;  ///< mean of Fit::emulator_share over the posterior at the end
    double shift = 0;           ///< largest shift of the posterior's medians by the checks, in standard deviations
    bool settled = false;       ///< the search ended because no further gain was expected
    bool interrupted = false;
};

/// Computes runs at `points` and returns all their predictions, one row per point; empty rows: failed. It is called
/// with the same points and more at the end. Empty: interrupted.
using ForwardModel =
    std::function<Result<std::optional<stats::Points>>(const stats::Points& points, SearchPhase phase)>;

/// The state of a search after a round: runs, best and emulators; no posterior yet.
using FitReader = std::function<void(const SearchResult& so_far)>;

/// A design, then rounds of runs where the largest improvement is expected and where the emulators are least certain
/// within the posterior, then draws from the posterior as a check, which are included in the result. The runs depend
/// only on the model, the observations and the options. `priors` without lists. Errors: of the model, all runs of the
/// design failed.
///
/// With options.fast_runs, `fast` is a faster model of the same predictions. It makes the space-filling design, and the
/// emulators are of both models (stats::Emulator::fit_beside). The design of the model itself is at places of the fast
/// one's that represent what the posterior is before any of its runs, so that it is not wasted where nothing fits;
/// rounds and checks are as above, each run beside one of the fast model. Before each round the fast model runs where
/// it is least certain within the posterior.
[[nodiscard]] Result<SearchResult> search(const std::vector<stats::Distribution>& priors,
                                          const std::vector<ensemble::ObservedValue>& observed,
                                          const ForwardModel& model, const SearchOptions& options,
                                          const FitReader& on_fit = {}, const ForwardModel& fast = {});

}  // namespace talus::calibrate
