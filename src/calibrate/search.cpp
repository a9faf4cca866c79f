#include "calibrate/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/try.hpp"
#include "observe/observation.hpp"
#include "stats/optimise.hpp"

namespace talus::calibrate {
namespace {

// The search ends when another run would neither fit better nor add information: expected improvement below a tenth of
// the difference between the best place and one a third of a standard deviation away, and emulators that are certain
// compared with the observations.
constexpr double little_improvement = 0.01, little_uncertainty = 0.1;
constexpr std::size_t quiet_rounds = 2;  // in a row
constexpr double least_distance = 0.01;  // of the cube, between runs that reduce the emulators' uncertainty

constexpr stats::ChainOptions short_chains = {500, 500, 1}, long_chains = {3000, 8000, 1};

class Searcher {
  public:
    Searcher(const std::vector<stats::Distribution>& priors, const std::vector<ensemble::ObservedValue>& observed,
             const ForwardModel& model, const SearchOptions& options, const FitReader& on_fit)
        : priors_(priors), observed_(observed), model_(model), options_(options), on_fit_(on_fit) {}

    Result<SearchResult> work();

  private:
    /// Runs the model at more places; false: interrupted.
    Result<bool> run(const stats::Points& points, SearchPhase phase, const std::vector<double>& improvements = {});
    /// Emulators of all complete runs.
    void fit();
    /// The same with expected values for failed runs, so that their places are not chosen again.
    [[nodiscard]] Fit with_failed() const;
    [[nodiscard]] stats::Points run_points() const;
    [[nodiscard]] double least_misfit(const Fit& fit) const;
    void choose(stats::Points& points, std::vector<double>& improvements);
    [[nodiscard]] stats::ChainOptions seeded(stats::ChainOptions options) const {
        options.seed = options_.seed * 1000 + result_.runs.size();
        return options;
    }
    void judge_checks(const Fit& before);

