#include "stats/emulator.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "stats/cholesky.hpp"
#include "stats/optimise.hpp"
#include "stats/sampler.hpp"

namespace talus::stats {
namespace {

double wave(const std::vector<double>& p) {
    return 20 + 5 * std::sin(5 * p[0]) + 8 * p[1] * p[1];
}

Points some_points(std::size_t count, std::size_t factors = 2) {
    return sample_points(DesignKind::latin_hypercube, count, factors, 3);
}

std::vector<double> values_of(const Points& points, double noise) {
    std::vector<double> values;
    for (std::size_t i = 0; i < points.size(); ++i) {
        values.push_back(wave(points[i]) + (noise > 0 ? noise * normal_draw(9, i, 0) : 0));
    }
    return values;
}

TEST(Cholesky, SolvesASystem) {
    std::vector<double> a = {4, 2, 0.6, 2, 5, 1, 0.6, 1, 3};  // A (1, -2, 3) is the right-hand side
    std::vector<double> b = {4 - 4 + 1.8, 2 - 10 + 3, 0.6 - 2 + 9};
    ASSERT_TRUE(cholesky(a, 3));
    solve_lower(a, b);
    solve_upper(a, b);
    EXPECT_NEAR(b[0], 1, 1e-12);
    EXPECT_NEAR(b[1], -2, 1e-12);
    EXPECT_NEAR(b[2], 3, 1e-12);
    std::vector<double> indefinite = {1, 0, 2, 1};
    EXPECT_FALSE(cholesky(indefinite, 2));
}

TEST(Optimise, FindsTheLowestOfSeveralValleys) {
    const Objective waves = [](const std::vector<double>& p) {
        return std::cos(18 * p[0]) + 4 * (p[0] - 0.55) * (p[0] - 0.55) + (p[1] - 0.3) * (p[1] - 0.3);
    };
    const Optimum best = minimise_in_cube(waves, 2, {{0.95, 0.9}}, 400);  // the start lies in another valley
    EXPECT_NEAR(best.at[0], 0.5253, 1e-2);
    EXPECT_NEAR(best.at[1], 0.3, 1e-2);
    const Optimum single = minimise_in_cube([](const std::vector<double>& p) { return p[0]; }, 1, {}, 100);
    EXPECT_NEAR(single.at[0], 0, 1e-3);
}

TEST(Optimise, StaysInItsLimitsAndKeepsTheBest) {
    const Optimum best = minimise(
        [](const std::vector<double>& p) {
            EXPECT_TRUE(p[0] >= 1 && p[0] <= 2);
            return p[0] > 1.9 ? std::nan("") : -p[0];
        },
        {1}, {2}, {1.5}, 60);
    EXPECT_NEAR(best.at[0], 1.9, 0.05);
    EXPECT_LE(best.at[0], 1.9);
}

TEST(Emulator, KnowsASmoothFunctionBetweenItsRuns) {
    const Points points = some_points(30);
    const Emulator emulator = Emulator::fit(points, values_of(points, 0));
    double square = 0;
    int within = 0;
    const Points elsewhere = sample_points(DesignKind::monte_carlo, 200, 2, 5);
    for (const auto& p : elsewhere) {
        const Emulator::Estimate e = emulator.at(p);
        EXPECT_NEAR(e.mean, emulator.mean_at(p), 1e-9);
        square += (e.mean - wave(p)) * (e.mean - wave(p)) / 200;
        within += std::abs(e.mean - wave(p)) < 3 * std::sqrt(e.variance + e.noise) ? 1 : 0;
    }
    EXPECT_LT(std::sqrt(square), 0.15);  // of values that spread over 15
    EXPECT_GT(within, 190);
    EXPECT_LT(emulator.noise_deviation(), 0.1);
}

TEST(Emulator, TellsNoiseFromTheFunction) {
    const Points points = some_points(60);
    const Emulator emulator = Emulator::fit(points, values_of(points, 1.0));
    EXPECT_GT(emulator.noise_deviation(), 0.7);
    EXPECT_LT(emulator.noise_deviation(), 1.4);
    EXPECT_LT(emulator.at({0.5, 0.5}).variance, 0.5);  // of the mean: many runs know it better than one
}

TEST(Emulator, FindsThatAFactorDoesNotMatter) {
    const Points points = some_points(30, 3);
    const Emulator emulator = Emulator::fit(points, values_of(points, 0));
    EXPECT_GT(emulator.lengths()[2], 3 * emulator.lengths()[0]);
}

TEST(Emulator, LeavesOneOutAsIfItHadNotBeenRun) {
    Points points = some_points(20);
    std::vector<double> values = values_of(points, 0.3);
    const std::vector<double> last = points.back();
    const double value = values.back();
    points.pop_back();
    values.pop_back();
    const Emulator others = Emulator::fit(points, values);
    const Emulator::Estimate expected = others.at(last);
    const Emulator::LeftOut left_out = others.with(last, value).leave_one_out().back();
    EXPECT_NEAR(left_out.computed, value, 1e-9);
    EXPECT_NEAR(left_out.mean, expected.mean, 1e-6);
    EXPECT_NEAR(left_out.deviation, std::sqrt(expected.variance + expected.noise), 1e-6);
}

TEST(Emulator, TakesValuesThatAreAllTheSame) {
    const Points points = some_points(12);
    const Emulator emulator = Emulator::fit(points, std::vector<double>(12, 7.0));
    EXPECT_NEAR(emulator.mean_at({0.5, 0.5}), 7, 1e-6);
    EXPECT_LT(std::sqrt(emulator.at({0.5, 0.5}).variance), 0.1);
}

}  // namespace
}  // namespace talus::stats
