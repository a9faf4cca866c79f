#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "stats/design.hpp"

/// Draws from a density over the unit cube that is known up to a factor.
namespace talus::stats {

using LogDensity = std::function<double(const std::vector<double>&)>;

struct ChainOptions {
    std::size_t warm_up = 2000, draws = 4000;  ///< steps of each chain: discarded, kept
    std::uint64_t seed = 1;
};

struct Chains {
    std::vector<Points> chains;  ///< per chain a row per kept step
    double accepted = 0;         ///< share of the steps that moved
};

/// A Markov chain from each row of `starts` (at least two rows, in the cube, of a density above 0): random steps whose
/// covariance adapts to the draws so far (Haario, Saksman & Tamminen 2001, "An adaptive Metropolis algorithm") and
/// whose size to the acceptance rate (Andrieu & Thoms 2008, algorithm 4). Both are learned from all chains in the
/// warm-up and fixed after it. Steps out of the cube are not accepted.
[[nodiscard]] Chains sample_density(const LogDensity& density, const Points& starts, const ChainOptions& options);

/// Rows of `points` from which to start chains: drawn by density, but spread wider than the density itself.
[[nodiscard]] Points spread_starts(const LogDensity& density, const Points& points, std::size_t count,
                                   std::uint64_t seed);

/// Up to `count` of the candidates that stand for the draws: one after the other, that which brings the draws closest,
/// by the sum of squares, to the nearest of those chosen.
[[nodiscard]] Points representatives(const Points& candidates, const Points& draws, std::size_t count);

/// How far the halves of the chains disagree about one number; 1: not at all (split R-hat, Gelman et al. 2013,
/// "Bayesian Data Analysis", section 11.4). NaN where no chain moved.
[[nodiscard]] double split_r_hat(const std::vector<std::vector<double>>& chains);

/// The number of independent draws that would determine the mean equally well (Gelman et al. 2013, section 11.5;
/// correlations are summed in pairs while those are positive, Geyer 1992).
[[nodiscard]] double effective_size(const std::vector<std::vector<double>>& chains);

/// A standard normal number from the seed and two counters (Box & Muller 1958).
[[nodiscard]] double normal_draw(std::uint64_t seed, std::uint64_t row, std::uint64_t column);

}  // namespace talus::stats
