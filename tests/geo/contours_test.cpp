#include "geo/contours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace talus::geo {
namespace {

TEST(Contours, contours_of_a_plane_are_straight_evenly_spaced_and_whole) {
    Grid<float> plane(GridGeometry{1000, 2000, 2, 40, 30});
    for (int r = 0; r < 30; ++r) {
        for (int c = 0; c < 40; ++c) plane.at(c, r) = static_cast<float>(0.5 * plane.geometry.centre(c, r).x);
    }
    const auto lines = contours(plane, 5);  // x = 1010, 1020, ... 1070
    ASSERT_EQ(lines.size(), 7U);
    for (const auto& line : lines) {
        EXPECT_GE(line.points.size(), 30U);
        for (const PlanPoint& p : line.points) EXPECT_NEAR(p.x, 2 * line.elevation, 1e-3);
        const auto [south, north] = std::minmax(line.points.front().y, line.points.back().y);
        EXPECT_NEAR(south, 2000, 1e-9) << "to the edge of the grid";
        EXPECT_NEAR(north, 2060, 1e-9);
    }
}

TEST(Contours, a_hill_has_closed_contours) {
    Grid<float> hill(GridGeometry{0, 0, 1, 41, 41});
    for (int r = 0; r < 41; ++r) {
        for (int c = 0; c < 41; ++c) hill.at(c, r) = static_cast<float>(20 - std::hypot(c - 20, r - 20));
    }
    const auto lines = contours(hill, 5);
    double length = 0;
    int at_ten = 0;
    for (const auto& line : lines) {
        if (line.elevation != 10) continue;
        ++at_ten;
        EXPECT_EQ(line.points.front().x, line.points.back().x);
        EXPECT_EQ(line.points.front().y, line.points.back().y);
        for (std::size_t i = 1; i < line.points.size(); ++i) {
            length += std::hypot(line.points[i].x - line.points[i - 1].x, line.points[i].y - line.points[i - 1].y);
        }
    }
    EXPECT_EQ(at_ten, 1);
    EXPECT_NEAR(length, 2 * 3.14159 * 10, 0.5);
}

TEST(Contours, at_given_levels_are_at_those_alone) {
    Grid<float> hill(GridGeometry{0, 0, 1, 41, 41});
    for (int r = 0; r < 41; ++r) {
        for (int c = 0; c < 41; ++c) {
            hill.at(c, r) = std::max(0.0F, static_cast<float>(2 - 0.1 * std::hypot(c - 20, r - 20)));
        }
    }
    const auto lines = contours(hill, std::vector<double>{0.35, 1.1, 5});
    ASSERT_EQ(lines.size(), 2U) << "nothing is as high as 5";
    for (const Contour& line : lines) {
        const double radius = (2 - line.elevation) * 10;
        for (const PlanPoint& p : line.points) EXPECT_NEAR(std::hypot(p.x - 20.5, p.y - 20.5), radius, 0.1);
        EXPECT_EQ(line.points.front().x, line.points.back().x) << "closed";
    }
    EXPECT_EQ(lines[0].elevation, 0.35);
    EXPECT_EQ(lines[1].elevation, 1.1);
}

TEST(Contours, end_where_there_is_no_elevation) {
    Grid<float> plane(GridGeometry{0, 0, 1, 20, 20}, std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(contours(plane, 1).empty());
    for (int r = 0; r < 20; ++r) {
        for (int c = 0; c < 10; ++c) plane.at(c, r) = static_cast<float>(0.3 * r);
    }
    const auto lines = contours(plane, 1);
    ASSERT_FALSE(lines.empty());
    for (const auto& line : lines) {
        for (const PlanPoint& p : line.points) EXPECT_LE(p.x, 10.5);
    }
    EXPECT_TRUE(contours(plane, 0).empty());
}

}  // namespace
}  // namespace talus::geo
