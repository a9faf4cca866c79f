#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrate/calibration_products.hpp"
#include "ensemble/reduction.hpp"

namespace talus::calibrate {
namespace {

constexpr std::size_t map_cells = 40, other_places = 48;
constexpr double end_share = 0.05;  // a posterior whose median is this close to an end of the range counts as at the
                                    // end
constexpr double largest_r_hat = 1.05;
constexpr double min_draws = 400;

FactorResult summarise_factor(const Calibration& c, std::size_t k) {
    const stats::Distribution& prior = c.factors[k].distribution;
    const Posterior& posterior = c.result.posterior;
    const double low = posterior.quantile(k, 2.5), middle = posterior.quantile(k, 50),
                 high = posterior.quantile(k, 97.5);
    FactorResult f;
    f.best = prior.quantile(c.result.runs[*c.result.best].point[k]);
    f.median = prior.quantile(middle);
    f.low = prior.quantile(low);
    f.high = prior.quantile(high);
    f.prior_low = prior.quantile(0.025);
    f.prior_high = prior.quantile(0.975);
    f.kept = (high - low) / 0.95;
    f.r_hat = posterior.r_hat[k];
    f.effective = posterior.effective[k];
    if (middle < end_share) f.against = FactorResult::End::low;
    if (middle > 1 - end_share) f.against = FactorResult::End::high;
    return f;
}

/// The prediction, or its substitute if there is none.
double filled(const ensemble::ObservedValue& observed, double predicted) {
    return std::isfinite(predicted) ? predicted : observed.unreached;
}

/// Over the places where both models ran and have a value.
void compare_models(const SearchResult& result, std::size_t observation, ObservationResult& o) {
    std::vector<double> differences;
    for (const SearchRun& run : result.runs) {
        const auto twin = std::find_if(result.fast_runs.begin(), result.fast_runs.end(),
                                       [&](const SearchRun& fast) { return fast.point == run.point; });
        if (run.predicted.empty() || twin == result.fast_runs.end() || twin->predicted.empty()) continue;
        const double difference = run.predicted[observation] - twin->predicted[observation];
        if (std::isfinite(difference)) differences.push_back(difference);
    }
    o.pairs = differences.size();
    if (o.pairs == 0) return;
    const auto n = static_cast<double>(o.pairs);
    double sum = 0, square = 0;
    for (const double d : differences) sum += d;
    o.model_difference = sum / n;
    for (const double d : differences) square += (d - o.model_difference) * (d - o.model_difference);
    o.model_spread = o.pairs > 1 ? std::sqrt(square / (n - 1)) : observe::never;
}

ObservationResult summarise_observation(const Calibration& c, std::size_t j) {
    const ensemble::ObservedValue& observed = c.observed[j];
    const SearchResult& result = c.result;
    ObservationResult o;
    o.best = result.runs[*result.best].predicted[j];
    o.deviation = deviation_of(observed, filled(observed, o.best));
    std::vector<double> design, expected;
    // Of two models, the faster one has the design that fills the ranges.
    for (const SearchRun& run : result.fast_runs.empty() ? result.runs : result.fast_runs) {
        if (run.phase == SearchPhase::design && !run.predicted.empty())
            design.push_back(filled(observed, run.predicted[j]));
    }
    if (!result.fast_runs.empty()) compare_models(result, j, o);
    o.prior_low = ensemble::percentile(design, 5);
    o.prior_high = ensemble::percentile(design, 95);
    const stats::PredictionEmulator& emulator = result.fit.emulators[j];
    for (std::size_t i = 0; i < result.posterior.draws.size(); ++i) {
        const stats::PredictionEmulator::Estimate e = emulator.at(result.posterior.draws[i]);
        const double value = e.value.mean + std::sqrt(e.value.variance + e.value.noise) * stats::normal_draw(7, i, j);
        // The emulator's error is normal, and knows of no bound: what lies beyond one is at it (a censored normal).
        const double possible = std::clamp(value, observed.least, observed.most);
        expected.push_back(stats::draw(8, i, j) < e.reached ? possible : observed.unreached);
    }
    o.median = ensemble::percentile(expected, 50);
    o.low = ensemble::percentile(expected, 2.5);
    o.high = ensemble::percentile(expected, 97.5);
    o.reach_told = emulator.reach_told();
    o.left_out = o.explained = o.noise = observe::never;
    if (!emulator.value()) return o;
    double error = 0, spread = 0, mean = 0;
    const std::vector<stats::Emulator::LeftOut> all = emulator.value()->leave_one_out();
    const auto n = static_cast<double>(all.size());
    for (const auto& run : all) mean += run.computed / n;
    for (const auto& run : all) {
        error += (run.computed - run.mean) * (run.computed - run.mean) / n;
        spread += (run.computed - mean) * (run.computed - mean) / n;
    }
    o.left_out = std::sqrt(error);
    o.explained = spread > 0 ? 1 - error / spread : observe::never;
    o.noise = emulator.value()->noise_deviation();
    o.rho = emulator.value()->rho();
    return o;
}

std::string amount(double value, const std::string& unit) {
    return fmt::format("{:.3g}{}{}", value, unit.empty() ? "" : " ", unit);
}

void warn_of_factors(const Calibration& c, CalibrationSummary& s) {
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        const FactorResult& f = s.factors[k];
        const std::string& key = c.factors[k].key;
        if (f.against != FactorResult::End::none) {
            s.warnings.push_back(
                fmt::format("{} is pressed against the {} end of its range: the observations ask for values beyond it.",
                            key, f.against == FactorResult::End::low ? "low" : "high"));
        } else if (f.kept > 0.8) {
            s.warnings.push_back(
                fmt::format("{} is hardly constrained: its interval is {:.0f} % as wide as before the observations.",
                            key, 100 * f.kept));
        }
        for (std::size_t other = 0; other < k; ++other) {
            const double correlation = c.result.posterior.correlation(other, k);
            if (std::abs(correlation) < 0.8) continue;
            s.warnings.push_back(fmt::format(
                "{} and {} are correlated by {:.2f}: the observations know a combination of them better than either.",
                c.factors[other].key, key, correlation));
        }
        if (!(f.r_hat < largest_r_hat) || f.effective < min_draws) {
            s.warnings.push_back(
                fmt::format("The chains of {} have not converged (R-hat {:.3f}, {:.0f} effective draws).", key, f.r_hat,
                            f.effective));
        }
    }
}

void warn_of_observations(const Calibration& c, CalibrationSummary& s) {
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        const ensemble::ObservedValue& observed = c.observed[j];
        if (std::abs(o.deviation) > 2) {
            s.warnings.push_back(fmt::format(
                "{} is not explained: the best run gives {} against {} observed, {:.1f} standard deviations off.",
                observed.name, std::isfinite(o.best) ? amount(o.best, observed.unit) : "nothing",
                amount(observed.value, observed.unit), std::abs(o.deviation)));
        }
        if (o.reach_told < 0.85) {
            s.warnings.push_back(
                fmt::format("{}: of {:.0f} % of the runs the others tell wrongly whether debris comes there at all.",
                            observed.name, 100 * (1 - o.reach_told)));
        }
        if (o.left_out > observed.uncertainty) {
            s.warnings.push_back(fmt::format(
                "The emulator of \"{}\" misses runs that it does not know by {}, more than the observation's "
                "uncertainty; more runs or narrower ranges would help.",
                observed.name, amount(o.left_out, observed.unit)));
        }
    }
}

}  // namespace

