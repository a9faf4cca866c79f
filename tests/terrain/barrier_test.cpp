#include "terrain/barrier.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "terrain/grids.hpp"

namespace talus::terrain {
namespace {

using testing::HasSubstr;

/// 60 x 40 m that falls to the east by 1 : 2.
Terrain slope() {
    return Terrain(make({1000, 2000, 1, 60, 40}, [](double x, double) { return 100 - 0.5 * (x - 1000); }));
}

/// Across the slope at x = 1030, 30 m long.
params::BarrierSpec dam(std::vector<params::BarrierOpeningSpec> openings = {}) {
    return {{{1030, 2005}, {1030, 2035}}, 4, {}, 1, std::move(openings)};
}

/// Height of the solid above the ground at a place along the dam.
double height_at(const Terrain& terrain, const Building& barrier, double y) {
    const BuildingSolids solids(terrain, {barrier}, 2);
    const LocalPoint p = terrain.frame().to_local({1030, y, 0});
    const double ground = terrain.sample(p.x, p.y).height;
    double height = 0;
    while (height < 20 && solids.inside(Vec3<double>{p.x, p.y, ground + height + 0.005})) height += 0.01;
    return height;
}

TEST(Barrier, is_open_to_the_ground_in_a_slot_and_to_its_sill_in_a_spillway) {
    const Terrain terrain = slope();
    const auto made = make_barrier(terrain, "dam", dam({{10, 3, 0}, {20.5, 4, 2.5}}));
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_NEAR(height_at(terrain, *made, 2008), 4, 0.1);
    for (const double y : {2013.55, 2015.0, 2016.45}) EXPECT_EQ(height_at(terrain, *made, y), 0) << y;
    for (const double y : {2013.45, 2016.55}) EXPECT_NEAR(height_at(terrain, *made, y), 4, 0.1) << y;
    for (const double y : {2023.55, 2025.5, 2027.45}) EXPECT_NEAR(height_at(terrain, *made, y), 2.5, 0.1) << y;
    EXPECT_NEAR(height_at(terrain, *made, 2030), 4, 0.1);
}

TEST(Barrier, with_a_crest_elevation_is_level) {
    const Terrain terrain = slope();
    params::BarrierSpec shape = dam();
    shape.line = {{1020, 2020}, {1040, 2020}};  // down the slope: ground from 90 to 80 m
    shape.crest_elevation = 92;
    const auto made = make_barrier(terrain, "dam", shape);
    ASSERT_TRUE(made) << made.error().message;
    for (const double roof : made->part_roof_elevations) EXPECT_EQ(roof, 92);
    EXPECT_NEAR(made->height, 7, 0.2) << "the mean above the ground";
    shape.crest_elevation = 60;
    const auto below = make_barrier(terrain, "dam", shape);
    ASSERT_FALSE(below);
    EXPECT_THAT(below.error().message, HasSubstr("crest_elevation_m = 60: lies below the ground all along the line"));
}

TEST(Barrier, refuses_openings_that_do_not_fit) {
    const Terrain terrain = slope();
    const auto refusal = [&](std::vector<params::BarrierOpeningSpec> openings) {
        const auto made = make_barrier(terrain, "dam", dam(std::move(openings)));
        return made ? std::string("(made)") : made.error().message;
    };
    EXPECT_THAT(refusal({{29, 3, 0}}), HasSubstr("opening 1: reaches from 27.5 to 30.5 m along a line of 30 m"));
    EXPECT_THAT(refusal({{5, 3, 0}, {7, 2, 0}}), HasSubstr("openings 1 and 2: overlap"));
    EXPECT_THAT(refusal({{5, 3, 4}}), HasSubstr("sill_height_m = 4 must be below the barrier's height of 4 m"));
    EXPECT_THAT(refusal({{15, 30, 0}}), HasSubstr("nothing of the barrier is left"));
}

TEST(Building, without_its_solid_keeps_its_place_and_stops_nothing) {
    const Terrain terrain = slope();
    Building wall = *make_barrier(terrain, "dam", dam());
    EXPECT_TRUE(stands(wall));
    wall = without_solid(std::move(wall));
    EXPECT_FALSE(stands(wall));
    EXPECT_EQ(height_at(terrain, wall, 2020), 0);
    EXPECT_NEAR(extent_of(wall).height(), 30, 1e-9);
}

}  // namespace
}  // namespace talus::terrain
