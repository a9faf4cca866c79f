#pragma once

#include <string>
#include <vector>

#include "ensemble/predict.hpp"
#include "stats/distribution.hpp"
#include "stats/prediction_emulator.hpp"
#include "stats/sampler.hpp"

/// Misfit of predictions, by runs and by emulators.
namespace talus::calibrate {

/// Twice the negative log likelihood of an observation, 0 where the prediction fits it perfectly: the square of the
/// deviation in standard deviations; of damage -2 log of the probability of that side of its limit. `variance`: of the
/// prediction, on top of the observation's own.
[[nodiscard]] double misfit_of(const ensemble::ObservedValue& observed, double predicted, double variance = 0);

/// The sum over all observations; NaN among the predictions counts as ObservedValue::unreached.
[[nodiscard]] double misfit_of(const std::vector<ensemble::ObservedValue>& observed,
                               const std::vector<double>& predicted);

/// Twice the negative logarithm of a factor's density over the greatest: 0 for ranges. `share`: of the distribution.
[[nodiscard]] double prior_misfit(const stats::Distribution& prior, double share);

/// The factors of a calibration, its observations, and an emulator per observation. Places are shares of the factors'
/// distributions: the prior is uniform over the unit cube.
struct Fit {
    std::vector<stats::Distribution> priors;
    std::vector<ensemble::ObservedValue> observed;
    std::vector<stats::PredictionEmulator> emulators;  ///< as observed

    /// Misfit of the observations and of the priors, where every prediction is the emulator's mean, or none.
    [[nodiscard]] double misfit_at(const std::vector<double>& point) const;
    /// Log likelihood up to a constant: the uncertainty of emulators and the noise of runs add to the uncertainty of
    /// the observations.
    [[nodiscard]] double log_likelihood(const std::vector<double>& point) const;
    /// Expected reduction of the misfit below `least` by a run here: expected improvement of a function of several
    /// emulated numbers (Astudillo & Frazier 2019, "Bayesian optimization of composite functions", equation 3).
    [[nodiscard]] double expected_improvement(const std::vector<double>& point, double least) const;
    /// Uncertainty of the emulators here relative to the observations: the greatest ratio of their standard deviations,
    /// including the uncertainty whether debris reaches the place.
    [[nodiscard]] double emulator_share(const std::vector<double>& point) const;
};

/// The distribution of the factors after the observations.
struct Posterior {
    std::vector<stats::Points> chains;
    stats::Points draws;  ///< some of them, evenly thinned
    double accepted = 0;
    std::vector<double> r_hat, effective;  ///< per factor

    /// The share of the prior below which `percent` of a factor's draws lie.
    [[nodiscard]] double quantile(std::size_t factor, double percent) const;
    /// Of the shares of two factors.
    [[nodiscard]] double correlation(std::size_t a, std::size_t b) const;
};

inline constexpr std::size_t chain_count = 4;

/// Draws from the posterior of the fit. `runs`: possible starts of chains, in addition to some in the whole cube.
[[nodiscard]] Posterior sample_posterior(const Fit& fit, const stats::Points& runs, const stats::ChainOptions& options);

}  // namespace talus::calibrate
