#include "serve/executor.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <future>
#include <latch>
#include <memory>
#include <mutex>
#include <pthread.h>
#include <string>
#include <sys/resource.h>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace talus::test {
namespace {

using serve::Lane;
using serve::Priority;

class ExecutorTest : public ::testing::Test {
  protected:
    /// What a task of the lane finds, once those before it are over.
    template <class Find>
    static auto found_in(Lane& lane, Find find) {
        const auto found = std::make_shared<std::promise<decltype(find())>>();
        lane.post([found, find] { found->set_value(find()); });
        return found->get_future().get();
    }
    static int niceness() { return getpriority(PRIO_PROCESS, 0); }  // of this thread

    serve::Executor executor_;
};

TEST_F(ExecutorTest, tasks_of_a_lane_run_one_after_the_other_in_order) {
    Lane lane(executor_, "lane"), other(executor_, "other");
    std::vector<int> order;  // without a lock, for the thread sanitizer
    for (int k = 0; k < 1000; ++k) {
        lane.post([&, k] { order.push_back(k); });
        other.post([] {});
    }
    ASSERT_EQ(found_in(lane, [&] { return order.size(); }), 1000U);
    for (int k = 0; k < 1000; ++k) EXPECT_EQ(order[static_cast<std::size_t>(k)], k);
}

TEST_F(ExecutorTest, all_lanes_may_be_busy_at_the_same_time) {
    constexpr int count = 20;
    std::mutex mutex;
    std::condition_variable changed;
    int busy = 0;
    bool over = false;
    std::vector<std::unique_ptr<Lane>> lanes;
    for (int k = 0; k < count; ++k) {
        lanes.push_back(std::make_unique<Lane>(executor_, "lane"));
        lanes.back()->post([&] {
            std::unique_lock lock(mutex);
            ++busy;
            changed.notify_all();
            changed.wait(lock, [&] { return busy == count || over; });
        });
    }
    std::unique_lock lock(mutex);
    EXPECT_TRUE(changed.wait_for(lock, std::chrono::seconds(30), [&] { return busy == count; }))
        << busy << " of " << count << " lanes are busy, the others wait for them";
    over = true;
    changed.notify_all();
}

TEST_F(ExecutorTest, a_task_may_wait_for_another_lane) {
    Lane asks(executor_, "asks"), answers(executor_, "answers");
    EXPECT_EQ(found_in(asks, [&] { return found_in(answers, [] { return 42; }); }), 42);
}

TEST_F(ExecutorTest, closing_waits_for_the_current_task_and_discards_the_waiting_ones) {
    const auto kept = std::make_shared<int>();
    std::latch begun(1);
    std::promise<void> go_on;
    std::atomic<bool> over{false}, another{false};
    Lane lane(executor_, "lane");
    lane.post([&] {
        begun.count_down();
        go_on.get_future().wait();
        lane.post([&] { another = true; });
        over = true;
    });
    lane.post([&, kept] { another = true; });
    begun.wait();
    EXPECT_EQ(kept.use_count(), 2);
    auto closed = std::async(std::launch::async, [&] {
        lane.close();
        return over.load();
    });
    const auto discards = [&] {
        const auto data = std::make_shared<int>();
        lane.post([data] {});
        return data.use_count() == 1;
    };
    while (!discards()) std::this_thread::yield();
    go_on.set_value();
    EXPECT_TRUE(closed.get());
    EXPECT_EQ(kept.use_count(), 1) << "what waited has let go of its data";
    EXPECT_FALSE(another);
}

TEST_F(ExecutorTest, nothing_runs_on_a_closed_lane) {
    const auto kept = std::make_shared<int>();
    std::atomic<bool> ran{false};
    Lane closed(executor_, "closed"), other(executor_, "other");
    closed.close();
    closed.post([&, kept] { ran = true; });
    EXPECT_EQ(kept.use_count(), 1);
    found_in(other, [] { return 0; });
    closed.close();  // again
    EXPECT_FALSE(ran);
}

TEST_F(ExecutorTest, a_lane_that_ends_has_let_go_of_the_data_of_its_tasks) {
    for (int k = 0; k < 100; ++k) {
        const auto kept = std::make_shared<int>();
        {
            std::latch begun(1);
            Lane lane(executor_, "lane");
            lane.post([kept, &begun] { begun.count_down(); });
            begun.wait();
        }
        ASSERT_EQ(kept.use_count(), 1);
    }
}

TEST_F(ExecutorTest, a_long_lane_delays_no_other) {
    std::promise<void> go_on;
    Lane long_one(executor_, "long"), short_one(executor_, "short");
    long_one.post([&] { go_on.get_future().wait(); });
    for (int k = 0; k < 100; ++k) EXPECT_EQ(found_in(short_one, [k] { return k; }), k);
    go_on.set_value();
}

TEST_F(ExecutorTest, each_priority_has_its_niceness_also_where_one_posts_to_another) {
    if (niceness() != 0) GTEST_SKIP() << "this program has a niceness of its own";
    Lane background(executor_, "background", Priority::background), idle(executor_, "idle", Priority::idle);
    EXPECT_EQ(found_in(background, niceness), 5);
    EXPECT_EQ(found_in(idle, niceness), 10);
    // So many that threads are added for them.
    constexpr std::size_t count = 4;
    std::array<std::atomic<int>, count> found{};
    std::latch together(count);
    std::vector<std::unique_ptr<Lane>> prompt;
    for (std::size_t k = 0; k < count; ++k) prompt.push_back(std::make_unique<Lane>(executor_, "prompt"));
    idle.post([&] {
        for (std::size_t k = 0; k < count; ++k) {
            prompt[k]->post([&, k] {
                found[k] = niceness() + 1;
                together.arrive_and_wait();
            });
        }
    });
    together.wait();
    idle.close();
    for (const auto& each : found) EXPECT_EQ(each, 1);
}

TEST_F(ExecutorTest, a_thread_has_the_name_of_the_lane_whose_task_it_runs) {
    const auto name = [] {
        std::array<char, 16> text{};
        pthread_getname_np(pthread_self(), text.data(), text.size());
        return std::string(text.data());
    };
    Lane one(executor_, "one"), other(executor_, "other");
    EXPECT_EQ(found_in(one, name), "one");
    EXPECT_EQ(found_in(other, name), "other");
}

}  // namespace
}  // namespace talus::test
