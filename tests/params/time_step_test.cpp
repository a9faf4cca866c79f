#include "params/time_step.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace talus::params {
namespace {

TEST(LargestTimeStep, is_a_sixth_of_the_time_scale_of_a_spacing) {
    EXPECT_NEAR(largest_time_step({}, 0.18), 0.02258, 1e-5);
    EXPECT_NEAR(largest_time_step({}, 0.36) / largest_time_step({}, 0.18), std::sqrt(2), 1e-12);
}

TEST(LargestTimeStep, is_bounded_for_very_fine_and_very_coarse_particles) {
    EXPECT_EQ(largest_time_step({}, 0), 1.0 / 60);
    EXPECT_EQ(largest_time_step({}, 0.01), 1.0 / 60);
    EXPECT_EQ(largest_time_step({}, 2), 1.0 / 30);
}

TEST(LargestTimeStep, is_that_of_the_scene_where_given) {
    SolverSpec given;
    given.largest_time_step = 0.2;
    EXPECT_EQ(largest_time_step(given, 0.01), 0.2);
}

}  // namespace
}  // namespace talus::params
