#include "stats/weighted_means.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "stats/count_distribution.hpp"

namespace talus::stats {
namespace {

TEST(WeightedMeans, are_sums_of_weight_times_mean) {
    const Estimate e = sum_of_means({{0.1, {1, 2, 3}}, {2, {4, 4}}});
    EXPECT_NEAR(e.value, 8.2, 1e-12);
    // One sample with any spread: Student's t with 2 degrees of freedom, 4.3027; standard error 0.1 / sqrt(3).
    EXPECT_NEAR(e.high - e.value, 4.3027 * 0.1 / std::sqrt(3.0), 1e-5);
    EXPECT_NEAR(e.value - e.low, e.high - e.value, 1e-12);
}

TEST(WeightedMeans, have_an_empty_interval_where_nothing_varies) {
    const Estimate e = sum_of_means({{0.5, {2, 2, 2}}});
    EXPECT_EQ(e.low, 1);
    EXPECT_EQ(e.high, 1);
}

TEST(WeightedMeans, are_within_their_interval_in_95_of_100_repetitions) {
    std::mt19937_64 random(5);
    std::exponential_distribution<double> rare(1), often(0.5);
    int within = 0;
    constexpr int repetitions = 2000;
    for (int k = 0; k < repetitions; ++k) {
        std::vector<WeightedSample> samples = {{0.02, {}}, {0.1, {}}};
        for (int run = 0; run < 40; ++run) samples[0].values.push_back(rare(random));
        for (int run = 0; run < 25; ++run) samples[1].values.push_back(often(random));
        const Estimate e = sum_of_means(samples);
        within += e.low <= 0.22 && 0.22 <= e.high ? 1 : 0;
    }
    EXPECT_NEAR(within / static_cast<double>(repetitions), 0.95, 0.025);
}

TEST(WeightedShares, are_within_their_interval_in_95_of_100_repetitions) {
    std::mt19937_64 random(6);
    std::bernoulli_distribution rare(0.05), often(0.6);
    int within = 0;
    constexpr int repetitions = 2000;
    for (int k = 0; k < repetitions; ++k) {
        std::vector<WeightedSample> samples = {{0.02, {}}, {0.01, {}}};
        for (int run = 0; run < 50; ++run) samples[0].values.push_back(rare(random) ? 1 : 0);
        for (int run = 0; run < 30; ++run) samples[1].values.push_back(often(random) ? 1 : 0);
        const Estimate e = sum_of_shares(samples);
        within += e.low <= 0.007 && 0.007 <= e.high ? 1 : 0;
    }
    EXPECT_NEAR(within / static_cast<double>(repetitions), 0.95, 0.025);
}

TEST(WeightedShares, of_nothing_seen_still_have_an_upper_limit) {
    const Estimate e = sum_of_shares({{0.1, std::vector<double>(60, 0)}});
    EXPECT_EQ(e.value, 0);
    EXPECT_NEAR(e.low, 0, 1e-15);
    EXPECT_NEAR(e.high, 0.1 * 0.0602, 1e-5);  // Wilson: z2 / (n + z2)
}

TEST(CountDistribution, sums_independent_counts) {
    CountDistribution two;
    two.add_binomial(1, 0.5);
    two.add_binomial(2, 0.1);
    const std::vector<double> sums = two.at_least();
    ASSERT_EQ(sums.size(), 4U);
    EXPECT_EQ(sums[0], 1);
    EXPECT_NEAR(sums[1], 1 - 0.5 * 0.81, 1e-12);
    EXPECT_NEAR(sums[3], 0.5 * 0.01, 1e-12);
}

TEST(CountDistribution, of_poisson_has_its_terms) {
    CountDistribution road;
    road.add_poisson(0.3);
    const std::vector<double> sums = road.at_least();
    EXPECT_NEAR(sums[1], 1 - std::exp(-0.3), 1e-12);
    EXPECT_NEAR(sums[2], 1 - 1.3 * std::exp(-0.3), 1e-12);
}

TEST(CountDistribution, of_nobody_is_certainly_none) {
    CountDistribution none;
    none.add_binomial(0, 0.5);
    none.add_binomial(3, 0);
    none.add_poisson(0);
    EXPECT_EQ(none.at_least(), std::vector<double>{1});
}

}  // namespace
}  // namespace talus::stats
