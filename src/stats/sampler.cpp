#include "stats/sampler.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "stats/cholesky.hpp"

namespace talus::stats {
namespace {

constexpr double wanted_acceptance = 0.3;       // between the best of one dimension (0.44) and of many (0.23)
constexpr std::size_t steps_per_learning = 25;  // of each chain

/// The covariance of random steps, learned from draws.
class Proposal {
  public:
    explicit Proposal(std::size_t dimensions) : dimensions_(dimensions), factor_(dimensions * dimensions, 0) {
        for (std::size_t k = 0; k < dimensions; ++k) factor_[k * dimensions + k] = 0.1;  // of the cube, initially
    }

    /// A step from normal numbers.
    void step(const std::vector<double>& normal, std::vector<double>& at) const {
        for (std::size_t i = 0; i < dimensions_; ++i) {
            for (std::size_t j = 0; j <= i; ++j) at[i] += size_ * factor_[i * dimensions_ + j] * normal[j];
        }
    }
    void learn_size(double accepted, std::size_t round) {
        size_ *= std::exp((accepted - wanted_acceptance) * 2 / std::sqrt(static_cast<double>(round)));
        size_ = std::clamp(size_, 1e-3, 1e2);
    }
    /// From the latter halves of the chains so far.
    void learn_shape(const std::vector<Points>& chains) {
        std::vector<double> mean(dimensions_, 0), matrix(dimensions_ * dimensions_, 0);
        double count = 0;
        for (const Points& chain : chains) {
            for (std::size_t t = chain.size() / 2; t < chain.size(); ++t, ++count) {
                for (std::size_t k = 0; k < dimensions_; ++k) mean[k] += chain[t][k];
            }
        }
        for (double& m : mean) m /= count;
        for (const Points& chain : chains) {
            for (std::size_t t = chain.size() / 2; t < chain.size(); ++t) {
                for (std::size_t i = 0; i < dimensions_; ++i) {
                    for (std::size_t j = 0; j <= i; ++j) {
                        matrix[i * dimensions_ + j] += (chain[t][i] - mean[i]) * (chain[t][j] - mean[j]) / count;
                    }
                }
            }
        }
        for (std::size_t k = 0; k < dimensions_; ++k) matrix[k * dimensions_ + k] += 1e-8;  // chains may not have moved
        if (cholesky(matrix, dimensions_)) factor_ = std::move(matrix);
    }

  private:
    std::size_t dimensions_;
    double size_ = 1;
    std::vector<double> factor_;
};

double mean_of(const double* from, std::size_t count) {
    return std::accumulate(from, from + count, 0.0) / static_cast<double>(count);
}

/// Variance within the sequences and an estimate of the whole variance, both NaN where nothing moves.
struct Variances {
    double within = std::numeric_limits<double>::quiet_NaN(), whole = within;
    std::vector<const double*> sequences;  ///< each chain in two halves
    std::size_t length = 0;
};

Variances variances_of(const std::vector<std::vector<double>>& chains) {
    Variances v;
    v.length = chains.front().size() / 2;
    for (const std::vector<double>& chain : chains) {
        v.sequences.push_back(chain.data());
        v.sequences.push_back(chain.data() + (chain.size() - v.length));
    }
    if (v.length < 2) return v;
    const auto n = static_cast<double>(v.length), m = static_cast<double>(v.sequences.size());
    std::vector<double> means;
    double within = 0, between = 0;
    for (const double* sequence : v.sequences) {
        means.push_back(mean_of(sequence, v.length));
        for (std::size_t t = 0; t < v.length; ++t) {
            within += (sequence[t] - means.back()) * (sequence[t] - means.back()) / (m * (n - 1));
        }
    }
    const double mean = mean_of(means.data(), means.size());
    for (const double other : means) between += n * (other - mean) * (other - mean) / (m - 1);
    if (within > 0) {
        v.within = within;
        v.whole = (n - 1) / n * within + between / n;
    }
    return v;
}

}  // namespace

double normal_draw(std::uint64_t seed, std::uint64_t row, std::uint64_t column) {
    const double radius = std::sqrt(-2 * std::log(draw(seed, row, 2 * column)));
    return radius * std::cos(2 * std::numbers::pi * draw(seed, row, 2 * column + 1));
}

Points spread_starts(const LogDensity& density, const Points& points, std::size_t count, std::uint64_t seed) {
    // Weighted draws without replacement: the largest of log(weight) - log(-log(u)) (Efraimidis & Spirakis 2006). A
    // quarter of the logarithm is a density of twice the width.
    std::vector<std::pair<double, std::size_t>> order;
    order.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        order.emplace_back(density(points[i]) / 4 - std::log(-std::log(draw(seed, i, 0))), i);
    }
    std::sort(order.rbegin(), order.rend());
    Points starts;
    for (std::size_t i = 0; i < count; ++i) starts.push_back(points[order[i % order.size()].second]);
    return starts;
}

