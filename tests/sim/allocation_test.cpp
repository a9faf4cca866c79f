#include <gtest/gtest.h>

#include "sim_fixtures.hpp"
#include "support/allocations.hpp"

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
    const long before = test::allocation_count();
    for (int i = 0; i < 10; ++i) simulation.advance();
    EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace talus
