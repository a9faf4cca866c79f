#include "stats/emulator.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
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

TEST(Cholesky, solves_a_system) {
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

TEST(Optimise, finds_the_lowest_of_several_valleys) {
    const Objective waves = [](const std::vector<double>& p) {
        return std::cos(18 * p[0]) + 4 * (p[0] - 0.55) * (p[0] - 0.55) + (p[1] - 0.3) * (p[1] - 0.3);
    };
    const Optimum best = minimise_in_cube(waves, 2, {{0.95, 0.9}}, 400);  // the start lies in another valley
    EXPECT_NEAR(best.at[0], 0.5253, 1e-2);
    EXPECT_NEAR(best.at[1], 0.3, 1e-2);
    const Optimum single = minimise_in_cube([](const std::vector<double>& p) { return p[0]; }, 1, {}, 100);
    EXPECT_NEAR(single.at[0], 0, 1e-3);
}

TEST(Optimise, stays_in_its_limits_and_keeps_the_best) {
    const Optimum best = minimise(
        [](const std::vector<double>& p) {
            EXPECT_TRUE(p[0] >= 1 && p[0] <= 2);
            return p[0] > 1.9 ? std::nan("") : -p[0];
        },
        {1}, {2}, {1.5}, 60);
    EXPECT_NEAR(best.at[0], 1.9, 0.05);
    EXPECT_LE(best.at[0], 1.9);
}

TEST(Emulator, knows_a_smooth_function_between_its_runs) {
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

TEST(Emulator, tells_noise_from_the_function) {
    const Points points = some_points(60);
    const Emulator emulator = Emulator::fit(points, values_of(points, 1.0));
    EXPECT_GT(emulator.noise_deviation(), 0.7);
    EXPECT_LT(emulator.noise_deviation(), 1.4);
    EXPECT_LT(emulator.at({0.5, 0.5}).variance, 0.5);  // of the mean: many runs know it better than one
}

TEST(Emulator, finds_that_a_factor_does_not_matter) {
    const Points points = some_points(30, 3);
    const Emulator emulator = Emulator::fit(points, values_of(points, 0));
    EXPECT_GT(emulator.lengths()[2], 3 * emulator.lengths()[0]);
}

TEST(Emulator, leaves_one_out_as_if_it_had_not_been_run) {
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

TEST(Emulator, takes_values_that_are_all_the_same) {
    const Points points = some_points(12);
    const Emulator emulator = Emulator::fit(points, std::vector<double>(12, 7.0));
    EXPECT_NEAR(emulator.mean_at({0.5, 0.5}), 7, 1e-6);
    EXPECT_LT(std::sqrt(emulator.at({0.5, 0.5}).variance), 0.1);
}

/// The pair of Forrester, Sobester & Keane (2007, "Multi-fidelity optimization via surrogate modelling", Proceedings of
/// the Royal Society A 463, section 3): the fast one is half the slow one plus a line.
double forrester(const std::vector<double>& p) {
    const double x = p[0];
    return (6 * x - 2) * (6 * x - 2) * std::sin(12 * x - 4);
}

double fast_forrester(const std::vector<double>& p) {
    return 0.5 * forrester(p) + 10 * (p[0] - 0.5) - 5;
}

using Function = double (*)(const std::vector<double>&);

std::vector<double> all_of(Function function, const Points& points) {
    std::vector<double> values;
    for (const auto& p : points) values.push_back(function(p));
    return values;
}

std::shared_ptr<const Emulator> fast_emulator(Function function, const Points& points) {
    return std::make_shared<const Emulator>(Emulator::fit(points, all_of(function, points)));
}

Points line(std::size_t count) {
    Points points;
    for (std::size_t i = 0; i < count; ++i) points.push_back({static_cast<double>(i) / static_cast<double>(count - 1)});
    return points;
}

struct Errors {
    double rms = 0;
    double within = 0;  // share of places in the 95 % interval of the function
};

Errors errors_of(const Emulator& emulator, Function function, const Points& places) {
    Errors errors;
    for (const auto& p : places) {
        const Emulator::Estimate e = emulator.at(p);
        EXPECT_NEAR(e.mean, emulator.mean_at(p), 1e-6 * (1 + std::abs(e.mean)));
        const double off = std::abs(e.mean - function(p)), n = static_cast<double>(places.size());
        errors.rms += off * off / n;
        errors.within += off <= 1.96 * std::sqrt(e.variance + e.noise) ? 1 / n : 0;
    }
    errors.rms = std::sqrt(errors.rms);
    return errors;
}

TEST(TwoModels, four_slow_runs_beside_eleven_fast_ones_tell_forresters_function) {
    const Points slow = {{0}, {0.4}, {0.6}, {1}};  // those of the paper
    const Emulator both = Emulator::fit_beside(fast_emulator(fast_forrester, line(11)), slow, all_of(forrester, slow));
    EXPECT_GT(both.rho(), 1);
    EXPECT_LT(both.rho(), 2.5);
    const Errors two = errors_of(both, forrester, line(101));
    const Errors alone = errors_of(Emulator::fit(slow, all_of(forrester, slow)), forrester, line(101));
    EXPECT_LT(two.rms, 0.3 * alone.rms);
    EXPECT_GE(two.within, 0.9);
    // six tell the relation
    const Emulator six =
        Emulator::fit_beside(fast_emulator(fast_forrester, line(11)), line(6), all_of(forrester, line(6)));
    EXPECT_NEAR(six.rho(), 2, 0.15);
    EXPECT_LT(errors_of(six, forrester, line(101)).rms, 0.5);  // of values from -6 to 16
}

/// A slow model that is the fast one times 0.8, plus a gentle difference.
double slow_wave(const std::vector<double>& p) {
    return 0.8 * wave(p) + 3 * p[0] - 2 * p[0] * p[1];
}

TEST(TwoModels, the_intervals_hold_the_slow_model_as_often_as_they_say) {
    const Points places = sample_points(DesignKind::monte_carlo, 100, 2, 5);
    double within = 0, rms = 0, alone = 0;
    constexpr int designs = 10;
    for (int seed = 1; seed <= designs; ++seed) {
        const Points fast = sample_points(DesignKind::latin_hypercube, 40, 2, static_cast<std::uint64_t>(seed));
        const Points slow(fast.begin(), fast.begin() + 8);
        const std::vector<double> values = all_of(slow_wave, slow);
        const Errors errors =
            errors_of(Emulator::fit_beside(fast_emulator(wave, fast), slow, values), slow_wave, places);
        within += errors.within / designs;
        rms += errors.rms / designs;
        alone += errors_of(Emulator::fit(slow, values), slow_wave, places).rms / designs;
    }
    EXPECT_GE(within, 0.9);
    EXPECT_LT(rms, 0.3 * alone);
}

double unrelated(const std::vector<double>& p) {
    return 5 * std::cos(9 * p[1]) + 4 * std::sin(7 * p[0] + 1);
}

TEST(TwoModels, a_fast_model_that_tells_nothing_does_little_harm) {
    const Points places = sample_points(DesignKind::monte_carlo, 100, 2, 5);
    double rms = 0, alone = 0, within = 0;
    constexpr int designs = 6;
    for (int seed = 1; seed <= designs; ++seed) {
        const Points fast = sample_points(DesignKind::latin_hypercube, 50, 2, static_cast<std::uint64_t>(seed));
        const Points slow(fast.begin(), fast.begin() + 20);
        const std::vector<double> values = all_of(wave, slow);
        const Emulator both = Emulator::fit_beside(fast_emulator(unrelated, fast), slow, values);
        const Errors errors = errors_of(both, wave, places);
        EXPECT_LT(std::abs(both.rho()), 0.3) << seed;
        rms += errors.rms / designs;
        within += errors.within / designs;
        alone += errors_of(Emulator::fit(slow, values), wave, places).rms / designs;
    }
    EXPECT_LT(rms, 1.1 * alone);
    EXPECT_GE(within, 0.9);
}

TEST(TwoModels, the_runs_need_not_be_at_the_same_places) {
    const Points slow = sample_points(DesignKind::latin_hypercube, 8, 2, 17);
    const Emulator both = Emulator::fit_beside(fast_emulator(wave, some_points(40)), slow, all_of(slow_wave, slow));
    EXPECT_LT(errors_of(both, slow_wave, some_points(50)).rms, 0.5);
}

TEST(TwoModels, without_a_slow_run_it_is_the_fast_model_and_as_doubtful_as_models_usually_are) {
    const auto fast = fast_emulator(wave, some_points(40));
    const Emulator both = Emulator::fit_beside(fast, {}, {});
    const Emulator::Estimate e = both.at({0.3, 0.6});
    EXPECT_NEAR(e.mean, fast->at({0.3, 0.6}).mean, 1e-9);
    EXPECT_GT(e.variance, 100 * fast->at({0.3, 0.6}).variance);
    // after one run it is known there
    EXPECT_NEAR(both.with({0.3, 0.6}, 20).mean_at({0.3, 0.6}), 20, 0.2);
}

TEST(TwoModels, leaves_a_slow_run_out_as_if_it_had_not_been_run) {
    const auto fast = fast_emulator(wave, some_points(40));
    Points slow = sample_points(DesignKind::latin_hypercube, 9, 2, 17);
    std::vector<double> values = all_of(slow_wave, slow);
    const std::vector<double> last = slow.back();
    const double value = values.back();
    slow.pop_back();
    values.pop_back();
    const Emulator others = Emulator::fit_beside(fast, slow, values);
    const Emulator::Estimate expected = others.at(last);
    const Emulator::LeftOut left_out = others.with(last, value).leave_one_out().back();
    EXPECT_NEAR(left_out.computed, value, 1e-9);
    EXPECT_NEAR(left_out.mean, expected.mean, 1e-5);
    EXPECT_NEAR(left_out.deviation, std::sqrt(expected.variance + expected.noise), 1e-5);
}

}  // namespace
}  // namespace talus::stats
