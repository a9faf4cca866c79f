#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "sim_fixtures.hpp"

namespace {
std::atomic<bool> counting{false};
std::atomic<long> allocations{0};
}  // namespace

// g++ pairs the inlined free() below with its own operator new and takes them for a mismatch.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

void* operator new(std::size_t size) {
    if (counting.load(std::memory_order_relaxed)) ++allocations;
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace talus {
namespace {

using testing::block;
using testing::inclined_plane;
using testing::rectangle;
using testing::simulate;

TEST(Step, allocates_nothing_once_it_runs) {
    const Terrain terrain = inclined_plane(30, 60, 40);
    Simulation simulation = simulate({}, {}, terrain, {block(terrain, rectangle(6, 12, 16, 24), 1)}, 0.4);
    for (int i = 0; i < 30; ++i) simulation.advance();
    allocations = 0;
    counting = true;
    for (int i = 0; i < 10; ++i) simulation.advance();
    counting = false;
    EXPECT_EQ(allocations.load(), 0);
}

}  // namespace
}  // namespace talus
