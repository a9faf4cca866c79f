#include "run/time_left.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace talus::run {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

std::vector<double> equal(std::size_t count) {
    return std::vector<double>(count, 1);
}

/// What a run says of itself that has done `share` of its work in `time` s, as RunClock does.
double remaining(double time, double share) {
    return share < least_share_done ? unknown : time * (1 - share) / share;
}

TEST(TimeLeft, of_one_run_is_what_it_says_itself) {
    WorkClock clock(equal(1));
    clock.begin(0, 100);
    for (const auto& [time, share] : std::vector<std::pair<double, double>>{{2, 0.1}, {5, 0.25}, {18, 0.9}}) {
        clock.tick(0, 100 + time, remaining(time, share));
        EXPECT_NEAR(clock.wall_remaining(100 + time), 20 - time, 1e-9);
        EXPECT_NEAR(clock.share_done(100 + time), share, 1e-9);
    }
    clock.end(0, 120);
    EXPECT_EQ(clock.wall_remaining(120), 0);
}

TEST(TimeLeft, nothing_is_said_below_one_percent) {
    WorkClock clock(equal(100));
    EXPECT_TRUE(std::isnan(clock.wall_remaining(0)));
    clock.begin(0, 0);
    for (const auto& [time, share] : std::vector<std::pair<double, double>>{{0.001, 0.0001}, {0.05, 0.005}, {9, 0.9}}) {
        clock.tick(0, time, remaining(time, share));
        EXPECT_TRUE(std::isnan(clock.wall_remaining(time))) << time;  // 0.9 of a run of a hundred
    }
    clock.end(0, 10);
    EXPECT_NEAR(clock.wall_remaining(10), 990, 1e-9);
}

/// 64 runs of 0.5 s, two at once, each of which reads files for 0.3 s before its first step. What was told after the
/// first step was hours.
TEST(TimeLeft, a_slow_start_does_not_make_hours) {
    WorkClock clock(equal(64), 2);
    double worst = 0;
    for (int round = 0; round < 32; ++round) {
        const double begun = 0.5 * round;
        const std::size_t first = 2 * static_cast<std::size_t>(round);
        for (const std::size_t run : {first, first + 1}) clock.begin(run, begun);
        for (double in_run = 0.0001; in_run < 0.2; in_run += 0.01) {
            const double now = begun + 0.3 + in_run;
            for (const std::size_t run : {first, first + 1}) clock.tick(run, now, remaining(in_run, in_run / 0.2));
            const double told = clock.wall_remaining(now);
            if (!std::isnan(told)) worst = std::max(worst, std::abs(told - (16 - now)));
        }
        for (const std::size_t run : {first, first + 1}) clock.end(run, begun + 0.5);
    }
    EXPECT_LT(worst, 0.5);
    EXPECT_EQ(clock.wall_remaining(16), 0);
}

TEST(TimeLeft, the_last_run_of_several_workers_takes_all_of_its_time) {
    WorkClock clock(equal(9), 8);
    for (std::size_t run = 0; run < 8; ++run) clock.begin(run, 0);
    for (std::size_t run = 0; run < 8; ++run) clock.tick(run, 5, remaining(5, 0.25));
    EXPECT_NEAR(clock.wall_remaining(5), 15 + 20, 1e-9) << "not an eighth of a run more";
    for (std::size_t run = 0; run < 8; ++run) clock.end(run, 20);
    clock.begin(8, 20);
    EXPECT_NEAR(clock.wall_remaining(25), 15, 1e-9) << "as long as the others, until it says so itself";
    clock.tick(8, 30, remaining(10, 0.25));
    EXPECT_NEAR(clock.wall_remaining(30), 30, 1e-9);
}

TEST(TimeLeft, the_first_to_end_are_the_short_ones) {
    WorkClock clock(equal(4), 2);
    clock.begin(0, 0);
    clock.begin(1, 0);
    clock.end(0, 10);
    clock.tick(1, 10, remaining(10, 0.25));  // 40 s in all: the mean is 25 s
    clock.begin(2, 10);
    EXPECT_NEAR(clock.wall_remaining(10), 50, 1e-9);
}

TEST(TimeLeft, resumed_work_is_none_of_this_calls) {
    WorkClock clock(equal(100), 1);
    for (std::size_t run = 0; run < 90; ++run) clock.found(run, 7);
    clock.begin(90, 1000);
    EXPECT_TRUE(std::isnan(clock.wall_remaining(1000))) << "90 of 100 runs, but nothing of this call's work";
    EXPECT_NEAR(clock.wall_remaining(1003), 4 + 9 * 7, 1e-9) << "as long as those of the earlier call";
    clock.tick(90, 1010, remaining(10, 0.5));  // on a slower machine
    EXPECT_NEAR(clock.wall_remaining(1010), 10 + 9 * 20, 1e-9);
}

TEST(TimeLeft, is_unknown_where_a_silent_run_outlasts_the_others) {
    WorkClock clock(equal(2), 2);
    clock.begin(0, 0);
    clock.begin(1, 0);
    clock.end(0, 10);
    EXPECT_TRUE(std::isnan(clock.wall_remaining(11))) << "never 0:00 for minutes";
}

TEST(TimeLeft, the_share_done_never_falls) {
    WorkClock clock(equal(2));
    clock.begin(0, 0);
    clock.tick(0, 10, 10);
    EXPECT_NEAR(clock.share_done(10), 0.25, 1e-9);
    clock.tick(0, 12, 60);
    EXPECT_NEAR(clock.share_done(12), 0.25, 1e-9);
    EXPECT_NEAR(clock.wall_remaining(12), 60 + 72, 1e-9);
}

}  // namespace
}  // namespace talus::run