CalibrationSummary summarise(const Calibration& c) {
    CalibrationSummary s;
    for (const SearchRun& run : c.result.runs) run.predicted.empty() ? ++s.failed : ++s.complete;
    for (const SearchRun& run : c.result.fast_runs) {
        ++s.fast.made;
        s.fast.failed += run.predicted.empty() ? 1 : 0;
    }
    for (const ensemble::RunRecord& record : c.fast_records) s.fast.wall_time += record.wall_time;
    for (std::size_t k = 0; k < c.factors.size(); ++k) s.factors.push_back(summarise_factor(c, k));
    for (std::size_t j = 0; j < c.observed.size(); ++j) s.observations.push_back(summarise_observation(c, j));
    if (!c.result.checks.empty()) {
        const auto within = std::count_if(c.result.checks.begin(), c.result.checks.end(),
                                          [](const Check& check) { return check.expected(); });
        s.checks_within = static_cast<double>(within) / static_cast<double>(c.result.checks.size());
    }
    warn_of_observations(c, s);
    warn_of_factors(c, s);
    if (s.checks_within < 0.8) {
        s.warnings.push_back(
            fmt::format("Only {:.0f} % of the checking runs' results lie where the emulators expected 95 % of them.",
                        100 * s.checks_within));
    }
    if (s.failed > 0) {
        s.warnings.push_back(fmt::format("{} of {} runs failed and are left out.", s.failed, c.result.runs.size()));
    }
    if (s.fast.failed > 0) {
        s.warnings.push_back(fmt::format("{} of {} runs of the depth-averaged model failed and are left out.",
                                         s.fast.failed, s.fast.made));
    }
    if (s.fast.made > 0 && c.result.emulator_share > 1) {
        s.warnings.push_back(fmt::format(
            "With {} runs of particles, the emulators' uncertainty is {:.1f} times that of an observation over "
            "the posterior; more of these runs would narrow it.",
            s.complete, c.result.emulator_share));
    }
    return s;
}

