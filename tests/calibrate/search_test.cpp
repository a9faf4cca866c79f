#include "calibrate/search.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "observe/observation.hpp"

namespace talus::calibrate {
namespace {

using Kind = ensemble::ObservedValue::Kind;

stats::Distribution range(double low, double high) {
    stats::Distribution d;
    d.low = low;
    d.high = high;
    return d;
}

const std::vector<stats::Distribution> priors = {range(0.1, 0.5), range(0, 0.4)};

/// A block that slides down a slope with friction f and a drag that grows with mu: its velocity at two places, none
/// where it does not get there. `wobble`: what falls out differently from run to run.
std::vector<double> slide(const std::vector<double>& point, double wobble = 0) {
    const double f = priors[0].quantile(point[0]), mu = priors[1].quantile(point[1]);
    const auto velocity = [&](double drop, double way) {
        const double square = 2 * 9.81 * (drop - f * way) / (1 + 4 * mu * way / 100);
        return square > 0 ? std::sqrt(square) + wobble * std::sin(1e4 * (point[0] + 3 * point[1]) + way)
                          : observe::never;
    };
    return {velocity(30, 60), velocity(55, 200)};
}

double filled(double value) {
    return std::isfinite(value) ? value : 0;
}

std::vector<ensemble::ObservedValue> observed_as(const std::vector<double>& values) {
    return {{"a", "Front velocity at 60 m", "m/s", filled(values[0]), 1.0, Kind::equal, 0},
            {"b", "Front velocity at 200 m", "m/s", filled(values[1]), 1.0, Kind::equal, 0}};
}

ForwardModel model_of(double wobble = 0) {
    return [wobble](const stats::Points& points, SearchPhase) -> Result<std::optional<stats::Points>> {
        stats::Points predicted;
        for (const auto& p : points) predicted.push_back(slide(p, wobble));
        return std::optional(predicted);
    };
}

TEST(Misfit, is_the_square_of_the_deviation) {
    const ensemble::ObservedValue velocity{"", "", "", 10, 2, Kind::equal, 0};
    EXPECT_DOUBLE_EQ(misfit_of(velocity, 10), 0);
    EXPECT_DOUBLE_EQ(misfit_of(velocity, 14), 4);
    EXPECT_DOUBLE_EQ(misfit_of(velocity, 14, 12), 1);  // what is uncertain weighs less
}

TEST(Misfit, of_damage_counts_the_wrong_side_only) {
    const ensemble::ObservedValue damaged{"", "", "", 30, 5, Kind::at_least, 0},
        whole{"", "", "", 30, 5, Kind::below, 0};
    EXPECT_NEAR(misfit_of(damaged, 60), 0, 1e-6);
    EXPECT_NEAR(misfit_of(damaged, 30), 2 * std::log(2), 1e-12);
    EXPECT_GT(misfit_of(damaged, 10), 16);
    EXPECT_NEAR(misfit_of(whole, 0), 0, 1e-6);
    EXPECT_GT(misfit_of(whole, 50), 16);
    // the tail's approximation goes on where the function underflows
    EXPECT_NEAR(misfit_of(damaged, 30 - 5 * 30.001) - misfit_of(damaged, 30 - 5 * 29.999), 0.12, 0.01);
}

TEST(Misfit, of_priors_is_minus_twice_the_log_density) {
    stats::Distribution normal;
    normal.kind = stats::DistributionKind::normal;
    normal.middle = 3;
    normal.deviation = 0.5;
    EXPECT_NEAR(prior_misfit(normal, 0.5), 0, 1e-9);
    EXPECT_NEAR(prior_misfit(normal, 0.975), 1.96 * 1.96, 1e-2);
    EXPECT_EQ(prior_misfit(priors[0], 0.9), 0);
    const stats::Distribution triangular{stats::DistributionKind::triangular, 0, 2, 1, 0, {}};
    EXPECT_NEAR(prior_misfit(triangular, 0.125), -2 * std::log(0.5), 1e-9);  // half way up
}

/// A front that passes a bend at 12 m/s or more, or stops in it.
std::vector<double> bend_values(const stats::Points& points) {
    std::vector<double> values;
    for (const auto& p : points) values.push_back(p[0] + 0.2 * p[1] < 0.6 ? 12 + 3 * p[1] : observe::never);
    return values;
}

TEST(PredictionEmulator, tells_nothing_from_little) {
    const stats::Points points = sample_points(stats::DesignKind::latin_hypercube, 40, 2, 1);
    const stats::PredictionEmulator emulator = stats::PredictionEmulator::fit(points, bend_values(points), 0);
    EXPECT_GT(emulator.reached_at({0.2, 0.5}), 0.95);
    EXPECT_LT(emulator.reached_at({0.8, 0.5}), 0.05);
    EXPECT_NEAR(emulator.reached_at({0.5, 0.5}), 0.5, 0.45);
    EXPECT_NEAR(emulator.at({0.45, 0.5}).value.mean, 13.5, 0.3);  // beside the edge, not half way to nothing
    EXPECT_GT(emulator.reach_told(), 0.85);
    const ensemble::ObservedValue slow{"", "", "m/s", 6, 1.5, Kind::equal, 0};
    const Fit fit{priors, {slow}, {emulator}};
    EXPECT_GT(fit.misfit_at({0.5, 0.5}), 10);  // no run is half as fast on the edge
    EXPECT_GT(fit.emulator_share({0.5, 0.5}), 1.5);
    EXPECT_LT(fit.emulator_share({0.2, 0.5}), 0.7);
}

TEST(PredictionEmulator, does_without_values_or_without_gaps) {
    const stats::Points points = sample_points(stats::DesignKind::latin_hypercube, 10, 2, 1);
    const stats::PredictionEmulator none =
        stats::PredictionEmulator::fit(points, std::vector<double>(10, observe::never), -15);
    EXPECT_EQ(none.reached_at({0.5, 0.5}), 0);
    EXPECT_EQ(none.mean_at({0.5, 0.5}), -15);
    EXPECT_FALSE(none.value());
    const stats::PredictionEmulator all = stats::PredictionEmulator::fit(points, std::vector<double>(10, 4.0), 0);
    EXPECT_EQ(all.reached_at({0.5, 0.5}), 1);
    const Fit fit{priors, {{"", "", "", 5, 1, Kind::equal, 0}}, {none}};
    EXPECT_TRUE(std::isfinite(fit.log_likelihood({0.5, 0.5})));
}

TEST(Fit, expects_the_improvement_that_draws_of_the_emulators_have) {
    const stats::Points points = sample_points(stats::DesignKind::latin_hypercube, 8, 2, 1);
    std::vector<double> first, second;
    for (const auto& p : points) {
        first.push_back(slide(p)[0]);
        second.push_back(slide(p)[1]);
    }
    const Fit fit{
        priors,
        observed_as({12, 9}),
        {stats::PredictionEmulator::fit(points, first, 0), stats::PredictionEmulator::fit(points, second, 0)}};
    const std::vector<double> place = {0.4, 0.6};
    const stats::Emulator::Estimate a = fit.emulators[0].at(place).value, b = fit.emulators[1].at(place).value;
    const double reached = fit.emulators[1].reached_at(place);
    constexpr double least = 80;  // most draws improve on it, so that 128 of them tell the mean
    double expected = 0;
    constexpr std::size_t draws = 20000;
    for (std::size_t i = 0; i < draws; ++i) {
        const double x = a.mean + std::sqrt(a.variance) * stats::normal_draw(77, i, 0) - 12;
        const double y = b.mean + std::sqrt(b.variance) * stats::normal_draw(77, i, 1) - 9;
        const double missed = stats::draw(78, i, 0) < reached ? y : -9;
        expected += std::max(0.0, least - x * x - missed * missed) / draws;
    }
    ASSERT_GT(expected, 1);
    EXPECT_NEAR(fit.expected_improvement(place, least) / expected, 1, 0.1);
    EXPECT_GT(fit.expected_improvement(place, 31), fit.expected_improvement(place, 30));
    EXPECT_EQ(fit.expected_improvement(place, 0), 0);  // nothing fits better than perfectly
}

TEST(Search, finds_what_made_the_observations) {
    const std::vector<double> truth = {0.4, 0.3};
    const auto found = search(priors, observed_as(slide(truth)), model_of(), {});
    ASSERT_TRUE(found);
    EXPECT_LE(found->runs.size(), 100u);
    EXPECT_TRUE(found->settled);
    const SearchRun& best = found->runs[*found->best];
    EXPECT_LT(best.misfit, 0.02);
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_NEAR(best.point[k], truth[k], 0.05);
        EXPECT_LT(found->posterior.quantile(k, 2.5), truth[k]);
        EXPECT_GT(found->posterior.quantile(k, 97.5), truth[k]);
        EXPECT_LT(found->posterior.r_hat[k], 1.05);
    }
    EXPECT_LT(found->posterior.quantile(0, 97.5) - found->posterior.quantile(0, 2.5), 0.6);
    EXPECT_EQ(found->runs.back().phase, SearchPhase::check);
    int within = 0;
    for (const Check& c : found->checks) within += c.expected() ? 1 : 0;
    EXPECT_EQ(found->checks.size(), 20u);
    EXPECT_GE(within, 18);
}

TEST(Search, the_posterior_is_that_of_the_model_itself) {
    const auto observed = observed_as(slide({0.4, 0.3}));
    const auto found = search(priors, observed, model_of(), {.runs = 60});
    ASSERT_TRUE(found);
    // by summing over a fine grid of the model
    std::vector<double> marginal(200, 0);
    double sum = 0;
    for (int i = 0; i < 200; ++i) {
        for (int j = 0; j < 200; ++j) {
            const double weight = std::exp(-misfit_of(observed, slide({(i + 0.5) / 200, (j + 0.5) / 200})) / 2);
            marginal[static_cast<std::size_t>(i)] += weight;
            sum += weight;
        }
    }
    const auto quantile = [&](double share) {
        double below = 0;
        for (std::size_t i = 0; i < 200; ++i) {
            below += marginal[i];
            if (below > share * sum) return (static_cast<double>(i) + 0.5) / 200;
        }
        return 1.0;
    };
    EXPECT_NEAR(found->posterior.quantile(0, 2.5), quantile(0.025), 0.03);
    EXPECT_NEAR(found->posterior.quantile(0, 50), quantile(0.5), 0.03);
    EXPECT_NEAR(found->posterior.quantile(0, 97.5), quantile(0.975), 0.03);
}

TEST(Search, returns_the_truth_within_its_interval_in_nine_of_ten_seeds) {
    constexpr std::size_t seeds = 20;
    std::size_t returned = 0;
    double width = 0;
    for (std::size_t seed = 1; seed <= seeds; ++seed) {
        const std::vector<double> truth = {stats::draw(seed, 0, 0), stats::draw(seed, 0, 1)};
        std::vector<double> values = slide(truth, 0.1);
        for (std::size_t j = 0; j < 2; ++j)
            values[j] = std::max(0.0, filled(values[j]) + stats::normal_draw(seed, 1, j));
        const auto found = search(priors, observed_as(values), model_of(0.1), {.runs = 30, .seed = seed});
        ASSERT_TRUE(found);
        bool all = true;
        for (std::size_t k = 0; k < 2; ++k) {
            const double low = found->posterior.quantile(k, 2.5), high = found->posterior.quantile(k, 97.5);
            all = all && low <= truth[k] && truth[k] <= high;
            width += (high - low) / (2 * seeds);
        }
        returned += all ? 1 : 0;
    }
    EXPECT_GE(returned, seeds * 9 / 10);
    EXPECT_LT(width, 0.75);  // intervals that span everything would return anything
}

/// Another model of the block, with less friction and slower throughout.
ForwardModel fast_model(std::size_t* made = nullptr) {
    return [made](const stats::Points& points, SearchPhase) -> Result<std::optional<stats::Points>> {
        if (made != nullptr) *made = points.size();
        stats::Points predicted;
        for (const auto& p : points) {
            std::vector<double> values = slide({0.8 * p[0], p[1]});
            for (double& v : values) v = 0.9 * v + 0.4;
            predicted.push_back(std::move(values));
        }
        return std::optional(predicted);
    };
}

TEST(SearchWithTwoModels, the_posterior_is_that_of_the_slow_model_with_a_tenth_of_its_runs) {
    const auto observed = observed_as(slide({0.4, 0.3}));
    const auto full = search(priors, observed, model_of(), {.runs = 60});
    std::size_t fast_made = 0;
    const auto found = search(priors, observed, model_of(), {.runs = 6, .fast_runs = 50}, {}, fast_model(&fast_made));
    const auto fast = search(priors, observed, fast_model(), {.runs = 40});
    ASSERT_TRUE(full && found && fast);
    EXPECT_LE(found->runs.size(), 6u);
    EXPECT_LE(found->fast_runs.size(), 50u);
    EXPECT_EQ(found->fast_runs.size(), fast_made);
    for (const double percent : {2.5, 50.0, 97.5}) {
        const double wanted = full->posterior.quantile(0, percent);
        EXPECT_NEAR(found->posterior.quantile(0, percent), wanted, 0.05) << percent;
    }
    // which the fast model alone does not tell
    EXPECT_GT(std::abs(fast->posterior.quantile(0, 50) - full->posterior.quantile(0, 50)), 0.05);
}

TEST(SearchWithTwoModels, every_run_is_at_a_place_of_the_fast_model) {
    const auto found =
        search(priors, observed_as(slide({0.4, 0.3})), model_of(), {.runs = 8, .fast_runs = 40}, {}, fast_model());
    ASSERT_TRUE(found);
    EXPECT_EQ(found->runs.size(), 8u);
    for (const SearchRun& run : found->runs) {
        EXPECT_TRUE(std::any_of(found->fast_runs.begin(), found->fast_runs.end(),
                                [&](const SearchRun& fast) { return fast.point == run.point; }));
    }
    EXPECT_LT(found->runs[*found->best].misfit, 1);
}

TEST(SearchWithTwoModels, returns_the_truth_within_its_interval) {
    constexpr std::size_t seeds = 10;
    std::size_t returned = 0;
    double width = 0;
    for (std::size_t seed = 1; seed <= seeds; ++seed) {
        const std::vector<double> truth = {stats::draw(seed, 0, 0), stats::draw(seed, 0, 1)};
        std::vector<double> values = slide(truth, 0.1);
        for (std::size_t j = 0; j < 2; ++j)
            values[j] = std::max(0.0, filled(values[j]) + stats::normal_draw(seed, 1, j));
        const auto found = search(priors, observed_as(values), model_of(0.1),
                                  {.runs = 6, .fast_runs = 30, .seed = seed}, {}, fast_model());
        ASSERT_TRUE(found);
        bool all = true;
        for (std::size_t k = 0; k < 2; ++k) {
            const double low = found->posterior.quantile(k, 2.5), high = found->posterior.quantile(k, 97.5);
            all = all && low <= truth[k] && truth[k] <= high;
            width += (high - low) / (2 * seeds);
        }
        returned += all ? 1 : 0;
    }
    EXPECT_GE(returned, seeds * 9 / 10);
    EXPECT_LT(width, 0.75);
}

TEST(SearchWithTwoModels, goes_on_where_the_fast_model_fails_or_tells_nothing) {
    const ForwardModel fails = [](const stats::Points& points, SearchPhase) -> Result<std::optional<stats::Points>> {
        return std::optional(stats::Points(points.size()));
    };
    const auto observed = observed_as(slide({0.4, 0.3}));
    const auto none = search(priors, observed, model_of(), {.runs = 8, .fast_runs = 20}, {}, fails);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().message, "no run of the fast model is complete, so there is nothing to search by");
    const ForwardModel stops = [](const stats::Points& points, SearchPhase) -> Result<std::optional<stats::Points>> {
        return std::optional(stats::Points(points.size(), {observe::never, observe::never}));
    };
    const auto found = search(priors, observed, model_of(), {.runs = 20, .fast_runs = 20}, {}, stops);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->runs.size(), 20u);
    EXPECT_LT(found->posterior.quantile(0, 2.5), 0.4);
    EXPECT_GT(found->posterior.quantile(0, 97.5), 0.4);
}

