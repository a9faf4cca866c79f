#include "core/geometry.hpp"

#include <utility>

#include <gtest/gtest.h>

namespace talus {
namespace {

// National-grid magnitudes: products of such coordinates lose centimetres in double.
constexpr double east = 820000, north = 825000;

Ring square(double x, double y, double size) {
    return {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
}

TEST(Polygon, area_subtracts_holes_whatever_the_orientation) {
    Polygon p{square(east, north, 10), {square(east + 2, north + 2, 3)}};
    EXPECT_NEAR(plan_area(p), 91, 1e-9);
    std::swap(p.outer[0], p.outer[2]);
    EXPECT_NEAR(plan_area(p), 91, 1e-9);
}

TEST(Polygon, area_of_a_small_polygon_far_from_the_origin_is_exact) {
    EXPECT_NEAR(plan_area({square(east, north, 0.01), {}}), 1e-4, 1e-11);
}

TEST(Polygon, contains_excludes_holes_and_notches) {
    const Polygon with_hole{square(0, 0, 10), {square(4, 4, 2)}};
    EXPECT_TRUE(contains(with_hole, {1, 1}));
    EXPECT_FALSE(contains(with_hole, {5, 5}));
    EXPECT_FALSE(contains(with_hole, {11, 5}));
    const Polygon notched{{{0, 0}, {10, 0}, {10, 10}, {5, 2}, {0, 10}}, {}};
    EXPECT_FALSE(contains(notched, {5, 6}));
    EXPECT_TRUE(contains(notched, {1, 6}));
}

TEST(Polygon, empty_rings_contain_nothing) {
    EXPECT_FALSE(contains({}, {0, 0}));
    EXPECT_EQ(plan_area({}), 0);
    EXPECT_TRUE(contains({square(0, 0, 1), {{}}}, {0.5, 0.5}));
}

TEST(Extent, encloses_all_points_away_from_the_origin) {
    const Extent e = extent_of({square(east, north, 10), {}});
    EXPECT_EQ(e.x_min, east);
    EXPECT_EQ(e.y_max, north + 10);
    EXPECT_EQ(e.width(), 10);
    EXPECT_TRUE(e.grown(1).contains({east - 1, north}));
    EXPECT_FALSE(e.contains({east - 1, north}));
}

TEST(LocalFrame, float_positions_keep_a_tenth_of_a_millimetre_a_kilometre_away) {
    const LocalFrame frame{{east, north, 300}};
    const WorldPoint p{east + 987.65432, north - 654.32109, 345.6789};
    const WorldPoint back = frame.to_world(frame.to_local(p));
    EXPECT_NEAR(back.x, p.x, 1e-4);
    EXPECT_NEAR(back.y, p.y, 1e-4);
    EXPECT_NEAR(back.z, p.z, 1e-4);
}

TEST(Vec3, arithmetic) {
    const Vec3<double> a{1, 2, 3}, b{4, -5, 6};
    EXPECT_EQ(dot(a, b), 12);
    EXPECT_EQ(length(Vec3<double>{2, 3, 6}), 7);
    const Vec3<double> c = 2.0 * a - b;
    EXPECT_EQ(c.x, -2);
    EXPECT_EQ(c.y, 9);
    EXPECT_EQ(c.z, 0);
}

}  // namespace
}  // namespace talus
