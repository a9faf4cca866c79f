#include "observe/front_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "observe/particles.hpp"

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

/// A front at 10 m/s that map cells of 2.5 m see arrive in two rows of them at a time, the second row early; the debris
/// there moves at 9 m/s.
FrontRecord seen_by_cells() {
    FrontRecord front;
    front.interval = 0.5;
    front.window = 10;
    front.resolution = 10;
    for (int row = 0; row <= 200; ++row) {
        const double chainage = row * front.interval, cell = std::floor(chainage / 5) * 5, beyond = chainage - cell;
        front.arrival.push_back((beyond < 2.5 ? cell + 1.6 * beyond : cell + 4 + 0.4 * (beyond - 2.5)) / 10);
        front.head.push_back({9, 9});
    }
    return front;
}

TEST(FrontRecord, has_a_velocity_everywhere_though_cells_are_reached_at_uneven_times) {
    FrontRecord front = seen_by_cells();
    for (const FrontSample& s : front.samples()) EXPECT_NEAR(s.front_velocity, 10, 1.5) << s.chainage;
    front.resolution = 0;
    const std::vector<FrontSample> samples = front.samples();
    EXPECT_TRUE(std::any_of(samples.begin(), samples.end(), [](const auto& s) { return std::isnan(s.front_velocity); }))
        << "the case is one in which rows alone mislead";
}

TEST(FrontRecord, has_none_where_a_front_seen_by_cells_jumps) {
    FrontRecord front = seen_by_cells();
    for (std::size_t row = 100; row < front.arrival.size(); ++row) front.arrival[row] -= 2;  // 20 m on at once
    for (std::size_t row = 100; row-- > 0;) front.arrival[row] = std::min(front.arrival[row], front.arrival[row + 1]);
    int none_at_the_jump = 0;
    for (const FrontSample& s : front.samples()) {
        if (std::isnan(s.front_velocity)) {
            ++none_at_the_jump;
            EXPECT_TRUE(s.chainage > 20 && s.chainage < 60) << s.chainage;
        } else {
            EXPECT_LE(s.front_velocity, fastest_front * 9 + 1e-9) << s.chainage;
        }
    }
    EXPECT_GE(none_at_the_jump, 40);
}

}  // namespace
}  // namespace talus::observe