TEST(Search, goes_on_around_runs_that_fail) {
    const ForwardModel fails = [](const stats::Points& points, SearchPhase) -> Result<std::optional<stats::Points>> {
        stats::Points predicted;
        for (const auto& p : points) predicted.push_back(p[0] < 0.2 ? std::vector<double>{} : slide(p));
        return std::optional(predicted);
    };
    const auto found = search(priors, observed_as(slide({0.4, 0.3})), fails, {.runs = 40});
    ASSERT_TRUE(found);
    EXPECT_LT(found->runs[*found->best].misfit, 0.1);
    EXPECT_TRUE(std::isnan(found->runs[0].misfit) == found->runs[0].predicted.empty());
    const ForwardModel broken = [](const stats::Points& points, SearchPhase) -> Result<std::optional<stats::Points>> {
        return std::optional(stats::Points(points.size()));
    };
    EXPECT_FALSE(search(priors, observed_as({1, 1}), broken, {}));
}

TEST(Search, ends_where_it_is_interrupted) {
    std::size_t calls = 0;
    const ForwardModel model = [&](const stats::Points& points, SearchPhase) -> Result<std::optional<stats::Points>> {
        if (++calls == 3) return std::optional<stats::Points>();
        return model_of()(points, SearchPhase::design);
    };
    const auto found = search(priors, observed_as(slide({0.4, 0.3})), model, {});
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->interrupted);
    EXPECT_EQ(found->runs.size(), 24u);
}

TEST(Search, never_takes_more_runs_than_allowed) {
    for (const std::size_t runs : {8, 11, 30}) {
        const auto found = search(priors, observed_as(slide({0.4, 0.3})), model_of(0.3), {.runs = runs});
        ASSERT_TRUE(found);
        EXPECT_LE(found->runs.size(), runs);
        EXPECT_GE(found->runs.size(), runs / 2);
    }
}

}  // namespace
}  // namespace talus::calibrate
