#include "stats/sensitivity.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace talus::stats {
namespace {

/// Ishigami & Homma's (1990) function, whose indices are known in closed form.
double ishigami(const std::vector<double>& u) {
    const auto x = [&](std::size_t k) { return std::numbers::pi * (2 * u[k] - 1); };
    return std::sin(x(0)) + 7 * std::pow(std::sin(x(1)), 2) + 0.1 * std::pow(x(2), 4) * std::sin(x(0));
}

std::vector<double> values_at(const Points& points, double (*f)(const std::vector<double>&)) {
    std::vector<double> values;
    for (const auto& p : points) values.push_back(f(p));
    return values;
}

TEST(Sensitivity, sobol_indices_of_ishigamis_function_are_the_published_ones) {
    const Points points = saltelli_points(2048, 3, 1);
    const Sensitivity s = sensitivity_of(DesignKind::saltelli, points, values_at(points, ishigami));
    ASSERT_EQ(s.kind, SensitivityKind::variance);
    ASSERT_EQ(s.effects.size(), 3u);
    const double first[] = {0.3139, 0.4424, 0}, total[] = {0.5576, 0.4424, 0.2437};
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(s.effects[k].first.value, first[k], 0.02) << k;
        EXPECT_NEAR(s.effects[k].total.value, total[k], 0.02) << k;
        EXPECT_LE(s.effects[k].first.low, first[k]) << k;
        EXPECT_GE(s.effects[k].first.high, first[k]) << k;
    }
}

TEST(Sensitivity, blocks_with_a_failed_run_are_left_out) {
    const Points points = saltelli_points(256, 3, 1);
    std::vector<double> values = values_at(points, ishigami);
    values[7] = std::nan("");
    values[8] = std::nan("");
    values[1000] = std::nan("");
    const Sensitivity s = sensitivity_of(DesignKind::saltelli, points, values);
    EXPECT_EQ(s.used, 254u);
    EXPECT_NEAR(s.effects[1].first.value, 0.4424, 0.08);
}

TEST(Sensitivity, elementary_effects_of_a_linear_result_are_its_slopes) {
    const Points points = morris_points(8, 3, 4);
    const auto f = [](const std::vector<double>& u) { return 3 * u[0] - 2 * u[1]; };
    const Sensitivity s = sensitivity_of(DesignKind::morris, points, values_at(points, f));
    ASSERT_EQ(s.effects.size(), 3u);
    EXPECT_NEAR(s.effects[0].mean_size, 3, 1e-12);
    EXPECT_NEAR(s.effects[1].mean_size, 2, 1e-12);
    EXPECT_NEAR(s.effects[1].mean, -2, 1e-12);
    EXPECT_NEAR(s.effects[2].mean_size, 0, 1e-12);
    for (const FactorEffect& e : s.effects) EXPECT_NEAR(e.deviation, 0, 1e-12);
}

TEST(Sensitivity, rank_correlation_sees_only_the_order) {
    const Points points = sample_points(DesignKind::latin_hypercube, 40, 2, 1);
    const auto f = [](const std::vector<double>& u) { return -std::exp(9 * u[0]); };
    const Sensitivity s = sensitivity_of(DesignKind::latin_hypercube, points, values_at(points, f));
    ASSERT_EQ(s.effects.size(), 2u);
    EXPECT_NEAR(s.effects[0].correlation, -1, 1e-12);
    EXPECT_LT(std::abs(s.effects[1].correlation), 0.4);
}

TEST(Sensitivity, a_result_that_never_changes_has_none) {
    const Points points = sample_points(DesignKind::monte_carlo, 40, 2, 1);
    EXPECT_TRUE(sensitivity_of(DesignKind::monte_carlo, points, std::vector<double>(40, 3.0)).effects.empty());
}

}  // namespace
}  // namespace talus::stats
