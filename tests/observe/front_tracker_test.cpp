#include "observe/front_tracker.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "observe/particles.hpp"
#include "observe/run_out.hpp"

namespace talus {
namespace {

using test::advance;
using test::block;

/// Eastward through the middle of the ground; local x = chainage - 90.
TEST(FrontTracker, a_front_at_constant_speed_has_that_speed_everywhere) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground();
    State state = block(0.4, -90, -4, 25, 20, 3, {7, 0, 0});  // front at chainage 10
    FrontTracker front(model, ground, state, test::straight_path(), 1, 10);
    EXPECT_NEAR(front.current(), 9.8, 1e-4);
    for (int step = 0; step < 700; ++step) {
        advance(state, 0.013);
        front.after_step(ground, state);
    }
    const std::vector<FrontSample> samples = front.samples();
    ASSERT_EQ(samples.size(), static_cast<std::size_t>(9.8 + 7 * 9.1) - 9);
    for (const FrontSample& s : samples) {
        EXPECT_NEAR(s.arrival_time, (s.chainage - 9.8) / 7, 1e-4);
        EXPECT_NEAR(s.front_velocity, 7, 1e-2);
        EXPECT_NEAR(s.particle_speed, 7, 1e-4);
    }
    EXPECT_EQ(samples.front().chainage, 10) << "what the release covers is no arrival";
}

TEST(FrontTracker, velocity_follows_a_front_that_slows_down) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground();
    State state = block(0.4, -90, -4, 25, 20, 3);
    FrontTracker front(model, ground, state, test::straight_path(), 0.5, 6);
    const double time_step = 0.01;
    for (int step = 0; step < 900; ++step) {
        const double v = 12 - state.time;  // chainage 9.8 + 12 t - t^2 / 2
        for (float& x : state.velocity.x) x = static_cast<float>(v - time_step / 2);
        advance(state, time_step);
        front.after_step(ground, state);
    }
    for (const FrontSample& s : front.samples()) {
        if (s.chainage < 15 || s.chainage > 70) continue;
        EXPECT_NEAR(s.front_velocity, 12 - s.arrival_time, 0.04);
        EXPECT_NEAR(s.particle_speed, 12 - s.arrival_time, 0.04);
    }
}

TEST(FrontTracker, one_stray_makes_no_front) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground();
    State state = block(0.4, -90, -4, 25, 20, 3);
    for (int i = 0; i < 4; ++i) test::add_particle(state, {50, 0, 0});
    FrontTracker front(model, ground, state, test::straight_path(), 1, 10);
    EXPECT_NEAR(front.current(), 9.8, 1e-4);
    EXPECT_EQ(front_particle_count(state), 5U);
    state.seeded = 20001;
    EXPECT_EQ(front_particle_count(state), 21U);
    state.seeded = 3;
    EXPECT_EQ(front_particle_count(state), 3U);
}

TEST(FrontTracker, debris_outside_the_corridor_is_no_front) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground();
    const State state = block(0.4, -90, 30, 25, 20, 3);
    const FrontTracker front(model, ground, state, test::straight_path(), 1, 10);
    EXPECT_TRUE(std::isnan(front.current()));
    EXPECT_TRUE(std::isnan(front.farthest()));
}

TEST(FrontTracker, a_release_that_starts_ahead_of_the_front_is_no_arrival) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground();
    State state = block(0.4, -90, -4, 25, 20, 3, {5, 0, 0});
    const State second = block(0.4, -40, -4, 10, 20, 3);  // to chainage 54
    for (std::uint32_t i = 0; i < second.count; ++i) test::add_particle(state, second.position.at(i), {5, 0, 0}, true);
    FrontTracker front(model, ground, state, test::straight_path(), 1, 10);
    for (int step = 0; step < 200; ++step) {
        if (step == 100) state.held.assign(state.count, 0);
        advance(state, 0.02);
        front.after_step(ground, state);
    }
    for (const FrontSample& s : front.samples()) {
        EXPECT_TRUE(s.chainage < 21 || s.chainage > 53) << s.chainage;
        EXPECT_NEAR(s.particle_speed, 5, 1e-4);
    }
    EXPECT_NEAR(front.farthest(), 53.8 + 10, 1e-3);
}

