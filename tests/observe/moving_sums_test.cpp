#include "observe/moving_sums.hpp"

#include <gtest/gtest.h>

namespace talus::observe {
namespace {

TEST(MovingSums, what_is_older_than_the_window_goes) {
    MovingSums sums(1);
    sums.resize(2);
    sums.add(0, 3);
    sums.add(0, 4);
    sums.advance(0.25, 0.25);
    EXPECT_EQ(sums.rate(0), 7);
    sums.add(1, 5);
    sums.advance(0.75, 0.5);
    EXPECT_EQ(sums.rate(0), 7);
    sums.advance(1.125, 0.375);
    EXPECT_DOUBLE_EQ(sums.rate(0), 3.5) << "half of its step is out";
    sums.advance(1.25, 0.125);
    EXPECT_EQ(sums.rate(0), 0);
    EXPECT_DOUBLE_EQ(sums.rate(1), 5);
    sums.advance(5, 3.75);
    EXPECT_EQ(sums.rate(1), 0);
}

TEST(MovingSums, a_step_longer_than_the_window_counts_with_the_share_within) {
    MovingSums sums(0.2);
    sums.resize(1);
    sums.add(0, 10);
    sums.advance(1, 1);
    EXPECT_DOUBLE_EQ(sums.rate(0), 10);
}

TEST(MovingSums, added_names_the_slots_of_the_last_step_once) {
    MovingSums sums(1);
    sums.resize(3);
    sums.add(2, 1);
    sums.add(2, 1);
    sums.add(0, 1);
    sums.advance(0.1, 0.1);
    EXPECT_EQ(sums.added(), (std::vector<std::uint32_t>{2, 0}));
    sums.advance(0.2, 0.1);
    EXPECT_TRUE(sums.added().empty());
}

TEST(MovingSums, an_amount_may_arrive_over_several_steps) {
    MovingSums sums(1);
    sums.resize(2);
    sums.add(0, 6, 0.375);
    sums.advance(0.125, 0.125);
    EXPECT_DOUBLE_EQ(sums.rate(0), 2);
    sums.add(0, 1);
    sums.advance(0.25, 0.125);
    EXPECT_DOUBLE_EQ(sums.rate(0), 5);
    sums.advance(0.5, 0.25);
    EXPECT_DOUBLE_EQ(sums.rate(0), 7) << "all has arrived within a longer step";
    EXPECT_EQ(sums.added(), (std::vector<std::uint32_t>{0}));
    sums.advance(0.625, 0.125);
    EXPECT_TRUE(sums.added().empty());
    sums.add(1, 3, 0.01);
    sums.advance(0.75, 0.125);
    EXPECT_DOUBLE_EQ(sums.rate(1), 3) << "faster than a step";
    sums.add(0, 6, 10);
    sums.clear(0, 1);
    sums.advance(0.875, 0.125);
    EXPECT_EQ(sums.rate(0), 0) << "what had yet to arrive is gone as well";
}

TEST(MovingSums, a_cleared_slot_starts_anew_and_the_others_stay) {
    MovingSums sums(1);
    sums.resize(2);
    sums.add(0, 1);
    sums.add(1, 2);
    sums.advance(0.5, 0.5);
    sums.clear(0, 1);
    EXPECT_EQ(sums.rate(0), 0);
    sums.advance(1, 0.5);
    sums.add(0, 4);
    sums.advance(1.25, 0.25);
    EXPECT_EQ(sums.rate(0), 4);
    EXPECT_EQ(sums.rate(1), 1) << "half of its step is out";
    sums.advance(9, 1);
    EXPECT_EQ(sums.rate(0), 0);
}

}  // namespace
}  // namespace talus::observe
