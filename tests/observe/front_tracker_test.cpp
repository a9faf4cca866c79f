#include "observe/front_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "observe/particles.hpp"
#include "observe/run_out.hpp"
#include "observe/trail.hpp"

namespace talus::observe {
namespace {

using test::advance;
using test::block;

/// Eastward through the middle of the ground; local x = chainage - 90.
TEST(FrontTracker, a_front_at_constant_speed_has_that_speed_everywhere) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -90, -4, 25, 20, 3, {7, 0, 0});  // front at chainage 10
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
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -90, -4, 25, 20, 3);
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
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -90, -4, 25, 20, 3);
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
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    const sim::State state = block(0.4, -90, 30, 25, 20, 3);
    const FrontTracker front(model, ground, state, test::straight_path(), 1, 10);
    EXPECT_TRUE(std::isnan(front.current()));
    EXPECT_TRUE(std::isnan(front.farthest()));
}

TEST(FrontTracker, a_release_that_starts_ahead_of_the_front_is_no_arrival) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -90, -4, 25, 20, 3, {5, 0, 0});
    const sim::State second = block(0.4, -40, -4, 10, 20, 3);  // to chainage 54
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
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -90, -4, 25, 20, 3, {5, 0, 0});
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
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -90, -4, 5, 5, 1);
    FrontTracker front(model, ground, state, terrain::FlowPath{}, 1, 10);
    front.after_step(ground, state);
    EXPECT_TRUE(std::isnan(front.farthest()));
    EXPECT_TRUE(front.samples().empty());
}

/// A channel that falls eastward and turns north by a right angle at (1000, 1950), as an elevation model has it.
terrain::FlowPath path_through_a_sharp_corner() {
    Grid<float> elevation(GridGeometry{900, 1900, 5, 40, 40});
    for (int r = 0; r < 40; ++r) {
        for (int c = 0; c < 40; ++c) {
            const PlanPoint p = elevation.geometry.centre(c, r);
            const double east = std::min(p.x, 1000.0), north = std::max(p.y, 1950.0);
            const double before = std::hypot(p.x - east, p.y - 1950), after = std::hypot(p.x - 1000, p.y - north);
            const double z = before < after ? 0.2 * (1000 - east) + before : -0.2 * (north - 1950) + after;
            elevation.at(c, r) = static_cast<float>(100 + z);
        }
    }
    return {terrain::trace_flow_path(elevation, {910, 1950}, 1000).value(), 50};
}

/// What the front of a block does that goes straight on, east, at 7.5 m/s, 4 to 20 m north of the first reach.
std::vector<FrontSample> straight_past_a_corner(const terrain::FlowPath& path, double interval) {
    const sim::Model model = test::make_model(0.8);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.8, -80, -46, 20, 20, 2, {7.5F, 0, 0});
    FrontTracker front(model, ground, state, path, interval, 10);
    for (int step = 0; step < 1400; ++step) {
        advance(state, 0.01);
        front.after_step(ground, state);
    }
    return front.samples();
}

TEST(FrontTracker, no_velocity_where_the_front_jumps_along_a_corner_of_a_traced_path) {
    const terrain::FlowPath path = path_through_a_sharp_corner();
    ASSERT_NEAR(path.point_at(45).y, 1950, 4);
    ASSERT_NEAR(path.point_at(140).x, 1000, 4);
    for (const double interval : {0.25, 1.0, 5.0}) {
        int without = 0, like_the_debris = 0;
        for (const FrontSample& s : straight_past_a_corner(path, interval)) {
            EXPECT_NEAR(s.particle_speed, 7.5, 1e-3);
            if (std::isnan(s.front_velocity)) {
                ++without;
                EXPECT_TRUE(s.chainage >= 65 && s.chainage <= 130) << s.chainage;
            } else {
                EXPECT_LE(s.front_velocity, 1.5 * 7.5 * 1.001) << s.chainage;
                like_the_debris += std::abs(s.front_velocity - 7.5) < 0.2 ? 1 : 0;
            }
        }
        EXPECT_GT(without, 0) << interval;
        EXPECT_GT(like_the_debris, 30 / interval) << interval;
    }
}

/// 2 m cells, 1 where `covered`.
template <class Covered>
Grid<float> trail(const Covered& covered) {
    Grid<float> grid(GridGeometry{900, 1900, 2, 100, 100}, std::nanf(""));
    for (int r = 0; r < 100; ++r) {
        for (int c = 0; c < 100; ++c) {
            const PlanPoint p = grid.geometry.centre(c, r);
            if (covered(p)) grid.at(c, r) = 1;
        }
    }
    return grid;
}

/// A channel 20 m wide eastward, then one northward.
bool in_the_bend(const PlanPoint& p) {
    return (p.y > 1940 && p.y < 1960 && p.x > 920 && p.x < 1010) || (p.x > 990 && p.x < 1010 && p.y > 1940);
}

