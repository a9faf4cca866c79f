#include "observe/observation.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

namespace talus::observe {
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

TEST(CompressionLimits, are_for_a_time_and_not_for_a_single_step) {
    Compression c;
    EXPECT_TRUE(c.within_limits());
    c.worst_max = 0.2;  // of one particle
    c.time_share_above = 0.01;
    EXPECT_TRUE(c.within_limits());
    c.time_share_above = 0.0101;
    EXPECT_FALSE(c.within_limits());
}

TEST(FlowThickness, is_normal_to_the_slope_and_where_debris_came) {
    // A plane that rises by 3 in 4: the cosine of its slope is 0.8.
    Grid<float> rising({0, 0, 2, 12, 3}, 0);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 12; ++column) rising.at(column, row) = 1.5f * static_cast<float>(column);
    }
    const terrain::Terrain terrain(std::move(rising));
    Grid<float> depth({2, 2, 2, 10, 1}, std::numeric_limits<float>::quiet_NaN());
    for (int column = 0; column < 9; ++column) depth.at(column, 0) = static_cast<float>(column + 1);
    const FlowThickness all = measure_thickness(depth, terrain, 0.1);
    EXPECT_NEAR(all.median, 5 * 0.8, 1e-5);
    EXPECT_NEAR(all.thin, 1 * 0.8, 1e-5);
    EXPECT_NEAR(measure_thickness(depth, terrain, 7.5).median, 9 * 0.8, 1e-5) << "8 and 9 m, the upper of two";
    EXPECT_FALSE(measure_thickness(depth, terrain, 20).known());
}

TEST(Deposit, is_area_and_depth_where_it_is_thick_enough) {
    Grid<float> depth({0, 0, 2, 10, 2}, std::numeric_limits<float>::quiet_NaN());
    for (int column = 0; column < 10; ++column) depth.at(column, 0) = 0.2f * static_cast<float>(column + 1);
    depth.at(0, 1) = 0.05f;
    const Deposit deposit = measure_deposit(depth, 0.1);
    EXPECT_EQ(deposit.area, 10 * 4);
    EXPECT_FLOAT_EQ(static_cast<float>(deposit.depth), 2.0f);
    EXPECT_EQ(measure_deposit(depth, 5).area, 0);
    EXPECT_TRUE(std::isnan(measure_deposit(depth, 5).depth));
}

}  // namespace
}  // namespace talus::observe
