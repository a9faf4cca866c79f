#include "calibrate/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "calibrate/search_points.hpp"
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
             const ForwardModel& model, const SearchOptions& options, const FitReader& on_fit, const ForwardModel& fast)
        : priors_(priors), observed_(observed), model_(model), fast_(fast), options_(options), on_fit_(on_fit) {}

    Result<SearchResult> work();

  private:
    /// Runs the model at more places; false: interrupted.
    Result<bool> run(const stats::Points& points, SearchPhase phase, const std::vector<double>& improvements = {});
    /// Runs the fast model there, as far as it has runs left.
    Result<bool> run_fast(stats::Points points, SearchPhase phase);
    /// One of them; the runs go to `made`.
    Result<bool> run(const ForwardModel& model, std::vector<SearchRun>& made, const stats::Points& points,
                     SearchPhase phase);
    /// The design; false: interrupted.
    Result<bool> make_design();
    Result<bool> make_design_beside_fast(std::size_t count);
    /// Rounds of runs until nothing is gained or none are left; false: interrupted.
    Result<bool> make_rounds();
    Result<bool> refine_fast(std::size_t count);
    Result<bool> make_checks();
    [[nodiscard]] bool beside_fast() const { return options_.fast_runs > 0; }
    [[nodiscard]] std::size_t checks() const { return std::min(options_.checks, options_.runs / 4); }
    [[nodiscard]] std::size_t fast_left() const { return options_.fast_runs - result_.fast_runs.size(); }
    /// Emulators of all complete runs.
    void fit();
    void fit_fast();
    /// The same with expected values for failed runs, so that their places are not chosen again.
    [[nodiscard]] Fit with_failed() const;
    [[nodiscard]] stats::Points run_points() const;
    [[nodiscard]] double least_misfit(const Fit& fit) const;
    void choose(std::size_t count, stats::Points& points, std::vector<double>& improvements);
    /// The draw of a posterior where the emulators are least certain, apart from those places; empty: none is.
    [[nodiscard]] static std::vector<double> least_certain(const Fit& fit, const stats::Points& draws,
                                                           const stats::Points& apart, const stats::Points& from);
    [[nodiscard]] stats::ChainOptions seeded(stats::ChainOptions options) const {
        options.seed = options_.seed * 1000 + result_.runs.size();
        return options;
    }
    void judge_checks(const Fit& before);

    const std::vector<stats::Distribution>& priors_;
    const std::vector<ensemble::ObservedValue>& observed_;
    const ForwardModel& model_;
    const ForwardModel& fast_;
    const SearchOptions options_;
    const FitReader& on_fit_;
    SearchResult result_;
    Fit fast_fit_;
    std::size_t rounds_ = 0;
};

stats::Points Searcher::run_points() const {
    return points_of(result_.runs, false);
}

Result<bool> Searcher::run(const ForwardModel& model, std::vector<SearchRun>& made, const stats::Points& points,
                           SearchPhase phase) {
    stats::Points all = points_of(made, false);
    all.insert(all.end(), points.begin(), points.end());
    TALUS_ASSIGN(const auto predicted, model(all, phase));
    if (!predicted) {
        result_.interrupted = true;
        return false;
    }
    for (const auto& point : points) {
        SearchRun run;
        run.point = point;
        run.phase = phase;
        run.predicted = (*predicted)[made.size()];
        run.misfit = observe::never;
        if (!run.predicted.empty()) {
            run.misfit = misfit_of(observed_, run.predicted);
            for (std::size_t k = 0; k < priors_.size(); ++k) run.misfit += prior_misfit(priors_[k], point[k]);
        }
        made.push_back(std::move(run));
    }
    return true;
}

Result<bool> Searcher::run(const stats::Points& points, SearchPhase phase, const std::vector<double>& improvements) {
    const std::size_t before = result_.runs.size();
    TALUS_ASSIGN(const bool went_on, run(model_, result_.runs, points, phase));
    for (std::size_t i = before; i < result_.runs.size(); ++i) {
        SearchRun& made = result_.runs[i];
        if (i - before < improvements.size()) made.improvement = improvements[i - before];
        const auto& best = result_.best;
        if (!made.predicted.empty() && (!best || made.misfit < result_.runs[*best].misfit)) result_.best = i;
    }
    return went_on;
}

Result<bool> Searcher::run_fast(stats::Points points, SearchPhase phase) {
    points.resize(std::min(points.size(), fast_left()));
    if (points.empty()) return true;
    TALUS_ASSIGN(const bool went_on, run(fast_, result_.fast_runs, points, phase));
    if (went_on) fit_fast();
    return went_on;
}