TEST(FrontTracker, the_farthest_chainage_stays_when_the_front_draws_back_or_leaves) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground();
    State state = block(0.4, -90, -4, 25, 20, 3, {5, 0, 0});
    FrontTracker front(model, ground, state, test::straight_path(), 1, 10);
    for (int step = 0; step < 100; ++step) {
        advance(state, 0.02);
        front.after_step(ground, state);
    }
    EXPECT_NEAR(front.farthest(), 19.8, 1e-3);
    for (float& x : state.position.x) x -= 8;
    front.after_step(ground, state);
    EXPECT_NEAR(front.current(), 11.8, 1e-3);
    EXPECT_NEAR(front.farthest(), 19.8, 1e-3);
    for (float& y : state.position.y) y += 60;
    advance(state, 0.02);
    front.after_step(ground, state);
    EXPECT_TRUE(std::isnan(front.current()));
    EXPECT_NEAR(front.farthest(), 19.8, 1e-3);
}

TEST(FrontTracker, nothing_without_a_path) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground();
    State state = block(0.4, -90, -4, 5, 5, 1);
    FrontTracker front(model, ground, state, FlowPath{}, 1, 10);
    front.after_step(ground, state);
    EXPECT_TRUE(std::isnan(front.farthest()));
    EXPECT_TRUE(front.samples().empty());
}

TEST(RunOut, distance_drop_and_angles_of_a_block_that_moved_along_a_bend) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground(0.5);
    const FlowPath path({{920, 1950}, {1000, 1950}, {1000, 2050}}, 40);
    State state = block(0.4, -70, -54, 20, 20, 5);  // chainage 10 to 18, crown at z = 1.8
    for (float& z : state.position.z) z += 30;
    const ReleasedMass released = measure_release(ground, state, path);
    EXPECT_NEAR(released.crown.z - ground.terrain.frame().origin.z, 31.8, 1e-4);
    EXPECT_NEAR(released.mean_chainage, 14, 1e-4);
    // Rigidly to where it reaches from chainage 130 to 138: (1000, 2000) to (1000, 2008), 30 m lower.
    for (float& x : state.position.x) x += 66;
    for (float& y : state.position.y) y += 54;
    for (float& z : state.position.z) z -= 30;
    const RunOut run_out = measure_run_out(ground, state, path, released, 150);
    EXPECT_EQ(run_out.front_chainage, 150);
    const double crown_chainage = path.locate({released.crown.x, released.crown.y})->chainage;
    EXPECT_NEAR(run_out.horizontal_distance, 137.8 - crown_chainage, 1e-3);
    EXPECT_NEAR(run_out.drop, 30, 1.61);  // to one of the foremost particles, of any layer
    EXPECT_NEAR(run_out.runout_angle, std::atan(run_out.drop / run_out.horizontal_distance), 1e-12);
    EXPECT_NEAR(run_out.travel_angle, std::atan(30.0 / 120), 1e-4);
}

TEST(RunOut, straight_distances_without_a_path_and_nothing_while_all_is_held) {
    const Model model = test::make_model(0.4);
    const Ground ground = test::make_ground();
    State state = block(0.4, -50, 0, 10, 10, 3);
    const ReleasedMass released = measure_release(ground, state, {});
    for (float& x : state.position.x) x += 30;
    for (float& y : state.position.y) y += 40;
    const RunOut run_out = measure_run_out(ground, state, {}, released, never);
    EXPECT_TRUE(std::isnan(run_out.front_chainage));
    EXPECT_NEAR(run_out.horizontal_distance, 50, 5);
    EXPECT_EQ(run_out.travel_angle, 0);
    state.held.assign(state.count, 1);
    EXPECT_TRUE(std::isnan(measure_run_out(ground, state, {}, released, never).drop));
}

}  // namespace
}  // namespace talus
