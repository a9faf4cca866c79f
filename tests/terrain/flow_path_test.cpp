#include "terrain/flow_path.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "terrain/grids.hpp"

namespace talus::terrain {
namespace {

TEST(FlowPath, chainage_and_offset_along_a_bend) {
    const FlowPath path({{1000, 2000}, {1100, 2000}, {1100, 2000}, {1100, 2050}}, 40);
    EXPECT_EQ(path.points().size(), 3U) << "the repeated point is no segment";
    EXPECT_DOUBLE_EQ(path.length(), 150);
    const auto before = path.locate({1030, 2007});
    ASSERT_TRUE(before);
    EXPECT_DOUBLE_EQ(before->chainage, 30);
    EXPECT_DOUBLE_EQ(before->offset, 7);
    const auto after = path.locate({1090, 2030});
    ASSERT_TRUE(after);
    EXPECT_DOUBLE_EQ(after->chainage, 130);
    EXPECT_DOUBLE_EQ(after->offset, 10);
    const auto outer = path.locate({1106, 1992});
    ASSERT_TRUE(outer);
    EXPECT_DOUBLE_EQ(outer->chainage, 100);
    EXPECT_DOUBLE_EQ(outer->offset, 10);
}

TEST(FlowPath, nothing_outside_the_corridor) {
    const FlowPath path({{0, 0}, {100, 0}}, 40);
    EXPECT_TRUE(path.locate({50, 19.99}));
    EXPECT_FALSE(path.locate({50, 20.01}));
    EXPECT_FALSE(path.locate({-25, 0}));
    EXPECT_TRUE(path.locate({-19, 0}));
    EXPECT_FALSE(path.locate({1e9, -1e9}));
    EXPECT_FALSE(path.locate({std::nan(""), 0}));
    EXPECT_LT(path.chainage_bound({50, 30}), 0);
    EXPECT_FALSE(FlowPath{}.locate({0, 0}));
    EXPECT_LT(FlowPath{}.chainage_bound({0, 0}), 0);
}

TEST(FlowPath, point_at_is_the_inverse_of_locate_and_clamps) {
    const FlowPath path({{0, 0}, {30, 40}, {60, 0}}, 20);
    for (double chainage = 0; chainage <= 100; chainage += 0.7) {
        const auto back = path.locate(path.point_at(chainage));
        ASSERT_TRUE(back);
        EXPECT_NEAR(back->chainage, chainage, 1e-9);
        EXPECT_NEAR(back->offset, 0, 1e-9);
    }
    EXPECT_EQ(path.point_at(-5).x, 0);
    EXPECT_EQ(path.point_at(500).x, 60);
}

TEST(FlowPath, random_positions_agree_with_brute_force_on_a_winding_path) {
    std::vector<PlanPoint> points;
    for (int i = 0; i <= 600; ++i) points.push_back({i * 0.5, 25 * std::sin(i * 0.5 / 30)});
    const FlowPath path(points, 24);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> in_x(-20, 320), in_y(-50, 50);
    int located = 0;
    for (int k = 0; k < 5000; ++k) {
        const PlanPoint p{in_x(random), in_y(random)};
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const double dx = points[i + 1].x - points[i].x, dy = points[i + 1].y - points[i].y;
            const double t =
                std::clamp(((p.x - points[i].x) * dx + (p.y - points[i].y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
            nearest = std::min(nearest, std::hypot(points[i].x + t * dx - p.x, points[i].y + t * dy - p.y));
        }
        const auto position = path.locate(p);
        EXPECT_EQ(position.has_value(), nearest <= 12);
        if (position) {
            EXPECT_GE(path.chainage_bound(p), position->chainage);
            EXPECT_LE(path.chainage_bound(p), position->chainage + 6);  // some cells of the table
            for (const double before : {0.0, 0.1, 5.0, 50.0}) {
                const Extent beyond = path.extent_beyond(position->chainage - before);
                EXPECT_TRUE(p.x >= beyond.x_min && p.x <= beyond.x_max && p.y >= beyond.y_min && p.y <= beyond.y_max);
            }
            const double past = path.chainage_bound(p) + 50.0;
            const Extent far_beyond = path.extent_beyond(past);
            EXPECT_TRUE(p.x < far_beyond.x_min) << "the path runs eastward";
            ++located;
            EXPECT_NEAR(position->offset, nearest, 1e-9);
        }
    }
    EXPECT_GT(located, 1000);
}

TEST(TraceFlowPath, follows_a_valley_through_a_pit_and_over_a_dam_to_the_edge) {
    // A valley that falls northward along x = 50, with a pit at y = 60 and a dam at y = 120.
    const auto height = [](double x, double y) {
        const double valley = 60 - 0.2 * y + 0.05 * (x - 50) * (x - 50);
        const double pit = 8 * std::exp(-((x - 50) * (x - 50) + (y - 60) * (y - 60)) / 50);
        const double dam = std::abs(y - 120) < 3 ? 6 : 0;
        return valley - pit + dam;
    };
    const Grid<float> grid = make({0, 0, 2, 50, 100}, height);
    const auto path = trace_flow_path(grid, {33, 11}, 10000);
    ASSERT_TRUE(path.ok());
    EXPECT_EQ(path->front().x, 33);
    EXPECT_EQ(path->front().y, 11);
    EXPECT_NEAR(path->back().y, 199, 1.01) << "ends at the edge of the data";
    const FlowPath line(*path, 40);
    for (double y = 30; y < 200; y += 5) {
        const auto at = line.locate({50, y});
        ASSERT_TRUE(at);
        EXPECT_LT(at->offset, 3) << "left the valley's floor at y = " << y;
    }
    EXPECT_LT(line.length(), 1.08 * (std::hypot(17, 17) + 175)) << "loops or zigzags";
}

TEST(TraceFlowPath, ends_where_the_sea_begins) {
    const Grid<float> grid = make({0, 0, 5, 60, 20}, [](double x, double) { return std::max(0.0, 100 - 0.5 * x); });
    const auto path = trace_flow_path(grid, {12.5, 52.5}, 1e9);
    ASSERT_TRUE(path.ok());
    EXPECT_NEAR(path->back().x, 202.5, 5);
    EXPECT_NEAR(path->back().y, 52.5, 5);
}

TEST(TraceFlowPath, ends_at_the_bottom_of_a_closed_basin) {
    const Grid<float> grid = make(
        {0, 0, 5, 41, 41}, [](double x, double y) { return 0.01 * std::pow(std::hypot(x - 102.5, y - 102.5), 2); });
    const auto path = trace_flow_path(grid, {27.5, 52.5}, 1e9);
    ASSERT_TRUE(path.ok());
    EXPECT_NEAR(path->back().x, 102.5, 1e-6);
    EXPECT_NEAR(path->back().y, 102.5, 1e-6);
}

TEST(TraceFlowPath, stops_at_nodata_and_after_the_longest_distance) {
    Grid<float> grid = make({0, 0, 5, 60, 20}, [](double x, double) { return 1000 - 0.5 * x; });
    const auto limited = trace_flow_path(grid, {12.5, 52.5}, 100);
    ASSERT_TRUE(limited.ok());
    EXPECT_NEAR(limited->back().x, 112.5, 5.01);
    for (int r = 0; r < 20; ++r) grid.at(30, r) = nodata;
    const auto stopped = trace_flow_path(grid, {12.5, 52.5}, 1e9);
    ASSERT_TRUE(stopped.ok());
    EXPECT_NEAR(stopped->back().x, 147.5, 1e-6);
}

TEST(TraceFlowPath, ends_on_terraces_full_of_ties_and_noise) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> noise(-3, 3);
    for (int round = 0; round < 20; ++round) {
        const Grid<float> grid = make({0, 0, 1, 80, 80}, [&](double x, double y) {
            return std::floor((200 - x - 0.5 * y) / 7) * 7 + std::floor(noise(random));
        });
        const auto path = trace_flow_path(grid, {5.5, 5.5}, 1e9);
        ASSERT_TRUE(path.ok());
        const PlanPoint end = path->back();
        EXPECT_TRUE(end.x > 70 || end.y > 70 || end.x < 10 || end.y < 10) << end.x << ' ' << end.y;
        EXPECT_LT(FlowPath(*path, 10).length(), 400);
    }
}

TEST(TraceFlowPath, diagonal_descent_is_as_long_as_it_is) {
    const Grid<float> grid = make({0, 0, 1, 200, 200}, [](double x, double y) {
        return 400 - x - 0.5 * y + 0.05 * std::pow(0.447 * x - 0.894 * y, 2);  // a groove in direction (2, 1)
    });
    const auto path = trace_flow_path(grid, {0.5, 0.5}, 1e9);
    ASSERT_TRUE(path.ok());
    const PlanPoint end = path->back();
    EXPECT_LT(FlowPath(*path, 10).length(), 1.02 * std::hypot(end.x - 0.5, end.y - 0.5));
}

TEST(TraceFlowPath, refuses_a_start_outside_the_data) {
    Grid<float> grid = make({0, 0, 5, 20, 20}, [](double x, double) { return x; });
    const auto outside = trace_flow_path(grid, {-1, 5}, 100);
    ASSERT_FALSE(outside.ok());
    EXPECT_NE(outside.error().message.find("outside the terrain"), std::string::npos);
    grid.at(4, 4) = nodata;
    const auto hole = trace_flow_path(grid, {22, 22}, 100);
    ASSERT_FALSE(hole.ok());
    EXPECT_NE(hole.error().message.find("nodata"), std::string::npos);
}

TEST(TraceFlowPath, from_the_lowest_cell_still_gives_a_line) {
    const Grid<float> grid = make({0, 0, 5, 20, 20}, [](double, double) { return 3; });
    const auto path = trace_flow_path(grid, {52, 52}, 100);
    ASSERT_TRUE(path.ok());
    EXPECT_GE(path->size(), 2U);
}

}  // namespace
}  // namespace talus::terrain
