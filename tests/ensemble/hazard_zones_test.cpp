#include "ensemble/hazard_zones.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace talus::ensemble {
namespace {

constexpr int residual = 1, low = 2, medium = 3, high = 4;

TEST(HazardMatrix, is_the_swiss_one_for_debris_flows) {
    const HazardMatrix* matrix = hazard_matrix(params::GuidelineChoice::swiss_debris_flow);
    ASSERT_NE(matrix, nullptr);
    for (const double years : {1.0, 30.0, 100.0, 300.0}) EXPECT_EQ(matrix->zone_of(1, years), high) << years;
    EXPECT_EQ(matrix->zone_of(1, 301), residual);
    EXPECT_EQ(matrix->zone_of(0, 30), high);
    EXPECT_EQ(matrix->zone_of(0, 31), medium);
    EXPECT_EQ(matrix->zone_of(0, 300), medium);
    EXPECT_EQ(matrix->zone_of(0, 1000), residual);
}

TEST(HazardMatrix, has_low_intensity_for_floods_and_none_where_no_matrix_is_known) {
    const HazardMatrix* matrix = hazard_matrix(params::GuidelineChoice::swiss_flood);
    ASSERT_NE(matrix, nullptr);
    EXPECT_EQ(matrix->zone_of(0, 30), medium);
    EXPECT_EQ(matrix->zone_of(0, 300), low);
    EXPECT_EQ(matrix->zone_of(2, 300), high);
    EXPECT_EQ(hazard_matrix(params::GuidelineChoice::garcia_2003), nullptr);
}

TEST(HazardZones, take_the_most_dangerous_of_all_intensities) {
    const float none = std::nanf("");
    const HazardMatrix& matrix = *hazard_matrix(params::GuidelineChoice::swiss_debris_flow);
    const GridGeometry cells{0, 0, 1, 4, 1};
    std::vector<Grid<float>> at_least(2, Grid<float>(cells, none));
    // Of an event every 50 years: always medium; medium in half, high in a fifth of the runs; medium in a tenth.
    at_least[0].values = {1, 0.5F, 0.1F, none};
    at_least[1].values = {0, 0.2F, 0, none};
    const Grid<float> zones = hazard_zones(matrix, at_least, 50);
    EXPECT_EQ(zones.values[0], medium);    // every 50 years
    EXPECT_EQ(zones.values[1], high);      // high intensity every 250 years
    EXPECT_EQ(zones.values[2], residual);  // every 500 years
    EXPECT_TRUE(std::isnan(zones.values[3]));
    EXPECT_EQ(hazard_zones(matrix, at_least, 30).values[0], high);
}

}  // namespace
}  // namespace talus::ensemble
