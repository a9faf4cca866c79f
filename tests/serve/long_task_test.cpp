#include "serve/long_task.hpp"

#include <gtest/gtest.h>

namespace talus::test {
namespace {

using serve::LongTask;
using State = serve::LongTask::State;

TEST(LongTask, what_waits_is_cancelled_at_once_and_what_runs_when_it_has_seen_it) {
    LongTask one;
    EXPECT_STREQ(one.state_name(), "idle");
    EXPECT_FALSE(one.is_open());
    one.state = State::waiting;
    EXPECT_TRUE(one.cancel());
    EXPECT_STREQ(one.state_name(), "cancelled");
    *one.stop = false;
    one.state = State::running;
    EXPECT_TRUE(one.cancel());
    EXPECT_STREQ(one.state_name(), "cancelling");
    EXPECT_TRUE(one.is_open());
    EXPECT_TRUE(*one.stop);
    EXPECT_FALSE(one.cancel()) << "again";
}

TEST(LongTask, what_has_ended_says_why_unless_it_is_done) {
    LongTask one;
    one.state = State::running;
    one.message = "7 values pass";
    one.wall_remaining = 3;
    one.end(State::done, "");
    EXPECT_EQ(one.message, "7 values pass");
    EXPECT_FALSE(one.wall_remaining);
    EXPECT_FALSE(one.cancel());
    EXPECT_STREQ(one.state_name(), "done");
    one.end(State::failed, "");
    EXPECT_EQ(one.message, "");
    EXPECT_FALSE(one.is_open());
}

}  // namespace
}  // namespace talus::test
