#include "observe/building_impact.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "observe/particles.hpp"

namespace talus {
namespace {

using test::advance;
using test::block;

Ground ground_with_buildings() {
    Ground ground = test::make_ground();
    ground.buildings.resize(2);
    ground.buildings[0].name = "untouched";
    ground.buildings[1].name = "house";
    return ground;
}

/// Debris moving at `speed` against building 1: `count` particles touch it in every step and give it `force` together.
struct Collision {
    Model model = test::make_model(0.4);
    Ground ground = ground_with_buildings();
    State state = block(0.4, -8, -8, 40, 40, 3, {});
    MapAccumulator maps{model, ground, state, 1, 0.1};
    ImpactRecorder recorder;

    explicit Collision(double window) : recorder(model, ground, state, window) {}

    void step(double time_step, double force, std::uint32_t first, std::uint32_t count) {
        advance(state, time_step);
        state.building_contacts.clear();
        for (std::uint32_t i = first; i < first + count; ++i) {
            state.building_contacts.push_back({i, 1, static_cast<float>(force * time_step / count)});
        }
        maps.add(state);
        recorder.after_step(model, ground, state, maps);
    }
    const BuildingImpact& house() const { return recorder.impacts()[1]; }
};

TEST(ImpactRecorder, a_constant_force_is_found_whatever_the_steps) {
    for (const double time_step : {0.001, 0.0037, 0.05, 0.5}) {
        Collision c(0.2);
        for (double t = 0; t < 1; t += time_step) c.step(time_step, 50000, 0, 10);
        EXPECT_NEAR(c.house().peak_force, 50000, 1) << time_step;
        EXPECT_NEAR(c.house().peak_pressure, 50000 / (10 * 0.16), 1) << time_step;
    }
}

TEST(ImpactRecorder, a_short_knock_is_spread_over_the_window) {
    for (const double time_step : {0.001, 0.004}) {
        Collision c(0.2);
        c.step(time_step, 600 / time_step, 0, 2);  // 600 N s
        EXPECT_NEAR(c.house().peak_force, 3000, 0.1);
        EXPECT_NEAR(c.house().peak_pressure, 3000 / (2 * 0.16), 0.1);
    }
}

TEST(ImpactRecorder, knocks_add_up_within_the_window_and_not_beyond) {
    Collision c(0.2);
    c.step(0.01, 60000, 0, 2);
    for (int i = 0; i < 5; ++i) c.step(0.01, 0, 0, 0);
    c.step(0.01, 60000, 0, 2);
    EXPECT_NEAR(c.house().peak_force, 2 * 600 / 0.2, 0.1);
    for (int i = 0; i < 30; ++i) c.step(0.01, 0, 0, 0);
    c.step(0.01, 90000, 0, 2);
    EXPECT_NEAR(c.house().peak_force, 2 * 600 / 0.2, 0.1);
}

TEST(ImpactRecorder, particles_that_touch_in_turn_make_the_same_pressure_as_together) {
    Collision c(0.2);
    for (int i = 0; i < 200; ++i) c.step(0.005, 50000, i % 2 == 0 ? 0 : 5, 5);
    EXPECT_NEAR(c.house().peak_force, 50000, 1);
    // The first knock came before the second half had touched, but carries a fortieth of the window.
    EXPECT_NEAR(c.house().peak_pressure, 50000 / (10 * 0.16), 1);
}

TEST(ImpactRecorder, particles_that_come_back_after_the_window_count_once) {
    Collision c(0.2);
    for (int round = 0; round < 5; ++round) {
        c.step(0.01, 60000, 0, 4);
        for (int i = 0; i < 40; ++i) c.step(0.01, 0, 0, 0);
    }
    for (int i = 0; i < 100; ++i) c.step(0.01, 60000, 0, 4);
    EXPECT_NEAR(c.house().peak_pressure, 60000 / (4 * 0.16), 1);
}

TEST(ImpactRecorder, first_hit_depth_and_dynamic_pressure_come_from_the_debris_that_touches) {
    Collision c(0.2);
    for (float& x : c.state.velocity.x) x = 6;
    c.step(0.01, 0, 0, 0);
    EXPECT_FALSE(c.house().hit);
    c.step(0.01, 1000, 40 * 40 + 810, 3);  // in the second layer, centres 0.6 m above the ground
    EXPECT_TRUE(c.house().hit);
    EXPECT_NEAR(c.house().first_hit_time, 0.02, 1e-12);
    EXPECT_NEAR(c.house().peak_depth, 0.8, 1e-5);
    EXPECT_NEAR(c.house().peak_dynamic_pressure, 2000 * 36, 100);
    EXPECT_FALSE(c.recorder.impacts()[0].hit);
    EXPECT_TRUE(std::isnan(c.recorder.impacts()[0].first_hit_time));
    EXPECT_EQ(c.recorder.impacts()[0].name, "untouched");
}

TEST(ImpactRecorder, impulse_is_that_of_all_steps_and_its_history_falls_to_no_force) {
    Collision c(0.2);
    for (int i = 0; i < 100; ++i) c.step(0.01, 50000, 0, 10);
    EXPECT_NEAR(c.house().impulse, 50000, 5);
    c.recorder.add_row(c.state);
    for (int i = 0; i < 100; ++i) c.step(0.01, 0, 0, 0);
    c.recorder.add_row(c.state);
    ASSERT_EQ(c.house().history.size(), 2U);
    EXPECT_NEAR(c.house().history[0].force, 50000, 5);
    EXPECT_NEAR(c.house().history[1].force, 0, 1e-9);
    EXPECT_NEAR(c.house().history[1].impulse, 50000, 5);
    EXPECT_TRUE(c.recorder.impacts()[0].history.empty()) << "it was never hit";
}

TEST(ImpactRecorder, resistance_is_exceeded_once_by_the_filtered_pressure) {
    Collision c(0.2);
    c.ground.buildings[1].resistance.pressure = 20000;  // of 10 x 0.16 m2: 32 kN
    for (int i = 0; i < 50; ++i) c.step(0.01, 31000, 0, 10);
    EXPECT_TRUE(c.recorder.failed().empty());
    EXPECT_TRUE(std::isnan(c.house().failure_time));
    int failures = 0;
    double when = 0;
    for (int i = 0; i < 50; ++i) {
        c.step(0.01, 34000, 0, 10);
        if (!c.recorder.failed().empty()) when = c.state.time;
        failures += static_cast<int>(c.recorder.failed().size());
    }
    EXPECT_EQ(failures, 1);
    EXPECT_EQ(c.house().failure_time, when);
    // The window's mean gets there when a third of it is at the higher force.
    EXPECT_NEAR(when, 0.57, 0.015);
}

TEST(ImpactRecorder, buildings_come_behind_and_records_begin_anew) {
    Collision c(0.2);
    for (int k = 0; k < 10; ++k) c.step(0.05, 50000, 0, 10);
    c.ground.buildings.emplace_back().name = "new";
    c.recorder.follow(c.model, c.ground, c.state);
    ASSERT_EQ(c.recorder.impacts().size(), 3U);
    EXPECT_EQ(c.recorder.impacts()[2].name, "new");
    EXPECT_NEAR(c.house().peak_force, 50000, 1);
    c.recorder.forget(c.model, c.ground, c.state, 1);
    EXPECT_FALSE(c.house().hit);
    EXPECT_EQ(c.house().peak_force, 0);
    EXPECT_EQ(c.house().name, "house");
    for (int k = 0; k < 10; ++k) c.step(0.05, 20000, 0, 10);
    EXPECT_NEAR(c.house().peak_force, 20000, 1) << "nothing is left of the events before";
    EXPECT_NEAR(c.house().peak_pressure, 20000 / (10 * 0.16), 1);
}

}  // namespace
}  // namespace talus
