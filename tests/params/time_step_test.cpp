#include "params/time_step.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace talus::params {
namespace {

TEST(LargestTimeStep, IsASixthOfTheTimeScaleOfASpacing) {
    EXPECT_NEAR(largest_time_step({}, 0.18), 0.02258, 1e-5);
    EXPECT_NEAR(largest_time_step({}, 0.36) / largest_time_step({}, 0.18), std::sqrt(2), 1e-12);
}

TEST(LargestTimeStep, IsBoundedForVeryFineAndVeryCoarseParticles) {
    EXPECT_EQ(largest_time_step({}, 0), 1.0 / 60);
    EXPECT_EQ(largest_time_step({}, 0.01), 1.0 / 60);
    EXPECT_EQ(largest_time_step({}, 2), 1.0 / 30);
}

TEST(LargestTimeStep, IsThatOfTheSceneWhereGiven) {
    SolverSpec given;
    given.largest_time_step = 0.2;
    EXPECT_EQ(largest_time_step(given, 0.01), 0.2);
}

}  // namespace
}  // namespace talus::params
