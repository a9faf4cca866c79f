#include "run/threads.hpp"

#include <fstream>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace talus::run {
namespace {

std::size_t allowed_in_all() {
    return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

int processor_threads() {
    return static_cast<int>(std::thread::hardware_concurrency());
}

TEST(Threads, are_as_many_as_asked_for) {
    for (const int wanted : {1, 2, processor_threads() + 3}) {
        const Threads threads(wanted);
        EXPECT_EQ(threads.count(), wanted);
        EXPECT_EQ(threads.execute([] { return tbb::this_task_arena::max_concurrency(); }), wanted);
    }
}

TEST(Threads, are_those_of_the_processor_unless_asked_for) {
    EXPECT_EQ(Threads().count(), processor_threads());
}

TEST(Threads, leave_others_theirs) {
    const std::size_t before = allowed_in_all();
    const Threads one(1);
    EXPECT_EQ(allowed_in_all(), before);
    EXPECT_EQ(Threads(processor_threads()).execute([] { return tbb::this_task_arena::max_concurrency(); }),
              processor_threads());
}

/// Resident memory, bytes.
double resident() {
    double pages = 0, skipped = 0;
    std::ifstream("/proc/self/statm") >> skipped >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

TEST(Threads, leave_nothing_behind) {
    const auto work = [](int times) {
        for (int k = 0; k < times; ++k) {
            Threads(2).execute([] { tbb::parallel_for(0, 100, [](int) {}); });
        }
    };
    work(100);
    const double before = resident();
    work(1000);
    EXPECT_LT(resident() - before, 1e6);
}

TEST(Threads, can_be_more_than_the_processor_has) {
    const Threads many(processor_threads() + 3);
    EXPECT_GE(allowed_in_all(), static_cast<std::size_t>(processor_threads()) + 3);
}

}  // namespace
}  // namespace talus::run
