#include "risk/risk.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "risk/criteria.hpp"

namespace talus::risk {
namespace {

/// A building worth 1,000,000 with four persons who are there for 60 % of the time; where debris comes, half of them
/// die and a quarter of its value is lost.
Exposures one_building(double persons = 4, double presence = 0.6, double value = 1e6) {
    Exposures e;
    e.curves.reserve(2);
    e.curves.push_back({.name = "d", .title = "d", .effect = Effect::damage, .points = {{0, 0.25}, {9, 0.25}}});
    e.curves.push_back({.name = "v", .title = "v", .effect = Effect::death, .points = {{0, 0.5}, {9, 0.5}}});
    ExposedBuilding& building = e.buildings.emplace_back();
    building.name = "house";
    building.exposure = "homes";
    building.value = value;
    building.persons = persons;
    building.presence = presence;
    building.damage = e.curves.data();
    building.death = &e.curves[1];
    return e;
}

/// Runs of which the first `hits` come to the building.
ScenarioOutcome events(double frequency, std::size_t runs, std::size_t hits, double damage = 0.25, double death = 0.5) {
    ScenarioOutcome scenario;
    scenario.frequency = frequency;
    for (std::size_t run = 0; run < runs; ++run) {
        RunOutcome outcome;
        const bool hit = run < hits;
        outcome.buildings.push_back({true, hit, hit ? damage : 0, hit ? death : 0});
        scenario.runs.emplace_back(std::move(outcome));
    }
    return scenario;
}

TEST(Risk, of_one_building_with_known_probabilities_is_as_computed_by_hand) {
    const Risk risk = evaluate(one_building(), {events(0.02, 10, 3)});
    ASSERT_EQ(risk.items.size(), 1U);
    const ItemRisk& house = risk.items.front();
    EXPECT_NEAR(house.impact.value, 0.02 * 0.3, 1e-15);
    EXPECT_NEAR(house.loss.value, 0.02 * 0.3 * 0.25 * 1e6, 1e-9);
    EXPECT_NEAR(house.individual.value, 0.02 * 0.3 * 0.5 * 0.6, 1e-15);
    EXPECT_NEAR(house.deaths.value, 4 * 0.0018, 1e-15);
    EXPECT_NEAR(risk.total.deaths.value, house.deaths.value, 1e-15);
    EXPECT_NEAR(risk.total.loss.value, house.loss.value, 1e-9);
    EXPECT_EQ(risk.total.individual.value, house.individual.value);
    EXPECT_LT(house.impact.low, house.impact.value);
    EXPECT_GT(house.impact.high, house.impact.value);
    EXPECT_NEAR(annual_probability(house.impact).value, 1 - std::exp(-0.006), 1e-15);
}

TEST(Risk, leaves_failed_runs_out) {
    ScenarioOutcome scenario = events(0.02, 10, 3);
    scenario.runs[9].reset();
    const Risk risk = evaluate(one_building(), {scenario});
    EXPECT_EQ(risk.runs, 9U);
    EXPECT_NEAR(risk.total.impact.value, 0.02 * 3 / 9, 1e-15);
}

TEST(Risk, has_the_f_n_curve_of_two_classes_of_events_as_computed_by_hand) {
    // One kills both persons for certain, the other each with one half.
    const Risk risk = evaluate(one_building(2, 1), {events(0.01, 4, 4, 1, 1), events(0.1, 2, 2, 1, 0.5)});
    ASSERT_EQ(risk.deaths_at_least.size(), 3U);
    EXPECT_NEAR(risk.deaths_at_least[0], 0.11, 1e-12);
    EXPECT_NEAR(risk.deaths_at_least[1], 0.01 + 0.1 * 0.75, 1e-12);
    EXPECT_NEAR(risk.deaths_at_least[2], 0.01 + 0.1 * 0.25, 1e-12);
    // The area under the curve is the expected number of deaths.
    EXPECT_NEAR(risk.deaths_at_least[1] + risk.deaths_at_least[2], risk.total.deaths.value, 1e-12);
}

TEST(Risk, counts_a_part_of_a_person) {
    const Risk risk = evaluate(one_building(2.5, 1), {events(0.1, 2, 2, 0, 1)});
    ASSERT_EQ(risk.deaths_at_least.size(), 4U);
    EXPECT_NEAR(risk.deaths_at_least[3], 0.05, 1e-12);
    EXPECT_NEAR(risk.total.deaths.value, 0.25, 1e-12);
}

TEST(Risk, of_a_road_is_that_of_the_vehicles_on_the_length_hit) {
    Exposures e;
    ExposedRoad& road = e.roads.emplace_back();
    road.name = "road";
    road.persons_per_metre =
        8640.0 * 2 / (86400 * 10);  // 8640 vehicles a day, two persons each, at 10 m/s: 0.02 per metre
    road.busiest_presence = 2.0 / (86400 * 10);
    road.has_busiest = true;
    ScenarioOutcome scenario;
    scenario.frequency = 0.01;
    for (const double deadly : {0.0, 30.0}) {
        RunOutcome outcome;
        outcome.roads.push_back({deadly > 0 ? 100.0 : 0.0, deadly});
        scenario.runs.emplace_back(std::move(outcome));
    }
    const Risk risk = evaluate(e, {scenario});
    EXPECT_NEAR(risk.items.front().impact.value, 0.005, 1e-15);
    EXPECT_NEAR(risk.items.front().deaths.value, 0.005 * 30 * 0.02, 1e-15);
    EXPECT_NEAR(risk.items.front().individual.value, 0.005 * 30 * 2 / 864000, 1e-18);
    EXPECT_NEAR(risk.deaths_at_least[1], 0.005 * (1 - std::exp(-0.6)), 1e-12);
}

TEST(Risk, grows_with_exposure_and_frequency) {
    const std::vector<ScenarioOutcome> once = {events(0.02, 10, 3)};
    const Risk base = evaluate(one_building(), once);
    EXPECT_GT(evaluate(one_building(5), once).total.deaths.value, base.total.deaths.value);
    EXPECT_GT(evaluate(one_building(4, 0.7), once).total.individual.value, base.total.individual.value);
    EXPECT_GT(evaluate(one_building(4, 0.6, 2e6), once).total.loss.value, base.total.loss.value);
    const Risk often = evaluate(one_building(), {events(0.03, 10, 3)});
    for (std::size_t n = 0; n < base.deaths_at_least.size(); ++n) {
        EXPECT_GT(often.deaths_at_least[n], base.deaths_at_least[n]) << n;
        EXPECT_GE(evaluate(one_building(5), once).deaths_at_least[n], base.deaths_at_least[n]) << n;
    }
}

/// Damage that follows from one draw per run, of which a barrier takes a fifth.
std::vector<ScenarioOutcome> drawn(std::uint64_t seed, double factor) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> damage(0, 1);
    ScenarioOutcome scenario = events(0.02, 50, 50);
    for (auto& run : scenario.runs) run->buildings.front().damage = factor * damage(random);
    return {scenario};
}

TEST(RiskDifference, of_common_random_numbers_is_narrower_than_of_independent_ones) {
    const Exposures exposures = one_building();
    const auto width = [](const stats::Estimate& e) { return e.high - e.low; };
    const Risk paired = difference(exposures, drawn(1, 0.8), drawn(1, 1));
    const Risk independent = difference(exposures, drawn(2, 0.8), drawn(1, 1));
    EXPECT_LT(width(paired.total.loss), 0.25 * width(independent.total.loss));
    EXPECT_LT(paired.total.loss.high, 0);  // the barrier helps for certain
    EXPECT_GT(independent.total.loss.high, 0);
}

TEST(RiskDifference, of_the_same_runs_is_none) {
    const Risk none = difference(one_building(), {events(0.02, 10, 3)}, {events(0.02, 10, 3)});
    EXPECT_EQ(none.total.impact.value, 0);
    EXPECT_EQ(none.total.deaths.high, 0);
}

TEST(RiskDifference, leaves_out_runs_that_either_lacks) {
    std::vector<ScenarioOutcome> changed = {events(0.02, 10, 0)}, base = {events(0.02, 10, 3)};
    changed[0].runs[0].reset();
    base[0].runs[9].reset();
    EXPECT_NEAR(difference(one_building(), changed, base).total.impact.value, -0.02 * 2 / 8, 1e-15);
}

TEST(CostOfAYear, is_an_annuity_and_upkeep) {
    params::OptionSpec option;
    option.cost = 1000;
    option.life = 50;
    option.upkeep = 7;
    EXPECT_NEAR(cost_per_year(option), 20 + 7, 1e-12);
    option.interest_rate = 0.03;
    EXPECT_NEAR(cost_per_year(option), 1000 * 0.03 / (1 - std::pow(1.03, -50)) + 7, 1e-9);
}

TEST(Criteria, place_an_f_n_curve_in_its_worst_region) {
    const Criteria& hong_kong = *criteria_of(params::CriteriaChoice::hong_kong);
    EXPECT_EQ(region_of(hong_kong, {1, 1e-5}), Region::acceptable);
    EXPECT_EQ(region_of(hong_kong, {1, 1e-5, 0.6e-5}), Region::as_low_as_practicable);
    EXPECT_EQ(region_of(hong_kong, {1, 1e-3}), Region::as_low_as_practicable);
    EXPECT_EQ(region_of(hong_kong, {1, 1e-3, 0.6e-3}), Region::unacceptable);
    EXPECT_EQ(region_of(hong_kong, {1}), Region::acceptable);
    EXPECT_EQ(criteria_of(params::CriteriaChoice::none), nullptr);
}

}  // namespace
}  // namespace talus::risk