void Searcher::fit_fast() {
    const stats::Points points = points_of(result_.fast_runs, true);
    fast_fit_ = {priors_, observed_, {}};
    for (std::size_t j = 0; j < observed_.size() && !points.empty(); ++j) {
        fast_fit_.emulators.push_back(
            stats::PredictionEmulator::fit(points, predictions_of(result_.fast_runs, j), observed_[j].unreached));
    }
}

void Searcher::fit() {
    const stats::Points points = points_of(result_.runs, true);
    result_.fit = {priors_, observed_, {}};
    for (std::size_t j = 0; j < observed_.size(); ++j) {
        const std::vector<double> values = predictions_of(result_.runs, j);
        result_.fit.emulators.push_back(
            beside_fast() ? stats::PredictionEmulator::fit_beside(fast_fit_.emulators[j], points, values)
                          : stats::PredictionEmulator::fit(points, values, observed_[j].unreached));
    }
    if (on_fit_ && result_.best) on_fit_(result_);
}

bool near_any(const std::vector<double>& point, const stats::Points& others) {
    return std::any_of(others.begin(), others.end(), [&](const auto& other) {
        return square_distance(point, other) < least_distance * least_distance;
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

std::vector<double> Searcher::least_certain(const Fit& fit, const stats::Points& draws, const stats::Points& apart,
                                            const stats::Points& from) {
    std::vector<double> chosen;
    double most = -1;
    for (const auto& row : draws) {
        if (near_any(row, apart) || near_any(row, from)) continue;  // a repeated run adds no information
        const double share = fit.emulator_share(row);
        if (share <= most) continue;
        most = share;
        chosen = row;
    }
    return chosen;
}

double mean_share(const Fit& fit, const stats::Points& draws) {
    double sum = 0;
    for (const auto& row : draws) sum += fit.emulator_share(row) / static_cast<double>(draws.size());
    return sum;
}

void Searcher::choose(std::size_t count, stats::Points& points, std::vector<double>& improvements) {
    Fit fit = with_failed();
    const stats::Points runs = run_points();
    const Posterior posterior = sample_posterior(fit, runs, seeded(short_chains));
    const double least = least_misfit(fit);
    const std::size_t factors = priors_.size();
    const std::vector<double> best_point = result_.runs[*result_.best].point;
    result_.improvement = 0;
    result_.emulator_share = mean_share(fit, posterior.draws);
    const std::size_t first = count == 1 ? rounds_ : 0;  // rounds of one run take turns in what they are for
    // Each choice is assumed to give its expected result, so that the next one lies elsewhere ("kriging believer":
    // Ginsbourger, Le Riche & Carraro 2010).
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<double> chosen;
        double improvement = 0;
        if ((first + i) % 2 == 0) {
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
            if (auto row = least_certain(fit, posterior.draws, points, runs); !row.empty()) chosen = std::move(row);
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

Result<bool> Searcher::make_design() {
    const std::size_t factors = priors_.size(), ten_each = 10 * factors;
    if (beside_fast()) {
        // Three fifths of the runs, as the search has little to go by before; the fast model's design leaves it a
        // third.
        const std::size_t share = std::max<std::size_t>(2, ((options_.runs - checks()) * 3 + 4) / 5);
        return make_design_beside_fast(options_.design > 0 ? options_.design : std::min(ten_each, share));
    }
    const std::size_t wanted = options_.design > 0 ? options_.design : ten_each;
    const std::size_t design = std::max(factors + 2, std::min(wanted, (options_.runs - checks()) * 2 / 3));
    return run(sample_points(stats::DesignKind::latin_hypercube, design, factors, options_.seed), SearchPhase::design);
}

Result<bool> Searcher::make_design_beside_fast(std::size_t count) {
    const std::size_t factors = priors_.size();
    const std::size_t design = std::max(factors + 2, std::min(10 * factors, options_.fast_runs * 2 / 3));
    TALUS_ASSIGN(bool went_on,
                 run_fast(sample_points(stats::DesignKind::latin_hypercube, design, factors, options_.seed),
                          SearchPhase::design));
    if (!went_on) return false;
    if (fast_fit_.emulators.empty())
        return Error{"no run of the fast model is complete, so there is nothing to search by"};
    fit();
    // A third of what is left of the fast runs, where the posterior is before any run of the model itself.
    TALUS_ASSIGN(went_on, refine_fast(fast_left() / 3));
    if (!went_on) return false;
    const stats::Points fast = points_of(result_.fast_runs, true);
    const Posterior expected = sample_posterior(result_.fit, fast, seeded(short_chains));
    return run(stats::representatives(fast, expected.draws, count), SearchPhase::design);
}

/// Runs of the fast model where it is least certain within the posterior of both.
Result<bool> Searcher::refine_fast(std::size_t count) {
    count = std::min(count, fast_left());
    if (count == 0) return true;
    const stats::Points runs = points_of(result_.fast_runs, false);
    const Posterior posterior = sample_posterior(result_.fit, runs, seeded(short_chains));
    Fit fit = fast_fit_;
    stats::Points points;
    while (points.size() < count) {
        std::vector<double> chosen = least_certain(fit, posterior.draws, points, runs);
        if (chosen.empty()) break;
        fit = believe(fit, chosen);
        points.push_back(std::move(chosen));
    }
    TALUS_ASSIGN(const bool went_on, run_fast(points, SearchPhase::search));
    if (went_on) this->fit();
    return went_on;
}

Result<bool> Searcher::make_rounds() {
    const std::size_t all = options_.runs - checks();
    const std::size_t left = all > result_.runs.size() ? all - result_.runs.size() : 0;
    const std::size_t size = beside_fast() ? std::clamp<std::size_t>(left / 2, 1, options_.at_once) : options_.at_once;
    std::size_t quiet = 0;
    while (result_.runs.size() + (beside_fast() ? 1 : size) <= all) {
        const std::size_t count = std::min(size, all - result_.runs.size());
        if (beside_fast()) {
            const std::size_t planned = all + checks() - result_.runs.size();  // each beside a fast one
            const std::size_t spare = fast_left() > planned ? fast_left() - planned : 0;
            const std::size_t rounds = (all - result_.runs.size() + size - 1) / size;
            TALUS_ASSIGN(const bool refined, refine_fast(spare / rounds));
            if (!refined) return false;
        }
        stats::Points points;
        std::vector<double> improvements;
        choose(count, points, improvements);
        ++rounds_;
        const bool little = result_.improvement < little_improvement && result_.emulator_share < little_uncertainty;
        quiet = little ? quiet + 1 : 0;
        if (quiet >= quiet_rounds) {
            result_.settled = true;
            break;
        }
        TALUS_ASSIGN(bool went_on, run_fast(points, SearchPhase::search));
        if (!went_on) return false;
        TALUS_ASSIGN(went_on, run(points, SearchPhase::search, improvements));
        if (!went_on) return false;
        fit();
    }
    return true;
}

Result<bool> Searcher::make_checks() {
    const Posterior found = result_.posterior;
    const std::size_t factors = priors_.size(), count = checks();
    if (count == 0) return true;
    const Fit before = result_.fit;
    const stats::Objective misfit = [&](const std::vector<double>& p) { return before.misfit_at(p); };
    stats::Points points = {
        stats::minimise_in_cube(misfit, factors, {result_.runs[*result_.best].point}, 400 * factors).at};
    for (std::size_t i = 1; i < count; ++i) points.push_back(found.draws[i * found.draws.size() / count]);
    TALUS_ASSIGN(bool went_on, run(points, SearchPhase::check));
    if (!went_on) return false;
    judge_checks(before);
    TALUS_ASSIGN(went_on, run_fast(points, SearchPhase::check));
    if (!went_on) return false;
    fit();
    result_.posterior = sample_posterior(result_.fit, run_points(), seeded(long_chains));
    result_.emulator_share = mean_share(result_.fit, result_.posterior.draws);
    for (std::size_t k = 0; k < factors; ++k) {
        const double deviation = (found.quantile(k, 84.1) - found.quantile(k, 15.9)) / 2;
        const double moved = std::abs(result_.posterior.quantile(k, 50) - found.quantile(k, 50));
        if (deviation > 0) result_.shift = std::max(result_.shift, moved / deviation);
    }
    return true;
}

Result<SearchResult> Searcher::work() {
    TALUS_ASSIGN(bool went_on, make_design());
    if (!went_on) return result_;
    if (!result_.best) return Error{"no run of the design is complete, so there is nothing to search by"};
    fit();
    TALUS_ASSIGN(went_on, make_rounds());
    if (!went_on) return result_;
    result_.posterior = sample_posterior(result_.fit, run_points(), seeded(long_chains));
    TALUS_ASSIGN(went_on, make_checks());
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
                            const SearchOptions& options, const FitReader& on_fit, const ForwardModel& fast) {
    return Searcher(priors, observed, model, options, on_fit, fast).work();
}

}  // namespace talus::calibrate
