#include "core/phases.hpp"

#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace talus {
namespace {

TEST(PhaseTimes, add_up_by_name_in_the_order_of_their_first_end) {
    PhaseTimes times({{"load", 2}});
    times.add("maps", 1);
    times.add("load", 0.5);
    times.add("maps", 0.25);
    const std::vector<Phase> all = times.all();
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(all[0].name, "load");
    EXPECT_DOUBLE_EQ(all[0].seconds, 2.5);
    EXPECT_EQ(all[1].name, "maps");
    EXPECT_DOUBLE_EQ(all[1].seconds, 1.25);
}

TEST(PhaseTimes, hand_on_what_the_work_returns) {
    PhaseTimes times;
    EXPECT_EQ(times.time("sum", [] { return 3 + 4; }), 7);
    ASSERT_EQ(times.all().size(), 1U);
    EXPECT_GE(times.all()[0].seconds, 0);
}

TEST(PhaseTimes, take_times_of_several_threads) {
    PhaseTimes times;
    std::vector<std::thread> threads;
    for (int k = 0; k < 4; ++k) {
        threads.emplace_back([&] {
            for (int n = 0; n < 1000; ++n) times.add("work", 1);
        });
    }
    for (std::thread& thread : threads) thread.join();
    ASSERT_EQ(times.all().size(), 1U);
    EXPECT_DOUBLE_EQ(times.all()[0].seconds, 4000);
}

}  // namespace
}  // namespace talus
