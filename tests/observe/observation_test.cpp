#include "observe/observation.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace talus {
namespace {

TEST(FrontAt, lies_between_the_samples_and_is_not_known_beyond_them) {
    Observation o;
    o.front = {{10, 1, 4, 3}, {12, 2, 8, 5}};
    EXPECT_EQ(front_at(o, 11).arrival_time, 1.5);
    EXPECT_EQ(front_at(o, 11).front_velocity, 6);
    EXPECT_EQ(front_at(o, 12).particle_speed, 5);
    EXPECT_TRUE(std::isnan(front_at(o, 9).arrival_time));
    EXPECT_TRUE(std::isnan(front_at(o, 13).arrival_time));
    EXPECT_TRUE(std::isnan(front_at({}, 0).arrival_time));
}

TEST(CompressionLimits, hold_for_mean_and_largest_apart) {
    Observation o;
    EXPECT_TRUE(within_compression_limits(o));
    o.worst_mean_compression = mean_compression_limit;
    o.worst_max_compression = max_compression_limit;
    EXPECT_TRUE(within_compression_limits(o));
    o.worst_mean_compression = 0.0101;
    EXPECT_FALSE(within_compression_limits(o));
    o.worst_mean_compression = 0;
    o.worst_max_compression = 0.0301;
    EXPECT_FALSE(within_compression_limits(o));
}

}  // namespace
}  // namespace talus
