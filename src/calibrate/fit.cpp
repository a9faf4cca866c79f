#include "calibrate/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace talus::calibrate {
namespace {

constexpr std::size_t improvement_draws = 128;
constexpr std::size_t kept_draws = 2000;
constexpr double least_likelihood = 1e-300;  // its logarithm is still finite

/// -2 log of the standard normal distribution function, also where that underflows.
double tail_misfit(double z) {
    if (z > -30) return -2 * std::log(0.5 * std::erfc(-z / std::numbers::sqrt2));
    return z * z + 2 * std::log(-z) + std::log(2 * std::numbers::pi);
}

/// Per draw a standard normal number for each observation, then a share for each: a Latin hypercube, which gives a mean
/// more accurately than as many independent draws. Always the same, so that expectations are as smooth as the
/// emulators.
const stats::Points& improvement_table(std::size_t observations) {
    thread_local stats::Points table;
    if (!table.empty() && table.front().size() == 2 * observations) return table;
    table = sample_points(stats::DesignKind::latin_hypercube, improvement_draws, 2 * observations, 1);
    stats::Distribution normal;
    normal.kind = stats::DistributionKind::normal;
    normal.deviation = 1;
    for (auto& row : table) {
        for (std::size_t j = 0; j < observations; ++j) row[j] = normal.quantile(row[j]);
    }
    return table;
}

/// Of an observation, up to a constant of the observation's own.
double log_likelihood_of(const ensemble::ObservedValue& observed, double predicted, double variance) {
    const double own = observed.uncertainty * observed.uncertainty;
    const double width = observed.kind == ensemble::ObservedValue::Kind::equal ? std::log(1 + variance / own) / 2 : 0;
    return -misfit_of(observed, predicted, variance) / 2 - width;
}

/// log(exp(a) + exp(b)); either may be minus infinity.
double log_sum(double a, double b) {
    const double more = std::max(a, b);
    return std::isinf(more) ? more : more + std::log(std::exp(a - more) + std::exp(b - more));
}

}  // namespace

double misfit_of(const ensemble::ObservedValue& observed, double predicted, double variance) {
    const double deviation = std::sqrt(observed.uncertainty * observed.uncertainty + variance);
    const double z = (predicted - observed.value) / deviation;
    switch (observed.kind) {
        case ensemble::ObservedValue::Kind::at_least:
            return tail_misfit(z);
        case ensemble::ObservedValue::Kind::below:
            return tail_misfit(-z);
        case ensemble::ObservedValue::Kind::equal:
            break;
    }
    return z * z;
}

double misfit_of(const std::vector<ensemble::ObservedValue>& observed, const std::vector<double>& predicted) {
    double sum = 0;
    for (std::size_t j = 0; j < observed.size(); ++j) {
        sum += misfit_of(observed[j], std::isfinite(predicted[j]) ? predicted[j] : observed[j].unreached);
    }
    return sum;
}

double prior_misfit(const stats::Distribution& prior, double share) {
    const double value = prior.quantile(share);
    if (prior.kind == stats::DistributionKind::normal) {
        const double z = (value - prior.middle) / prior.deviation;
        return z * z;
    }
    if (prior.kind == stats::DistributionKind::triangular) {
        const double density = value < prior.middle        ? (value - prior.low) / (prior.middle - prior.low)
                               : prior.high > prior.middle ? (prior.high - value) / (prior.high - prior.middle)
                                                           : 1;
        return -2 * std::log(std::max(density, 1e-12));
    }
    return 0;
}

double Fit::misfit_at(const std::vector<double>& point) const {
    double sum = 0;
    for (std::size_t k = 0; k < priors.size(); ++k) sum += prior_misfit(priors[k], point[k]);
    for (std::size_t j = 0; j < observed.size(); ++j) {
        const double reached = emulators[j].reached_at(point);
        double likelihood = 0;
        if (reached > 0) likelihood += reached * std::exp(-misfit_of(observed[j], emulators[j].mean_at(point)) / 2);
        if (reached < 1) likelihood += (1 - reached) * std::exp(-misfit_of(observed[j], observed[j].unreached) / 2);
        sum -= 2 * std::log(std::max(likelihood, least_likelihood));
    }
    return sum;
}