double share_below(const stats::Distribution& distribution, double value) {
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
        const double share = (low + high) / 2;
        (distribution.quantile(share) < value ? low : high) = share;
    }
    return (low + high) / 2;
}

MisfitMap misfit_map(const Calibration& c) {
    const std::size_t factors = c.factors.size();
    MisfitMap map;
    map.cells = map_cells;
    // A normal distribution has no ends; all are cut at their outermost half percent.
    const auto share_at = [](const stats::Distribution& prior, double part) {
        return prior.kind == stats::DistributionKind::normal ? 0.005 + 0.99 * part : part;
    };
    const auto limits = [&](std::size_t k) {
        std::vector<double> values;
        for (std::size_t i = 0; i <= map_cells; ++i) {
            const stats::Distribution& prior = c.factors[k].distribution;
            values.push_back(prior.quantile(share_at(prior, static_cast<double>(i) / map_cells)));
        }
        return values;
    };
    map.x = limits(0);
    if (factors > 1) map.y = limits(1);
    stats::Points places = {c.result.runs[*c.result.best].point};
    if (factors > 2) {
        const stats::Points more = sample_points(stats::DesignKind::latin_hypercube, other_places, factors, 1);
        const stats::Points& draws = c.result.posterior.draws;
        places.insert(places.end(), more.begin(), more.end());
        for (std::size_t i = 0; i < other_places && !draws.empty(); ++i)
            places.push_back(draws[i * draws.size() / other_places]);
    }
    for (std::size_t row = 0; row < (factors > 1 ? map_cells : 1); ++row) {
        for (std::size_t column = 0; column < map_cells; ++column) {
            double least = std::numeric_limits<double>::infinity();
            for (std::vector<double> place : places) {
                place[0] = share_at(c.factors[0].distribution, (static_cast<double>(column) + 0.5) / map_cells);
                if (factors > 1) {
                    place[1] = share_at(c.factors[1].distribution, (static_cast<double>(row) + 0.5) / map_cells);
                }
                least = std::min(least, c.result.fit.misfit_at(place));
            }
            map.misfit.push_back(least);
        }
    }
    return map;
}

}  // namespace talus::calibrate
