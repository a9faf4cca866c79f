#include "core/triangulate.hpp"

#include <gtest/gtest.h>

namespace talus {
namespace {

/// Sum of the triangles' areas, each counted with its sign.
double area_of(const std::vector<PlanTriangle>& triangles) {
    double sum = 0;
    for (const auto& [a, b, c] : triangles) sum += ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    return sum;
}

Polygon shifted(Polygon polygon, double x, double y) {
    const auto shift = [&](Ring& ring) {
        for (PlanPoint& p : ring) p = {p.x + x, p.y + y};
    };
    shift(polygon.outer);
    for (Ring& hole : polygon.holes) shift(hole);
    return polygon;
}

/// They fill the polygon: the areas agree, all turn one way, and the middle of each is inside.
void expect_fills(const Polygon& polygon) {
    const auto triangles = triangulate(polygon);
    EXPECT_NEAR(area_of(triangles), plan_area(polygon), 1e-6);
    for (const PlanTriangle& t : triangles) {
        EXPECT_GT(area_of({t}), 0);
        EXPECT_TRUE(contains(polygon, {(t[0].x + t[1].x + t[2].x) / 3, (t[0].y + t[1].y + t[2].y) / 3}));
    }
}

const Ring l_shape = {{0, 0}, {10, 0}, {10, 4}, {4, 4}, {4, 9}, {0, 9}};

TEST(Triangulate, fills_concave_outlines_whichever_way_they_run) {
    expect_fills({l_shape, {}});
    expect_fills({{l_shape.rbegin(), l_shape.rend()}, {}});
    expect_fills(shifted({l_shape, {}}, 824500.25, 825400.5));
    EXPECT_EQ(triangulate({l_shape, {}}).size(), 4U) << "two fewer than corners";
}

TEST(Triangulate, leaves_holes_open) {
    const Polygon yard{{{0, 0}, {20, 0}, {20, 12}, {0, 12}},
                       {{{2, 2}, {6, 2}, {6, 6}, {2, 6}}, {{9, 3}, {12, 8}, {15, 3}}, {{7, 7}, {8, 10}, {9, 7}}}};
    expect_fills(yard);
    expect_fills(shifted(yard, 2.6e6, 1.2e6));
}

TEST(Triangulate, takes_corners_in_one_line) {
    expect_fills({{{0, 0}, {5, 0}, {10, 0}, {10, 5}, {10, 10}, {5, 10}, {0, 10}}, {}});
}

TEST(Triangulate, ends_on_outlines_that_are_none) {
    EXPECT_TRUE(triangulate({}).empty());
    EXPECT_TRUE(triangulate({{{0, 0}, {1, 1}}, {}}).empty());
    EXPECT_TRUE(triangulate({{{0, 0}, {1, 1}, {2, 2}, {3, 3}}, {}}).empty()) << "all in one line";
    EXPECT_LE(triangulate({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}, {}}).size(), 2U) << "crosses itself";
}

}  // namespace
}  // namespace talus
