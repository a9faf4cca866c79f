#include "observe/run_out.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "observe/particles.hpp"

namespace talus::observe {
namespace {

using test::block;

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

TEST(RunOut, ends_on_the_terrain_where_debris_left_through_cells_that_reach_beyond_it) {
    const sim::Ground ground = test::make_ground(0.5);
    sim::State state = block(0.4, -50, 0, 10, 10, 3);
    const ReleasedMass released = measure_release(ground, state);
    // Cells of 5 m: the centres of the last ones lie at 1101.5 m, those of the terrain's own at 1099 m.
    Grid<float> covered(GridGeometry{939, 1990, 5, 33, 4}, 1);
    ASSERT_TRUE(std::isnan(ground.terrain.elevation_at(covered.geometry.centre(32, 2))));
    state.outflow = state.seeded;
    state.count = 0;
    const RunOut run_out = measure_run_out(ground, state, covered, released, never);
    EXPECT_TRUE(run_out.at_least);
    EXPECT_EQ(run_out.toe.x, 1096.5);
    EXPECT_NEAR(run_out.drop, released.crown.z - (50 + 0.5 * 3.5), 1e-3);
    EXPECT_NEAR(std::tan(run_out.runout_angle), run_out.drop / run_out.along_flow, 1e-9);
}

}  // namespace
}  // namespace talus::observe
