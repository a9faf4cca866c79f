#include "stats/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace talus::stats {
namespace {

constexpr std::size_t fewest = 4;       // blocks or runs, minimum for an estimate
constexpr std::size_t resamples = 500;  // for the intervals

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The runs of a block: [0] of sample A, [1] of B, [2 + k] of A with factor k of B.
using Block = std::vector<double>;

/// Complete blocks of `length` runs that follow each other.
std::vector<Block> whole_blocks(const std::vector<double>& results, std::size_t length) {
    std::vector<Block> blocks;
    for (std::size_t first = 0; first + length <= results.size(); first += length) {
        const auto begin = results.begin() + static_cast<std::ptrdiff_t>(first);
        Block block(begin, begin + static_cast<std::ptrdiff_t>(length));
        if (std::all_of(block.begin(), block.end(), [](double v) { return std::isfinite(v); })) {
            blocks.push_back(std::move(block));
        }
    }
    return blocks;
}

struct Indices {
    double first = 0, total = 0;
};

Indices indices_of(const std::vector<Block>& blocks, const std::vector<std::size_t>& chosen, std::size_t factor) {
    double sum = 0, square = 0;
    for (const std::size_t i : chosen) {
        sum += blocks[i][0] + blocks[i][1];
        square += blocks[i][0] * blocks[i][0] + blocks[i][1] * blocks[i][1];
    }
    const auto n = static_cast<double>(chosen.size());
    const double mean = sum / (2 * n), variance = square / (2 * n) - mean * mean;
    if (!(variance > 0)) return {};
    double first = 0, total = 0;
    for (const std::size_t i : chosen) {
        const double a = blocks[i][0], b = blocks[i][1], mixed = blocks[i][2 + factor];
        first += (b - mean) * (mixed - a);
        total += (a - mixed) * (a - mixed);
    }
    return {first / n / variance, total / (2 * n) / variance};
}

Estimate estimate(double value, std::vector<double> resampled) {
    std::sort(resampled.begin(), resampled.end());
    const auto at = [&](double share) {
        return resampled[static_cast<std::size_t>(share * static_cast<double>(resampled.size() - 1))];
    };
    return {value, at(0.025), at(0.975)};
}

void add_variance(const std::vector<Block>& blocks, std::size_t factors, std::vector<FactorEffect>& effects) {
    std::vector<std::size_t> all(blocks.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (std::size_t k = 0; k < factors; ++k) {
        std::vector<double> firsts, totals;
        for (std::size_t r = 0; r < resamples; ++r) {
            std::vector<std::size_t> chosen(blocks.size());
            for (std::size_t i = 0; i < chosen.size(); ++i) {
                chosen[i] = static_cast<std::size_t>(draw(resamples, r, i) * static_cast<double>(blocks.size()));
            }
            const Indices again = indices_of(blocks, chosen, k);
            firsts.push_back(again.first);
            totals.push_back(again.total);
        }
        const Indices found = indices_of(blocks, all, k);
        FactorEffect effect;
        effect.first = estimate(found.first, std::move(firsts));
        effect.total = estimate(found.total, std::move(totals));
        effects.push_back(effect);
    }
}

void add_screening(const Points& points, const std::vector<double>& results, std::size_t factors,
                   std::vector<FactorEffect>& effects) {
    std::vector<std::vector<double>> steps(factors);
    for (std::size_t i = 0; i + 1 < results.size(); ++i) {
        if ((i + 1) % (factors + 1) == 0) continue;  // from one trajectory to the next
        for (std::size_t k = 0; k < factors; ++k) {
            const double step = points[i + 1][k] - points[i][k];
            const double change = results[i + 1] - results[i];
            if (step != 0 && std::isfinite(change)) steps[k].push_back(change / step);
        }
    }
    for (const std::vector<double>& of_factor : steps) {
        FactorEffect effect;
        if (!of_factor.empty()) {
            effect.mean = mean_of(of_factor);
            const auto n = static_cast<double>(of_factor.size());
            for (const double e : of_factor) {
                effect.mean_size += std::abs(e) / n;
                effect.deviation += (e - effect.mean) * (e - effect.mean) / std::max(1.0, n - 1);
            }
            effect.deviation = std::sqrt(effect.deviation);
        }
        effects.push_back(effect);
    }
}

/// Ranks from 0, equal values sharing the mean of theirs.
std::vector<double> ranks_of(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<double> ranks(values.size());
    for (std::size_t first = 0; first < order.size();) {
        std::size_t last = first;
        while (last + 1 < order.size() && values[order[last + 1]] == values[order[first]]) ++last;
        for (std::size_t i = first; i <= last; ++i) ranks[order[i]] = static_cast<double>(first + last) / 2;
        first = last + 1;
    }
    return ranks;
}

double correlation_of(const std::vector<double>& a, const std::vector<double>& b) {
    const double mean_a = mean_of(a), mean_b = mean_of(b);
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        ab += (a[i] - mean_a) * (b[i] - mean_b);
        aa += (a[i] - mean_a) * (a[i] - mean_a);
        bb += (b[i] - mean_b) * (b[i] - mean_b);
    }
    return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

}  // namespace

Sensitivity sensitivity_of(DesignKind design, const Points& points, const std::vector<double>& results) {
    Sensitivity out;
    if (points.empty() || points.size() != results.size()) return out;
    const std::size_t factors = points.front().size();
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < results.size(); ++i) {
        if (std::isfinite(results[i])) known.push_back(i);
    }
    const bool flat =
        std::all_of(known.begin(), known.end(), [&](std::size_t i) { return results[i] == results[known[0]]; });
    if (design == DesignKind::saltelli) {
        out.kind = SensitivityKind::variance;
        const std::vector<Block> blocks = whole_blocks(results, factors + 2);
        out.used = blocks.size();
        if (out.used >= fewest && !flat) add_variance(blocks, factors, out.effects);
        return out;
    }
    if (design == DesignKind::morris) {
        out.kind = SensitivityKind::screening;
        out.used = whole_blocks(results, factors + 1).size();
        if (out.used >= 2 && !flat) add_screening(points, results, factors, out.effects);
        return out;
    }
    out.used = known.size();
    if (out.used < fewest || flat) return out;
    std::vector<double> of_result;
    of_result.reserve(known.size());
    for (const std::size_t i : known) of_result.push_back(results[i]);
    const std::vector<double> result_ranks = ranks_of(of_result);
    for (std::size_t k = 0; k < factors; ++k) {
        std::vector<double> of_factor;
        of_factor.reserve(known.size());
        for (const std::size_t i : known) of_factor.push_back(points[i][k]);
        FactorEffect effect;
        effect.correlation = correlation_of(ranks_of(of_factor), result_ranks);
        out.effects.push_back(effect);
    }
    return out;
}

}  // namespace talus::stats
