#include "stats/sampler.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace talus::stats {
namespace {

constexpr double deviation_x = 0.06, deviation_y = 0.03, correlation = 0.8;

double gauss(const std::vector<double>& p) {
    const double x = (p[0] - 0.4) / deviation_x, y = (p[1] - 0.6) / deviation_y;
    return -(x * x - 2 * correlation * x * y + y * y) / (2 * (1 - correlation * correlation));
}

std::vector<std::vector<double>> traces_of(const Chains& made, std::size_t factor) {
    std::vector<std::vector<double>> traces;
    for (const Points& chain : made.chains) {
        std::vector<double>& trace = traces.emplace_back();
        for (const auto& row : chain) trace.push_back(row[factor]);
    }
    return traces;
}

TEST(Sampler, draws_from_a_correlated_gaussian) {
    const Points starts = {{0.2, 0.4}, {0.6, 0.7}, {0.5, 0.4}, {0.3, 0.8}};
    const Chains made = sample_density(gauss, starts, {1000, 8000, 1});
    double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (const Points& chain : made.chains) {
        ASSERT_EQ(chain.size(), 8000u);
        for (const auto& row : chain) {
            ++n;
            x += row[0];
            y += row[1];
        }
    }
    x /= n;
    y /= n;
    for (const Points& chain : made.chains) {
        for (const auto& row : chain) {
            xx += (row[0] - x) * (row[0] - x) / n;
            yy += (row[1] - y) * (row[1] - y) / n;
            xy += (row[0] - x) * (row[1] - y) / n;
        }
    }
    EXPECT_NEAR(x, 0.4, 0.05 * deviation_x);
    EXPECT_NEAR(y, 0.6, 0.05 * deviation_y);
    EXPECT_NEAR(std::sqrt(xx), deviation_x, 0.04 * deviation_x);
    EXPECT_NEAR(std::sqrt(yy), deviation_y, 0.04 * deviation_y);
    EXPECT_NEAR(xy / std::sqrt(xx * yy), correlation, 0.02);
    EXPECT_NEAR(made.accepted, 0.3, 0.12);
    EXPECT_LT(split_r_hat(traces_of(made, 0)), 1.01);
    EXPECT_GT(effective_size(traces_of(made, 0)), 1500);
    EXPECT_LT(effective_size(traces_of(made, 0)), 12000);  // of 32000 that depend on each other
}

TEST(Sampler, stays_in_the_cube_and_fills_it_evenly) {
    const LogDensity flat = [](const std::vector<double>&) { return 0.0; };
    const Chains made = sample_density(flat, {{0.1}, {0.9}}, {1000, 20000, 2});
    std::vector<double> tenths(10, 0);
    for (const Points& chain : made.chains) {
        for (const auto& row : chain) {
            ASSERT_TRUE(row[0] >= 0 && row[0] <= 1);
            tenths[std::min<std::size_t>(9, static_cast<std::size_t>(row[0] * 10))] += 10.0 / 40000;
        }
    }
    for (const double share : tenths) EXPECT_NEAR(share, 1, 0.12);
}

TEST(Sampler, is_the_same_for_the_same_seed) {
    const Points starts = {{0.2, 0.4}, {0.6, 0.7}};
    EXPECT_EQ(sample_density(gauss, starts, {100, 100, 1}).chains, sample_density(gauss, starts, {100, 100, 1}).chains);
    EXPECT_NE(sample_density(gauss, starts, {100, 100, 1}).chains, sample_density(gauss, starts, {100, 100, 2}).chains);
}

TEST(Sampler, starts_are_where_the_density_is) {
    const Points starts = spread_starts(gauss, sample_points(DesignKind::latin_hypercube, 400, 2, 1), 4, 1);
    ASSERT_EQ(starts.size(), 4u);
    for (const auto& start : starts) {
        EXPECT_NEAR(start[0], 0.4, 8 * deviation_x);
        EXPECT_NEAR(start[1], 0.6, 8 * deviation_y);
    }
    EXPECT_NE(starts[0], starts[1]);
}

/// A chain of known correlation from one step to the next.
std::vector<double> autoregressive(std::uint64_t seed, double rho, double mean) {
    std::vector<double> chain = {mean};
    for (std::size_t t = 1; t < 8000; ++t) {
        chain.push_back(mean + rho * (chain.back() - mean) + std::sqrt(1 - rho * rho) * normal_draw(seed, t, 0));
    }
    return chain;
}

TEST(Convergence, counts_independent_draws) {
    for (const double rho : {0.0, 0.5, 0.9}) {
        const double expected = 32000 * (1 - rho) / (1 + rho);
        const double found = effective_size({autoregressive(1, rho, 0), autoregressive(2, rho, 0),
                                             autoregressive(3, rho, 0), autoregressive(4, rho, 0)});
        EXPECT_NEAR(found / expected, 1, 0.15) << rho;
    }
}

TEST(Convergence, sees_chains_that_disagree) {
    EXPECT_LT(split_r_hat({autoregressive(1, 0.5, 0), autoregressive(2, 0.5, 0)}), 1.01);
    EXPECT_GT(split_r_hat({autoregressive(1, 0.5, 0), autoregressive(2, 0.5, 2)}), 1.2);
    std::vector<double> drifts = autoregressive(1, 0.5, 0);
    for (std::size_t t = 0; t < drifts.size(); ++t) drifts[t] += 3e-4 * static_cast<double>(t);
    EXPECT_GT(split_r_hat({drifts, drifts}), 1.1);
    EXPECT_TRUE(std::isnan(split_r_hat({{1, 1, 1, 1}, {1, 1, 1, 1}})));
}

}  // namespace
}  // namespace talus::stats