TEST(TrailDistances, lead_round_a_bend_and_straight_over_open_ground) {
    const TrailDistances bend(trail(in_the_bend), {925, 1950});
    EXPECT_NEAR(bend.to({980, 1955}), std::hypot(55, 5), 1e-9);
    const double taut = std::hypot(990 - 925, 1960 - 1950) + 90;  // past the inner corner
    EXPECT_GT(bend.to({991, 2050}), taut);
    EXPECT_NEAR(bend.to({991, 2050}), taut, 2);
    const TrailDistances open(trail([](const PlanPoint&) { return true; }), {925, 1950});
    for (const PlanPoint& p : {PlanPoint{1090, 1951}, PlanPoint{930, 2090}, PlanPoint{1060, 2033}}) {
        EXPECT_NEAR(open.to(p), std::hypot(p.x - 925, p.y - 1950), 1e-9);
    }
}

TEST(TrailDistances, join_what_debris_reached_through_the_air) {
    const auto two_parts = [](const PlanPoint& p) { return p.y > 1940 && p.y < 1960 && (p.x < 960 || p.x > 980); };
    const TrailDistances ways(trail(two_parts), {925, 1951});
    EXPECT_NEAR(ways.to({1050, 1951}), 125, 0.5);
    EXPECT_TRUE(std::isnan(ways.at(0)));
    EXPECT_TRUE(
        std::isnan(TrailDistances(trail([](const PlanPoint&) { return false; }), {925, 1951}).to({1050, 1951})));
}

TEST(RunOut, along_the_flow_and_straight_of_a_block_that_moved_round_a_bend) {
    const sim::Ground ground = test::make_ground(0.5);
    sim::State state = block(0.4, -70, -54, 20, 20, 5);  // (930, 1946) to (938, 1954), crown at z = 1.8
    for (float& z : state.position.z) z += 30;
    const ReleasedMass released = measure_release(ground, state);
    EXPECT_NEAR(released.crown.z - ground.terrain.frame().origin.z, 31.8, 1e-4);
    // Rigidly to (996, 2032) and on, 30 m lower.
    for (float& x : state.position.x) x += 66;
    for (float& y : state.position.y) y += 86;
    for (float& z : state.position.z) z -= 30;
    const RunOut run_out = measure_run_out(ground, state, trail(in_the_bend), released, 150);
    EXPECT_EQ(run_out.front_chainage, 150);
    const PlanPoint crown{released.crown.x, released.crown.y};
    EXPECT_NEAR(run_out.straight, std::hypot(1003.8 - crown.x, 2039.8 - crown.y), 0.3);
    const double round = std::hypot(990 - crown.x, 1960 - crown.y) + std::hypot(1003.8 - 990, 2039.8 - 1960);
    EXPECT_NEAR(run_out.along_flow, round, 2);
    EXPECT_FALSE(run_out.at_least);
    EXPECT_NEAR(run_out.toe.y, 2039.8, 1e-3);
    EXPECT_NEAR(run_out.drop, 30, 1.61);  // to one of the foremost particles, of any layer
    EXPECT_NEAR(run_out.runout_angle, std::atan(run_out.drop / run_out.along_flow), 1e-12);
    EXPECT_NEAR(run_out.travel_angle, std::atan(30 / (std::hypot(990 - 934, 10) + std::hypot(10, 76))), 0.01);
}

TEST(RunOut, is_there_without_a_path_and_nothing_while_all_is_held) {
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -50, 0, 10, 10, 3);
    const ReleasedMass released = measure_release(ground, state);
    for (float& x : state.position.x) x += 30;
    for (float& y : state.position.y) y += 40;
    const Grid<float> open = trail([](const PlanPoint&) { return true; });
    const RunOut run_out = measure_run_out(ground, state, open, released, never);
    EXPECT_TRUE(std::isnan(run_out.front_chainage));
    EXPECT_NEAR(run_out.straight, 50, 5);
    EXPECT_NEAR(run_out.along_flow, run_out.straight, 1e-9);
    EXPECT_EQ(run_out.travel_angle, 0);
    state.held.assign(state.count, 1);
    EXPECT_TRUE(std::isnan(measure_run_out(ground, state, open, released, never).drop));
}

TEST(RunOut, goes_to_the_edge_at_least_where_debris_left_the_terrain) {
    const sim::Ground ground = test::make_ground(0.5);
    sim::State state = block(0.4, -50, 0, 10, 10, 3);
    const ReleasedMass released = measure_release(ground, state);
    const Grid<float> eastward = trail([](const PlanPoint& p) { return p.y > 1990 && p.y < 2010 && p.x > 945; });
    for (const std::uint32_t stays : {200U, 0U}) {
        state.outflow = state.seeded - stays;
        state.count = stays;
        const RunOut run_out = measure_run_out(ground, state, eastward, released, never);
        EXPECT_TRUE(run_out.at_least);
        EXPECT_NEAR(run_out.straight, 1099 - released.crown.x, 1);
        EXPECT_NEAR(run_out.along_flow, 1099 - released.crown.x, 1);
        EXPECT_NEAR(run_out.drop, released.crown.z - 50.5, 0.6) << "to the ground at the eastern edge";
        EXPECT_EQ(std::isnan(run_out.travel_angle), stays == 0);
    }
}

}  // namespace
}  // namespace talus::observe