Chains sample_density(const LogDensity& density, const Points& starts, const ChainOptions& options) {
    const std::size_t count = starts.size(), dimensions = starts.front().size();
    Chains made;
    made.chains.resize(count);
    std::vector<Points> warm(count);
    Points at = starts;
    std::vector<double> level;
    for (const auto& point : at) level.push_back(density(point));
    Proposal proposal(dimensions);
    std::vector<double> normal(dimensions);
    std::size_t moved = 0, round = 0;
    const std::size_t steps = options.warm_up + options.draws;
    for (std::size_t t = 0; t < steps; ++t) {
        for (std::size_t c = 0; c < count; ++c) {
            const std::uint64_t row = t * count + c;
            for (std::size_t k = 0; k < dimensions; ++k) normal[k] = normal_draw(options.seed, row, k + 1);
            std::vector<double> next = at[c];
            proposal.step(normal, next);
            const bool inside = std::all_of(next.begin(), next.end(), [](double u) { return u >= 0 && u <= 1; });
            const double there = inside ? density(next) : -std::numeric_limits<double>::infinity();
            if (there - level[c] > std::log(draw(options.seed, row, 0))) {
                at[c] = std::move(next);
                level[c] = there;
                ++moved;
            }
            (t < options.warm_up ? warm : made.chains)[c].push_back(at[c]);
        }
        if (t < options.warm_up && (t + 1) % steps_per_learning == 0) {
            proposal.learn_size(static_cast<double>(moved) / static_cast<double>(steps_per_learning * count), ++round);
            if (t + 1 >= 8 * steps_per_learning) proposal.learn_shape(warm);
            moved = 0;
        }
        if (t + 1 == options.warm_up) moved = 0;
    }
    made.accepted = static_cast<double>(moved) / static_cast<double>(options.draws * count);
    return made;
}

Points representatives(const Points& candidates, const Points& draws, std::size_t count) {
    const auto square_distance = [](const std::vector<double>& a, const std::vector<double>& b) {
        double square = 0;
        for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
        return square;
    };
    Points chosen;
    std::vector<double> nearest(draws.size(), std::numeric_limits<double>::infinity());
    while (chosen.size() < std::min(count, candidates.size())) {
        const std::vector<double>* best = nullptr;
        double least = std::numeric_limits<double>::infinity();
        for (const auto& candidate : candidates) {
            if (std::find(chosen.begin(), chosen.end(), candidate) != chosen.end()) continue;
            double sum = 0;
            for (std::size_t i = 0; i < draws.size(); ++i)
                sum += std::min(nearest[i], square_distance(candidate, draws[i]));
            if (best != nullptr && sum >= least) continue;
            best = &candidate;
            least = sum;
        }
        if (best == nullptr) break;  // candidates that repeat each other
        chosen.push_back(*best);
        for (std::size_t i = 0; i < draws.size(); ++i)
            nearest[i] = std::min(nearest[i], square_distance(*best, draws[i]));
    }
    return chosen;
}

double split_r_hat(const std::vector<std::vector<double>>& chains) {
    const Variances v = variances_of(chains);
    return std::sqrt(v.whole / v.within);
}

double effective_size(const std::vector<std::vector<double>>& chains) {
    const Variances v = variances_of(chains);
    const double total = static_cast<double>(v.length * v.sequences.size());
    if (!(v.within > 0)) return 0;
    const auto correlation = [&](std::size_t lag) {
        double variogram = 0;
        for (const double* sequence : v.sequences) {
            for (std::size_t t = lag; t < v.length; ++t) {
                variogram += (sequence[t] - sequence[t - lag]) * (sequence[t] - sequence[t - lag]);
            }
        }
        variogram /= static_cast<double>(v.sequences.size() * (v.length - lag));
        return 1 - variogram / (2 * v.whole);
    };
    double sum = 0;
    for (std::size_t lag = 1; lag + 1 < v.length; lag += 2) {
        const double pair = correlation(lag) + correlation(lag + 1);
        if (!(pair > 0)) break;
        sum += pair;
    }
    return std::min(total, total / (1 + 2 * sum));
}

}  // namespace talus::stats
