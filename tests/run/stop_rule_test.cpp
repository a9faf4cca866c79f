#include "run/stop_rule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/simulation.hpp"

namespace talus::run {
namespace {

/// So many particles; the first `moving` of them at a speed.
sim::State debris(std::uint32_t count, std::uint32_t moving, float speed) {
    sim::State state;
    state.resize(count);
    state.count = state.seeded = count;
    for (std::uint32_t i = 0; i < moving; ++i) state.velocity.set(i, {0, 0, -speed});
    return state;
}

void set_speeds(sim::State& state, std::uint32_t first, std::uint32_t last, float speed) {
    for (std::uint32_t i = first; i < last; ++i) state.velocity.set(i, {0, speed, 0});
}

bool at_rest(RestDetector& rest, const sim::State& state, bool waiting) {
    return rest.at_rest(state, motion_of(state, params::OutputSpec{}.deposited_speed), waiting);
}

/// Whether ten seconds of this are a run's end, with the default limits.
bool ends(sim::State state, const params::SolverSpec& solver = {}) {
    RestDetector rest(solver);
    // Before, all of it ran at 15 m/s: next to that momentum, little is left in what follows.
    const sim::State before = debris(state.count, state.count, 15);
    if (at_rest(rest, before, false)) return true;
    for (int k = 1; k <= 100; ++k) {
        state.time = 0.1 * k;
        if (at_rest(rest, state, false)) return true;
    }
    return false;
}

TEST(RestDetector, debris_that_still_falls_onto_a_house_keeps_the_run_going) {
    EXPECT_FALSE(ends(debris(10000, 220, 13))) << "1.9 % of the momentum that there was";
    EXPECT_FALSE(ends(debris(10000, 9, 13))) << "too few for a front, but not for a wall";
    EXPECT_TRUE(ends(debris(10000, 1, 13))) << "a stray";
    EXPECT_FALSE(ends(debris(1000, 1, 13))) << "of a coarse run, a lump";
}

TEST(RestDetector, a_long_gentle_run_out_is_not_over_while_half_of_it_creeps) {
    EXPECT_FALSE(ends(debris(10000, 5500, 0.2F))) << "0.7 % of the momentum that there was";
    EXPECT_FALSE(ends(debris(10000, 20, 0.2F)));
}

TEST(RestDetector, it_is_over_when_hardly_anything_moves_and_nothing_fast) {
    EXPECT_TRUE(ends(debris(10000, 0, 0)));
    EXPECT_TRUE(ends(debris(10000, 10000, 0.05F))) << "deposited";
    EXPECT_TRUE(ends(debris(10000, 9, 0.5F)));
    EXPECT_FALSE(ends(debris(10000, 10, 0.5F)));
    EXPECT_TRUE(ends(debris(300, 4, 0.5F))) << "fewer than make a front";
    EXPECT_FALSE(ends(debris(300, 5, 0.5F)));
    EXPECT_FALSE(ends(debris(3, 3, 0.5F)));
    EXPECT_TRUE(ends(debris(3, 0, 0)));
}

TEST(RestDetector, it_must_last) {
    params::SolverSpec solver;
    solver.stop_duration = 3;
    RestDetector rest(solver);
    sim::State state = debris(100, 0, 0);
    for (const double time : {0.0, 1.5, 2.9}) {
        state.time = time;
        EXPECT_FALSE(at_rest(rest, state, false));
    }
    set_speeds(state, 0, 50, 1);
    state.time = 2.95;
    EXPECT_FALSE(at_rest(rest, state, false));
    set_speeds(state, 0, 50, 0);
    state.time = 5.9;
    EXPECT_FALSE(at_rest(rest, state, false));
    state.time = 5.96;
    EXPECT_TRUE(at_rest(rest, state, false));
    EXPECT_FALSE(at_rest(rest, state, true)) << "more is to come";
    rest.stir(6);
    state.time = 8.9;
    EXPECT_FALSE(at_rest(rest, state, false));
}

TEST(RestDetector, a_share_of_zero_never_ends_a_run) {
    params::SolverSpec solver;
    solver.stop_moving_share = 0;
    EXPECT_FALSE(ends(debris(100, 0, 0), solver));
}

TEST(EndTime, says_what_still_moved) {
    sim::Model model;
    model.particle_spacing = 0.5;
    model.solver.end_time = 90;
    const auto reason = [&](const sim::State& state) { return end_time_reason(model, state, motion_of(state, 0.1)); };
    EXPECT_EQ(reason(debris(100, 0, 0)), "reached solver.end_time_s = 90");
    EXPECT_EQ(reason(debris(100, 56, 0.3F)),
              "reached solver.end_time_s = 90 with 7 m3 still moving (56 % of the debris)");
}

}  // namespace
}  // namespace talus::run