double Fit::log_likelihood(const std::vector<double>& point) const {
    double sum = 0;
    for (std::size_t j = 0; j < observed.size(); ++j) {
        const stats::PredictionEmulator::Estimate e = emulators[j].at(point);
        sum += log_sum(
            std::log(e.reached) + log_likelihood_of(observed[j], e.value.mean, e.value.variance + e.value.noise),
            std::log1p(-e.reached) + log_likelihood_of(observed[j], observed[j].unreached, 0));
    }
    return sum;
}

double Fit::expected_improvement(const std::vector<double>& point, double least) const {
    const stats::Points& table = improvement_table(observed.size());
    std::array<double, improvement_draws> misfits{};
    double prior = 0;
    for (std::size_t k = 0; k < priors.size(); ++k) prior += prior_misfit(priors[k], point[k]);
    misfits.fill(prior);
    for (std::size_t j = 0; j < observed.size(); ++j) {
        const stats::PredictionEmulator::Estimate e = emulators[j].at(point);
        const double deviation = std::sqrt(e.value.variance);
        for (std::size_t i = 0; i < improvement_draws; ++i) {
            const bool reached = table[i][observed.size() + j] < e.reached;
            misfits[i] +=
                misfit_of(observed[j], reached ? e.value.mean + deviation * table[i][j] : observed[j].unreached);
        }
    }
    double sum = 0;
    for (const double misfit : misfits) sum += std::max(0.0, least - misfit);
    return sum / static_cast<double>(improvement_draws);
}

double Fit::emulator_share(const std::vector<double>& point) const {
    double most = 0;
    for (std::size_t j = 0; j < observed.size(); ++j) {
        const stats::PredictionEmulator::Estimate e = emulators[j].at(point);
        const double step = e.value.mean - observed[j].unreached;
        const double variance = e.reached * e.value.variance + e.reached * (1 - e.reached) * step * step;
        most = std::max(most, std::sqrt(variance) / observed[j].uncertainty);
    }
    return most;
}

double Posterior::quantile(std::size_t factor, double percent) const {
    std::vector<double> values;
    for (const stats::Points& chain : chains) {
        for (const auto& row : chain) values.push_back(row[factor]);
    }
    const double rank = percent / 100 * static_cast<double>(values.size() - 1);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::llround(rank));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double Posterior::correlation(std::size_t a, std::size_t b) const {
    double n = 0, mean_a = 0, mean_b = 0, aa = 0, bb = 0, ab = 0;
    for (const auto& row : draws) {
        ++n;
        mean_a += row[a];
        mean_b += row[b];
    }
    mean_a /= n;
    mean_b /= n;
    for (const auto& row : draws) {
        aa += (row[a] - mean_a) * (row[a] - mean_a);
        bb += (row[b] - mean_b) * (row[b] - mean_b);
        ab += (row[a] - mean_a) * (row[b] - mean_b);
    }
    return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

Posterior sample_posterior(const Fit& fit, const stats::Points& runs, const stats::ChainOptions& options) {
    const stats::LogDensity density = [&](const std::vector<double>& point) { return fit.log_likelihood(point); };
    const std::size_t factors = fit.priors.size();
    stats::Points candidates = sample_points(stats::DesignKind::latin_hypercube, 400, factors, options.seed);
    candidates.insert(candidates.end(), runs.begin(), runs.end());
    stats::Chains made =
        sample_density(density, stats::spread_starts(density, candidates, chain_count, options.seed), options);

    Posterior posterior;
    posterior.chains = std::move(made.chains);
    posterior.accepted = made.accepted;
    for (std::size_t k = 0; k < factors; ++k) {
        std::vector<std::vector<double>> traces;
        for (const stats::Points& chain : posterior.chains) {
            std::vector<double>& trace = traces.emplace_back();
            for (const auto& row : chain) trace.push_back(row[k]);
        }
        posterior.r_hat.push_back(stats::split_r_hat(traces));
        posterior.effective.push_back(stats::effective_size(traces));
    }
    const std::size_t step = std::max<std::size_t>(1, options.draws * chain_count / kept_draws);
    for (const stats::Points& chain : posterior.chains) {
        for (std::size_t t = 0; t < chain.size(); t += step) posterior.draws.push_back(chain[t]);
    }
    return posterior;
}

}  // namespace talus::calibrate
