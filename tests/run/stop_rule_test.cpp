#include "run/stop_rule.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "run/run_result.hpp"
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
    const sim::Motion motion = motion_of(state, params::OutputSpec{}.deposited_speed);
    return rest.at_rest(state.time, moving_particles(state, motion), waiting);
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
    rest.reset(6);
    state.time = 8.9;
    EXPECT_FALSE(at_rest(rest, state, false));
}

TEST(RestDetector, a_share_of_zero_never_ends_a_run) {
    params::SolverSpec solver;
    solver.stop_moving_share = 0;
    EXPECT_FALSE(ends(debris(100, 0, 0), solver));
}

TEST(RestDetector, is_over_with_no_debris_left) {
    EXPECT_TRUE(ends(debris(0, 0, 0)));
    RestDetector rest{params::SolverSpec{}};
    EXPECT_FALSE(rest.at_rest(0, {}, false));
    EXPECT_TRUE(rest.at_rest(3, {}, false));
}

TEST(RestDetector, judges_volumes_as_it_does_particles) {
    const auto ends_with = [](const MovingDebris& now) {
        RestDetector rest{params::SolverSpec{}};
        EXPECT_FALSE(rest.at_rest(0, now, false));
        return rest.at_rest(4, now, false);
    };
    EXPECT_TRUE(ends_with({1000, 0.9, 0}));
    EXPECT_FALSE(ends_with({1000, 1.1, 0}));
    EXPECT_FALSE(ends_with({1000, 0.9, 0.2})) << "as fast as that, it may strike something";
    EXPECT_TRUE(ends_with({3, 0.002, 0})) << "no volume is too little for a front";
}

observe::TimeSample sample_of(double time, double moving, double speed) {
    observe::TimeSample sample;
    sample.time = time;
    sample.volume_moving = moving;
    sample.volume_deposited = 100 - moving;
    sample.largest_speed = speed;
    sample.kinetic_energy = moving * speed * speed / 2;
    sample.momentum = moving * speed;
    return sample;
}

/// When a run of 100 m3 ends that gets 1 m/s faster per second for 10 s and then slows down by 0.1 m/s, at rest after
/// 110 s; 0: later.
double end_of(const params::SolverSpec& solver, double waits_until = 0) {
    StopRule rule(solver);
    for (int k = 0; k <= 1200; ++k) {
        const double time = 0.1 * k, speed = std::max(0.0, time < 10 ? time : 11 - time / 10);
        const double moving = speed >= 0.1 ? 100 : 0;
        if (rule.over(time, {100, moving, speed >= 1 ? 100.0 : 0}, sample_of(time, moving, speed),
                      time < waits_until)) {
            EXPECT_GT(rule.reason().size(), 20U);
            return time;
        }
    }
    return 0;
}

TEST(StopRule, ends_by_energy_or_momentum_where_it_is_asked_to) {
    params::SolverSpec solver;
    EXPECT_NEAR(end_of(solver), 112.1, 0.3) << "at rest";
    solver.stop_energy_share = 0.01;  // at a tenth of the greatest speed
    EXPECT_NEAR(end_of(solver), 103, 0.3);
    EXPECT_NEAR(end_of(solver, 50), 107, 0.3) << "of the peak since the last debris started";
    solver.stop_duration = 0;
    solver.stop_moving_share = 0;
    EXPECT_NEAR(end_of(solver), 100, 0.3);
    solver.stop_momentum_share = 0.5;
    EXPECT_NEAR(end_of(solver), 60, 0.3);
    solver.stop_energy_share = 0;
    EXPECT_NEAR(end_of(solver), 60, 0.3);
    solver.stop_momentum_share = 0;
    EXPECT_EQ(end_of(solver), 0) << "never";
}

TEST(StopRule, says_which_of_them_ended_it) {
    params::SolverSpec solver;
    solver.stop_moving_share = 0;
    solver.stop_momentum_share = 0.05;
    StopRule rule(solver);
    EXPECT_FALSE(rule.over(0, {}, sample_of(0, 100, 10), false));
    EXPECT_FALSE(rule.over(1, {}, sample_of(1, 40, 1), false));
    EXPECT_TRUE(rule.over(4, {}, sample_of(4, 40, 1), false));
    EXPECT_FALSE(rule.at_rest());
    EXPECT_EQ(rule.reason(), "momentum fell below 5 % of its peak (for 3 s)");
}

TEST(StillMoving, says_what_and_how_fast) {
    std::vector<observe::TimeSample> rows{sample_of(0, 0, 0), sample_of(1, 100, 10), sample_of(2, 90, 4)};
    EXPECT_EQ(with_what_moved("reached solver.end_time_s = 3", still_moving(rows, sample_of(3, 0, 0.05))),
              "reached solver.end_time_s = 3");
    EXPECT_EQ(with_what_moved("reached solver.end_time_s = 3", still_moving(rows, sample_of(3, 7, 3.21))),
              "reached solver.end_time_s = 3 with 7 m3 still moving (7 % of the debris), at up to 3.2 m/s; its kinetic "
              "energy was below 1 % of its peak from 2 s on");
    EXPECT_EQ(with_what_moved("reached the end", still_moving({}, sample_of(3, 99.96, 123.4))),
              "reached the end with 100 m3 still moving (100 % of the debris), at up to 123 m/s");
    const StillMoving most = still_moving(rows, sample_of(3, 80, 9));
    EXPECT_EQ(most.volume, 80);
    EXPECT_DOUBLE_EQ(most.share, 0.8);
    EXPECT_EQ(most.greatest_speed, 9);
    EXPECT_TRUE(std::isnan(most.slow_since));
    EXPECT_EQ(still_moving(rows, sample_of(3, 0, 0.05)).greatest_speed, 0) << "of deposit";
}

}  // namespace
}  // namespace talus::run