    const std::vector<stats::Distribution>& priors_;
    const std::vector<ensemble::ObservedValue>& observed_;
    const ForwardModel& model_;
    const SearchOptions options_;
    const FitReader& on_fit_;
    SearchResult result_;
};

stats::Points Searcher::run_points() const {
    stats::Points points;
    for (const SearchRun& run : result_.runs) points.push_back(run.point);
    return points;
}

Result<bool> Searcher::run(const stats::Points& points, SearchPhase phase, const std::vector<double>& improvements) {
    stats::Points all = run_points();
    all.insert(all.end(), points.begin(), points.end());
    TALUS_ASSIGN(const auto predicted, model_(all, phase));
    if (!predicted) {
        result_.interrupted = true;
        return false;
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        SearchRun made;
        made.point = points[i];
        made.phase = phase;
        made.predicted = (*predicted)[result_.runs.size()];
        made.improvement = i < improvements.size() ? improvements[i] : 0;
        made.misfit = observe::never;
        if (!made.predicted.empty()) {
            made.misfit = misfit_of(observed_, made.predicted);
            for (std::size_t k = 0; k < priors_.size(); ++k) made.misfit += prior_misfit(priors_[k], points[i][k]);
            const auto& best = result_.best;
            if (!best || made.misfit < result_.runs[*best].misfit) result_.best = result_.runs.size();
        }
        result_.runs.push_back(std::move(made));
    }
    return true;
}

void Searcher::fit() {
    stats::Points points;
    for (const SearchRun& run : result_.runs) {
        if (!run.predicted.empty()) points.push_back(run.point);
    }
    result_.fit = {priors_, observed_, {}};
    for (std::size_t j = 0; j < observed_.size(); ++j) {
        std::vector<double> values;
        for (const SearchRun& run : result_.runs) {
            if (!run.predicted.empty()) values.push_back(run.predicted[j]);
        }
        result_.fit.emulators.push_back(stats::PredictionEmulator::fit(points, values, observed_[j].unreached));
    }
    if (on_fit_) on_fit_(result_);
}

bool near_any(const std::vector<double>& point, const stats::Points& others) {
    return std::any_of(others.begin(), others.end(), [&](const auto& other) {
        double square = 0;
        for (std::size_t k = 0; k < point.size(); ++k) square += (point[k] - other[k]) * (point[k] - other[k]);
        return square < least_distance * least_distance;
    });
}

Fit believe(const Fit& fit, const std::vector<double>& point) {
    Fit more = fit;
    for (stats::PredictionEmulator& emulator : more.emulators) emulator = emulator.believing(point);
    return more;
}

Fit Searcher::with_failed() const {
    Fit all = result_.fit;
    for (const SearchRun& run : result_.runs) {
        if (run.predicted.empty()) all = believe(all, run.point);
    }
    return all;
}

/// By the emulators' means, which are not misled by the noise of a single run.
double Searcher::least_misfit(const Fit& fit) const {
    double least = std::numeric_limits<double>::infinity();
    for (const SearchRun& run : result_.runs) {
        if (!run.predicted.empty()) least = std::min(least, fit.misfit_at(run.point));
    }
    return least;
}

void Searcher::choose(stats::Points& points, std::vector<double>& improvements) {
    Fit fit = with_failed();
    const stats::Points runs = run_points();
    const Posterior posterior = sample_posterior(fit, runs, seeded(short_chains));
    const double least = least_misfit(fit);
    const std::size_t factors = priors_.size();
    const std::vector<double> best_point = result_.runs[*result_.best].point;
    result_.improvement = 0;
    result_.emulator_share = 0;
    for (const auto& row : posterior.draws) {
        result_.emulator_share += fit.emulator_share(row) / static_cast<double>(posterior.draws.size());
    }
    // Each choice is assumed to give its expected result, so that the next one lies elsewhere ("kriging believer":
    // Ginsbourger, Le Riche & Carraro 2010).
    for (std::size_t i = 0; i < options_.at_once; ++i) {
        std::vector<double> chosen;
        double improvement = 0;
        if (i % 2 == 0) {
            const stats::Objective objective = [&](const std::vector<double>& p) {
                return -fit.expected_improvement(p, least);
            };
            const std::vector<double>& draw = posterior.draws[(i * 97) % posterior.draws.size()];
            const stats::Optimum most = stats::minimise_in_cube(objective, factors, {best_point, draw}, 200 * factors);
            chosen = most.at;
            improvement = -most.value;
            result_.improvement = std::max(result_.improvement, improvement);
        }
        if (improvement < little_improvement) {
            double most = -1;
            for (const auto& row : posterior.draws) {
                if (near_any(row, points) || near_any(row, runs)) continue;  // a repeated run adds no information
                const double share = fit.emulator_share(row);
                if (share <= most) continue;
                most = share;
                chosen = row;
            }
            if (chosen.empty())
                chosen = sample_points(stats::DesignKind::monte_carlo, 1, factors, runs.size() + i).front();
            improvement = 0;
        }
        fit = believe(fit, chosen);
        points.push_back(std::move(chosen));
        improvements.push_back(improvement);
    }
}

void Searcher::judge_checks(const Fit& before) {
    for (std::size_t i = 0; i < result_.runs.size(); ++i) {
        const SearchRun& run = result_.runs[i];
        if (run.phase != SearchPhase::check || run.predicted.empty()) continue;
        for (std::size_t j = 0; j < observed_.size(); ++j) {
            const stats::PredictionEmulator::Estimate e = before.emulators[j].at(run.point);
            const double deviation = std::sqrt(e.value.variance + e.value.noise);
            result_.checks.push_back({i, j, run.predicted[j], e.value.mean, deviation, e.reached});
        }
    }
}

Result<SearchResult> Searcher::work() {
    const std::size_t factors = priors_.size();
    const std::size_t checks = std::min(options_.checks, options_.runs / 4);
    const std::size_t wanted = options_.design > 0 ? options_.design : 10 * factors;
    const std::size_t design = std::max(factors + 2, std::min(wanted, (options_.runs - checks) * 2 / 3));
    bool went_on = false;
    TALUS_ASSIGN(went_on, run(sample_points(stats::DesignKind::latin_hypercube, design, factors, options_.seed),
                              SearchPhase::design));
    if (!went_on) return result_;
    if (!result_.best) return Error{"no run of the design is complete, so there is nothing to search by"};
    fit();

    std::size_t quiet = 0;
    while (result_.runs.size() + options_.at_once + checks <= options_.runs) {
        stats::Points points;
        std::vector<double> improvements;
        choose(points, improvements);
        const bool little = result_.improvement < little_improvement && result_.emulator_share < little_uncertainty;
        quiet = little ? quiet + 1 : 0;
        if (quiet >= quiet_rounds) {
            result_.settled = true;
            break;
        }
        TALUS_ASSIGN(went_on, run(points, SearchPhase::search, improvements));
        if (!went_on) return result_;
        fit();
    }

    const Posterior found = sample_posterior(result_.fit, run_points(), seeded(long_chains));
    result_.posterior = found;
    if (checks == 0) return std::move(result_);
    const Fit before = result_.fit;
    const stats::Objective misfit = [&](const std::vector<double>& p) { return before.misfit_at(p); };
    stats::Points points = {
        stats::minimise_in_cube(misfit, factors, {result_.runs[*result_.best].point}, 400 * factors).at};
    for (std::size_t i = 1; i < checks; ++i) {
        points.push_back(found.draws[i * found.draws.size() / checks]);
    }
    TALUS_ASSIGN(went_on, run(points, SearchPhase::check));
    if (!went_on) return result_;
    judge_checks(before);
    fit();
    result_.posterior = sample_posterior(result_.fit, run_points(), seeded(long_chains));
    result_.emulator_share = 0;
    for (const auto& row : result_.posterior.draws) {
        result_.emulator_share += result_.fit.emulator_share(row) / static_cast<double>(result_.posterior.draws.size());
    }
    for (std::size_t k = 0; k < factors; ++k) {
        const double deviation = (found.quantile(k, 84.1) - found.quantile(k, 15.9)) / 2;
        const double moved = std::abs(result_.posterior.quantile(k, 50) - found.quantile(k, 50));
        if (deviation > 0) result_.shift = std::max(result_.shift, moved / deviation);
    }
    return std::move(result_);
}

}  // namespace

bool Check::expected() const {
    if (std::isnan(computed)) return reached < 0.95;
    return reached > 0.05 && std::abs(computed - mean) <= 1.96 * deviation;
}

const char* search_phase_name(SearchPhase phase) {
    return phase == SearchPhase::design ? "design" : phase == SearchPhase::search ? "search" : "check";
}

std::size_t min_runs(std::size_t factors) {
    return 2 * (factors + 2);
}

Result<SearchResult> search(const std::vector<stats::Distribution>& priors,
                            const std::vector<ensemble::ObservedValue>& observed, const ForwardModel& model,
                            const SearchOptions& options, const FitReader& on_fit) {
    return Searcher(priors, observed, model, options, on_fit).work();
}

}  // namespace talus::calibrate
