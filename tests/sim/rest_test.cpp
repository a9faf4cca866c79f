#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

using testing::rectangle;

/// A heap on level ground, 3 m to a side and 1.2 m high.
Simulation heap(double rest_duration) {
    const terrain::Terrain terrain = testing::terrain_of(60, 60, 1, [](double, double) { return 0; });
    params::SolverSpec solver;
    solver.rest_duration = rest_duration;
    params::MaterialSpec material;
    material.friction_coefficient = 0.6;
    return testing::simulate(material, solver, terrain, {testing::block(terrain, rectangle(27, 27, 30, 30), 1.2)},
                             testing::fine_spacing);
}

/// 2.4 m of debris in a pit.
Simulation filled_pit(double rest_duration) {
    const terrain::Terrain terrain = testing::terrain_of(
        20, 20, 1, [](double x, double y) { return std::max(std::abs(x - 10), std::abs(y - 10)) < 2.6 ? 0 : 4; });
    params::SolverSpec solver;
    solver.rest_duration = rest_duration;
    return testing::simulate({}, solver, terrain, {testing::block(terrain, rectangle(8, 8, 12, 12), 2.4)},
                             testing::fine_spacing);
}

double mean_height(const State& state) {
    double sum = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) sum += state.position.z[i];
    return sum / state.count;
}

void advance_to(Simulation& simulation, double time) {
    while (simulation.state().time < time) ASSERT_TRUE(simulation.advance());
}

TEST(DebrisAtRest, falls_asleep_and_stays_where_it_is) {
    Simulation simulation = heap(0.5);
    advance_to(simulation, 12);
    const State& state = simulation.state();
    ASSERT_LT(state.awake, state.count / 5) << "little should still move after 12 s";
    std::vector<LocalPoint> before(state.count);
    std::vector<bool> rested(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        before[state.id[i]] = state.position.at(i);
        rested[state.id[i]] = state.asleep[i] != 0;
    }
    advance_to(simulation, 12.2);
    int still = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (!state.asleep[i] || !rested[state.id[i]]) continue;
        ++still;
        EXPECT_EQ(length(state.position.at(i) - before[state.id[i]]), 0);
        EXPECT_EQ(length(state.velocity.at(i)), 0);
    }
    EXPECT_GT(still, 0.7 * state.count);
}

TEST(DebrisAtRest, never_falls_asleep_where_the_scene_says_so) {
    for (const bool sleeps : {false, true}) {
        Simulation simulation = heap(sleeps ? 0.5 : 0);
        advance_to(simulation, 6);
        const State& state = simulation.state();
        const auto asleep = std::count(state.asleep.begin(), state.asleep.begin() + state.count, 1);
        EXPECT_EQ(state.count - state.awake, asleep);
        if (sleeps)
            EXPECT_GT(asleep, 0.3 * state.count) << "by then it would have";
        else
            EXPECT_EQ(asleep, 0);
    }
}

TEST(DebrisAtRest, presses_as_it_did_on_what_is_awake) {
    Simulation simulation = filled_pit(0.2), sleepless = filled_pit(0);
    const State& state = simulation.state();
    double worst = 0;
    int beside = 0;
    while (state.time < 6) {
        ASSERT_TRUE(simulation.advance());
        if (state.awake < state.count / 20 || state.awake > state.count / 2) continue;
        ++beside;
        worst = std::max(worst, state.max_compression);
    }
    EXPECT_GT(beside, 20) << "steps with debris asleep beside debris awake";
    EXPECT_LT(worst, 0.05);
    advance_to(sleepless, 6);
    EXPECT_NEAR(mean_height(state), mean_height(sleepless.state()), 0.005);
}

/// Particles of the first release that rest: the mean of their distances from where they were.
double mean_shift(const State& state, const std::vector<LocalPoint>& before) {
    double sum = 0;
    int count = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.id[i] >= before.size()) continue;
        sum += length(state.position.at(i) - before[state.id[i]]);
        ++count;
    }
    return sum / count;
}

TEST(DebrisAtRest, wakes_when_something_moves_beside_it_and_ends_where_it_would_have) {
    double shift[2], top[2];
    for (const bool sleeps : {false, true}) {
        // A slope that debris runs down onto a level where a heap lies since long.
        const terrain::Terrain terrain =
            testing::terrain_of(80, 30, 1, [](double x, double) { return x < 30 ? 30 - x : 0; });
        params::SolverSpec solver;
        solver.rest_duration = sleeps ? 0.5 : 0;
        Simulation simulation = testing::simulate({}, solver, terrain,
                                                  {testing::block(terrain, rectangle(33, 12, 36, 18), 0.8),
                                                   testing::block(terrain, rectangle(8, 11, 18, 19), 1.2, 6.0)},
                                                  testing::fine_spacing);
        advance_to(simulation, 5.9);
        const State& state = simulation.state();
        const std::uint32_t first = simulation.model().releases[0].last_particle;
        std::vector<LocalPoint> before(first);
        std::uint32_t asleep = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            if (state.id[i] >= first) continue;
            before[state.id[i]] = state.position.at(i);
            asleep += state.asleep[i];
        }
        EXPECT_TRUE(!sleeps || asleep > first / 2) << asleep;
        advance_to(simulation, 14);
        shift[sleeps] = mean_shift(state, before);
        top[sleeps] = *std::max_element(state.position.x.begin(), state.position.x.begin() + state.count);
    }
    EXPECT_GT(shift[0], 0.5) << "the heap was not hit hard enough to show anything";
    EXPECT_NEAR(shift[1], shift[0], 0.1 * shift[0]);
    EXPECT_NEAR(top[1], top[0], 1.0);
}

}  // namespace
}  // namespace talus::sim
