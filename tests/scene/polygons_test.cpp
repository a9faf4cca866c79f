#include "scene/polygons.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace talus::scene {
namespace {

Polygon rectangle(double x_min, double y_min, double x_max, double y_max) {
    return {{{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}}, {}};
}

bool overlap(const Polygon& a, const Polygon& b) {
    return is_true_overlap(overlap_of(a, b), a, b);
}

TEST(Overlap, area_of_two_slanted_polygons) {
    const Polygon square = rectangle(0, 0, 10, 10);
    const Polygon diamond{{{10, 0}, {20, 10}, {10, 20}, {0, 10}}, {}};
    const Overlap both = overlap_of(square, diamond);
    EXPECT_NEAR(both.area, 50, 0.05);
    EXPECT_TRUE(contains(square, both.place) && contains(diamond, both.place));
    EXPECT_NEAR(overlap_of(diamond, square).area, both.area, 1e-9);
}

TEST(Overlap, shared_edges_are_none) {
    const Polygon left{{{0, 0}, {10, 0}, {7.3, 11.1}, {0, 10}}, {}};
    const Polygon right{{{10, 0}, {20, 0}, {20, 10}, {7.3, 11.1}}, {}};
    EXPECT_FALSE(overlap(left, right));
    EXPECT_FALSE(overlap(rectangle(0, 0, 1, 1), rectangle(0, 1, 1, 2)));
    EXPECT_FALSE(overlap(rectangle(0, 0, 1, 1), rectangle(5, 5, 6, 6)));
}

TEST(Overlap, a_hole_is_not_covered) {
    Polygon ring = rectangle(0, 0, 10, 10);
    ring.holes.push_back({{2, 2}, {8, 2}, {8, 8}, {2, 8}});
    EXPECT_FALSE(overlap(ring, rectangle(3, 3, 7, 7)));
    EXPECT_NEAR(overlap_of(ring, rectangle(0, 0, 10, 10)).area, 64, 0.1);
}

TEST(Overlap, a_thin_strip_counts) {
    EXPECT_TRUE(overlap(rectangle(0, 0, 100, 100), rectangle(0, 99, 100, 200)));
}

TEST(Overlap, holds_at_national_grid_coordinates) {
    EXPECT_FALSE(overlap(rectangle(824000, 825000, 824010.1, 825010), rectangle(824010.1, 825000, 824020, 825010)));
    EXPECT_NEAR(overlap_of(rectangle(824000, 825000, 824010, 825010), rectangle(824009, 825000, 824020, 825010)).area,
                10, 1e-6);
}

TEST(PointsInside, are_inside_and_never_none) {
    const Polygon needle{{{0, 0}, {100, 0.01}, {100, 0.02}}, {}};
    int count = 0;
    for_each_inside(needle, 5, [&](const PlanPoint&) { ++count; });
    EXPECT_GT(count, 0);
    Polygon ring = rectangle(0, 0, 10, 10);
    ring.holes.push_back({{2, 2}, {8, 2}, {8, 8}, {2, 8}});
    for_each_inside(ring, 0.3, [&](const PlanPoint& p) { EXPECT_TRUE(contains(ring, p)); });
}

TEST(PointsOnRings, are_at_most_a_step_apart) {
    PlanPoint before{0, 0};
    double widest = 0;
    for_each_on_rings(rectangle(0, 0, 10, 3), 0.7, [&](const PlanPoint& p) {
        widest = std::max(widest, std::hypot(p.x - before.x, p.y - before.y));
        before = p;
    });
    EXPECT_LE(widest, 0.7 + 1e-9);
    EXPECT_GT(widest, 0.5);
}

}  // namespace
}  // namespace talus::scene
