#include "design/capacity.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace talus::design {
namespace {

/// Ground of 200 x 200 m in cells of 2 m.
terrain::Terrain ground(const std::function<double(double, double)>& elevation) {
    Grid<float> grid(GridGeometry{1000, 2000, 2, 100, 100});
    for (int row = 0; row < 100; ++row) {
        for (int column = 0; column < 100; ++column) {
            const PlanPoint p = grid.geometry.centre(column, row);
            grid.at(column, row) = static_cast<float>(elevation(p.x - 1000, p.y - 2000));
        }
    }
    return terrain::Terrain(std::move(grid));
}

const std::vector<PlanPoint> across = {{1100, 2080}, {1100, 2120}};  // 40 m long, to the north

TEST(CapacityTest, a_wedge_on_a_plane_holds_what_its_formula_says) {
    constexpr double fall = 0.25, height = 6, width = 40;
    const auto plane = ground([](double x, double) { return 100 - fall * x; });
    const int side = upstream_side(plane, across);
    EXPECT_EQ(side, 1);  // the west is left of a line to the north, and higher
    EXPECT_NEAR(ground_slope(plane, across, side, 40), fall, 1e-4);
    const Storage level = storage_behind(plane, across, side, height, 0, 0);
    EXPECT_NEAR(level.volume, width * height * height / 2 / fall, 0.02 * level.volume);
    EXPECT_NEAR(level.reach, height / fall, 1.5);
    EXPECT_TRUE(level.open_sides);
    const Storage sloped = storage_behind(plane, across, side, height, 0, 0.1);
    EXPECT_NEAR(sloped.volume, width * height * height / 2 / (fall - 0.1), 0.02 * sloped.volume);
}

TEST(CapacityTest, the_wall_takes_half_its_thickness_of_the_wedge) {
    constexpr double fall = 0.25, height = 6, width = 40, half = 2;
    const auto plane = ground([](double x, double) { return 100 - fall * x; });
    const Storage storage = storage_behind(plane, across, 1, height, 2 * half, 0);
    const double left = height - half * fall;
    EXPECT_NEAR(storage.volume, width * left * left / 2 / fall, 0.02 * storage.volume);
}

TEST(CapacityTest, side_walls_hold_what_is_between_them) {
    const auto channel = ground([](double x, double y) { return 100 - 0.25 * x + (std::abs(y - 100) > 18 ? 30 : 0); });
    EXPECT_FALSE(storage_behind(channel, across, 1, 4, 0, 0).open_sides);
}

TEST(CapacityTest, debris_comes_from_the_higher_side) {
    const auto to_the_west = ground([](double x, double) { return 100 + 0.25 * x; });
    EXPECT_EQ(upstream_side(to_the_west, across), -1);
}

TEST(CapacityTest, more_height_holds_more) {
    const auto bumpy =
        ground([](double x, double y) { return 100 - 0.2 * x + std::sin(0.1 * x) + 0.01 * std::abs(y); });
    double before = 0;
    for (const double height : {1.0, 2.0, 3.0, 5.0, 8.0}) {
        const double volume = storage_behind(bumpy, across, 1, height, 1, 0).volume;
        EXPECT_GT(volume, before);
        before = volume;
    }
}

}  // namespace
}  // namespace talus::design
