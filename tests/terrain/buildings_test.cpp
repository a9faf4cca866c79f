#include "terrain/buildings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "terrain/grids.hpp"

namespace talus::terrain {
namespace {

using Vec = Vec3<double>;

/// Level ground at z = 0 whose frame's origin is the world's, so that world and local coordinates agree.
Terrain level_ground() {
    return Terrain(Grid<float>(GridGeometry{-200, -200, 2, 200, 200}, 0.0F));
}

Ring rectangle(double x_min, double y_min, double x_max, double y_max) {
    return {{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}};
}

Building building(std::vector<Polygon> footprint, double roof) {
    Building b;
    b.footprint = std::move(footprint);
    b.height = b.roof_elevation = roof;
    return b;
}

void expect_sample(const BuildingSolids& solids, const Vec& p, int index, double distance, const Vec& normal) {
    const SolidSample<double> s = solids.nearest(p);
    ASSERT_EQ(s.building, index);
    EXPECT_NEAR(s.distance, distance, 1e-12);
    EXPECT_NEAR(s.normal.x, normal.x, 1e-12);
    EXPECT_NEAR(s.normal.y, normal.y, 1e-12);
    EXPECT_NEAR(s.normal.z, normal.z, 1e-12);
}

TEST(BuildingSolids, distances_and_normals_of_a_box_are_exact_on_every_side) {
    const BuildingSolids solids(level_ground(), {building({{rectangle(0, 0, 10, 6), {}}}, 5)}, 8);
    expect_sample(solids, {-2, 3, 1}, 0, 2, {-1, 0, 0});
    expect_sample(solids, {13, 3, -20}, 0, 3, {1, 0, 0});  // walls go on below the ground
    expect_sample(solids, {5, -1, 4.9}, 0, 1, {0, -1, 0});
    expect_sample(solids, {5, 3, 7}, 0, 2, {0, 0, 1});
    expect_sample(solids, {-3, 10, 0}, 0, 5, {-0.6, 0.8, 0});               // corner
    expect_sample(solids, {13, 3, 9}, 0, 5, {0.6, 0, 0.8});                 // edge of the roof
    expect_sample(solids, {12, 9, 11}, 0, 7, {2.0 / 7, 3.0 / 7, 6.0 / 7});  // corner of the roof
    expect_sample(solids, {1, 3, 1}, 0, -1, {-1, 0, 0});                    // inside, by a wall
    expect_sample(solids, {5, 3, 4.5}, 0, -0.5, {0, 0, 1});                 // inside, by the roof
    expect_sample(solids, {5, 5.5, -50}, 0, -0.5, {0, 1, 0});               // inside, below the ground
}

TEST(BuildingSolids, parts_can_have_a_roof_each) {
    Building wall = building({{rectangle(0, 0, 4, 2), {}}, {rectangle(4, 0, 8, 2), {}}}, 5);
    wall.part_roof_elevations = {3, 6};
    const BuildingSolids solids(level_ground(), {wall}, 8);
    expect_sample(solids, {1, 1, 4}, 0, 1, {0, 0, 1});
    expect_sample(solids, {7, 1, 7}, 0, 1, {0, 0, 1});
    expect_sample(solids, {3.5, 1, 5}, 0, 0.5, {-1, 0, 0});  // the higher part's wall above the lower one's roof
    EXPECT_TRUE(solids.inside(Vec{4, 1, 2}));
    expect_sample(solids, {3.9, 1, 2.5}, 0, -0.5, {0, 0, 1});  // not out through the joint
    wall.part_roof_elevations[0] = std::nan("");
    EXPECT_FALSE(BuildingSolids(level_ground(), {wall}, 8).inside(Vec{1, 1, 1}));
}

TEST(BuildingSolids, beyond_its_range_it_reports_nothing) {
    const BuildingSolids solids(level_ground(), {building({{rectangle(0, 0, 10, 6), {}}}, 5)}, 4);
    for (const Vec& p : {Vec{-4.01, 3, 1}, Vec{-3, 10, 1}, Vec{5, 3, 9.01}, Vec{1e9, 3, 1}, Vec{std::nan(""), 3, 1}}) {
        EXPECT_EQ(solids.nearest(p).building, -1);
    }
    EXPECT_EQ(solids.nearest(Vec{-3.99, 3, 1}).building, 0);
    EXPECT_EQ(solids.nearest(Vec{5, 3, -100}).building, 0) << "inside counts at any depth";
    EXPECT_TRUE(BuildingSolids(level_ground(), {}, 4).empty());
    EXPECT_EQ(BuildingSolids(level_ground(), {}, 4).nearest(Vec{0, 0, 0}).building, -1);
}

TEST(BuildingSolids, normals_are_unit_on_walls_edges_and_vertices) {
    const BuildingSolids solids(level_ground(), {building({{rectangle(0, 0, 10, 6), {}}}, 5)}, 4);
    for (const float x : {0.0F, 1e-9F, 5.0F, 10.0F}) {
        for (const float y : {0.0F, 3.0F, 6.0F}) {
            for (const float z : {0.0F, 4.9999F, 5.0F, 5.0001F}) {
                const SolidSample<float> s = solids.nearest(Vec3<float>{x, y, z});
                ASSERT_EQ(s.building, 0);
                EXPECT_NEAR(length(s.normal), 1, 1e-6) << x << ' ' << y << ' ' << z;
                const Vec3<float> outside = Vec3<float>{x, y, z} + 3.5F * s.normal;
                EXPECT_FALSE(solids.inside(outside)) << "normal leads into the solid";
            }
        }
    }
    EXPECT_FALSE(solids.inside(Vec{0, 3, 1})) << "a wall is not strictly inside";
    EXPECT_FALSE(solids.inside(Vec{5, 3, 5}));
    EXPECT_TRUE(solids.inside(Vec{1e-6, 3, 1}));
}

TEST(BuildingSolids, orientation_repeated_points_and_closing_points_do_not_matter) {
    Ring ring = rectangle(0, 0, 10, 6);
    Ring untidy{ring[3], ring[2], ring[2], ring[1], ring[0], ring[3]};
    const BuildingSolids solids(level_ground(), {building({{untidy, {}}}, 5)}, 4);
    expect_sample(solids, {0, 3, 1}, 0, 0, {-1, 0, 0});
    expect_sample(solids, {10, 3, 1}, 0, 0, {1, 0, 0});
    expect_sample(solids, {2, 3, 1}, 0, -2, {-1, 0, 0});
}

TEST(BuildingSolids, a_courtyard_is_outside_and_its_walls_face_it) {
    const BuildingSolids solids(level_ground(), {building({{rectangle(0, 0, 20, 20), {rectangle(5, 5, 15, 15)}}}, 8)},
                                6);
    expect_sample(solids, {6, 10, 1}, 0, 1, {1, 0, 0});
    expect_sample(solids, {5, 10, 1}, 0, 0, {1, 0, 0});
    expect_sample(solids, {4, 10, 1}, 0, -1, {1, 0, 0});
    expect_sample(solids, {1, 10, 1}, 0, -1, {-1, 0, 0});
    EXPECT_NEAR(solids.nearest(Vec{10, 10, 9}).distance, std::sqrt(26.0), 1e-12);
}

TEST(BuildingSolids, a_second_wall_is_seen_in_corners_and_alleys_only) {
    // An L of two buildings: walls at x = 0 for y > 0, and at y = 0 for x > 0; a third one across an alley.
    const BuildingSolids solids(
        level_ground(),
        {building({{rectangle(-8, 0, 0, 20), {}}}, 9), building({{rectangle(-8, -6, 20, 0), {}}}, 5),
         building({{rectangle(3, 10, 9, 20), {}}}, 9)},
        4);
    const auto expect_second = [&](const Vec& p, int index, double distance, const Vec& normal) {
        const SolidSample<double> s = solids.second_nearest(p, solids.nearest(p));
        EXPECT_EQ(s.building, index) << p.x << " " << p.y << " " << p.z;
        if (index < 0) return;
        EXPECT_NEAR(s.distance, distance, 1e-12);
        EXPECT_NEAR(dot(s.normal, normal), 1, 1e-12);
    };
    expect_second({1, 2, 1}, 1, 2, {0, 1, 0});  // corner: the wall farther off
    expect_second({2, 1, 1}, 0, 2, {1, 0, 0});
    expect_second({1, 15, 1}, 2, 2, {-1, 0, 0});   // alley
    expect_second({1, 4.5, 1}, -1, 0, {});         // beyond the range
    expect_second({-1, -2, 6}, 0, 2, {0, -1, 0});  // a roof, and the higher wall beside it
    expect_second({1, -2, 6}, -1, 0, {});
}

TEST(BuildingSolids, parts_of_a_footprint_belong_to_one_building) {
    const BuildingSolids solids(
        level_ground(), {building({}, 5), building({{rectangle(0, 0, 4, 4), {}}, {rectangle(20, 0, 24, 4), {}}}, 5)},
        3);
    expect_sample(solids, {-1, 2, 1}, 1, 1, {-1, 0, 0});
    expect_sample(solids, {25, 2, 1}, 1, 1, {1, 0, 0});
    EXPECT_EQ(solids.nearest(Vec{12, 2, 1}).building, -1);
}

TEST(BuildingSolids, a_wall_between_terraced_houses_is_no_surface) {
    // Common wall at x = 10, drawn with different vertices on either side; the eastern house is taller.
    const BuildingSolids solids(level_ground(),
                                {building({{rectangle(0, 0, 10, 8), {}}}, 5),
                                 building({{{{10, -2}, {20, -2}, {20, 8}, {10, 8}, {10, 3}}, {}}}, 9)},
                                4);
    expect_sample(solids, {9.9, 0.5, 1}, 0, -0.5, {0, -1, 0});       // out by the front, not into the neighbour
    expect_sample(solids, {10.1, 4, 6}, 1, -0.1, {-1, 0, 0});        // the taller one's wall is free above the lower
    expect_sample(solids, {10.3, 4, 4.6}, 1, -0.5, {-0.6, 0, 0.8});  // out over the lower roof
    expect_sample(solids, {9.5, 4, 5.2}, 0, 0.2, {0, 0, 1});
    expect_sample(solids, {9.9, 4, 6}, 1, 0.1, {-1, 0, 0});
    expect_sample(solids, {10.1, -1, 1}, 1, -0.1, {-1, 0, 0});  // the taller one juts out
}

double box_distance(const Vec& p, const Vec& low, const Vec& high) {
    const Vec outside{std::max({low.x - p.x, 0.0, p.x - high.x}), std::max({low.y - p.y, 0.0, p.y - high.y}),
                      std::max(0.0, p.z - high.z)};
    return length(outside);
}

TEST(BuildingSolids, walls_that_meet_others_at_their_corners_are_there_all_along) {
    // The corners of a yard of four walls: every wall's end is met by two edges of another, at places that rounding
    // sets a hair apart.
    const double half = 6, half_width = 3 * 0.3, end = 8.4, side = 3.3;
    const BuildingSolids solids(level_ground(),
                                {building({{rectangle(-end, half_width, end, side), {}}}, 7),
                                 building({{rectangle(-end, -side, end, -half_width), {}}}, 7),
                                 building({{rectangle(-end, -side, -half, side), {}}}, 7),
                                 building({{rectangle(half, -side, end, side), {}}}, 7)},
                                0.66);
    for (double x = -5.8; x < 5.85; x += 0.1) {
        expect_sample(solids, {x, 0.752, 0.44}, 0, half_width - 0.752, {0, -1, 0});
        expect_sample(solids, {x, -0.752, 0.44}, 1, half_width - 0.752, {0, 1, 0});
    }
}

TEST(BuildingSolids, random_overlapping_boxes_agree_with_brute_force) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> at(-40, 40), size(2, 15), roof(2, 10), z(-1, 13);
    std::vector<Building> buildings;
    std::vector<std::pair<Vec, Vec>> boxes;
    for (int i = 0; i < 60; ++i) {
        const double x = at(random), y = at(random), w = size(random), d = size(random), h = roof(random);
        buildings.push_back(building({{rectangle(x, y, x + w, y + d), {}}}, h));
        boxes.push_back({{x, y, 0}, {x + w, y + d, h}});
    }
    const double range = 3;
    const BuildingSolids solids(level_ground(), buildings, range);
    int inside_count = 0, near_count = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec p{at(random) * 1.5, at(random) * 1.5, z(random)};
        double nearest = std::numeric_limits<double>::infinity();
        bool inside = false;
        for (const auto& [low, high] : boxes) {
            nearest = std::min(nearest, box_distance(p, low, high));
            inside |= p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y && p.z < high.z;
        }
        const SolidSample<double> s = solids.nearest(p);
        EXPECT_EQ(solids.inside(p), inside);
        if (inside) {
            ++inside_count;
            ASSERT_GE(s.building, 0);
            ASSERT_LT(s.distance, 0);
            // The way out leads out of all of them, and just before its end is still inside.
            EXPECT_FALSE(solids.inside(p + (1e-7 - s.distance) * s.normal));
            EXPECT_TRUE(solids.inside(p + (-1e-7 - s.distance) * s.normal));
        } else if (nearest <= range) {
            ++near_count;
            ASSERT_GE(s.building, 0);
            EXPECT_NEAR(s.distance, nearest, 1e-12);
            const auto& [low, high] = boxes[static_cast<std::size_t>(s.building)];
            EXPECT_NEAR(box_distance(p, low, high), nearest, 1e-12);
        } else {
            EXPECT_EQ(s.building, -1);
        }
        EXPECT_TRUE(s.building < 0 || std::abs(length(s.normal) - 1) < 1e-12);
    }
    EXPECT_GT(inside_count, 1000);
    EXPECT_GT(near_count, 1000);
}

TEST(BuildingSolids, distance_to_an_l_shaped_house_agrees_with_a_dense_sample_of_its_outline) {
    const Ring outline{{0, 0}, {12, 1}, {11, 5}, {6, 4}, {5, 11}, {-1, 10}};
    const BuildingSolids solids(level_ground(), {building({{outline, {}}}, 50)}, 20);
    std::mt19937 random(6);
    std::uniform_real_distribution<double> at(-6, 16);
    for (int i = 0; i < 500; ++i) {
        const Vec p{at(random), at(random), 1};
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t e = 0; e < outline.size(); ++e) {
            const PlanPoint &a = outline[e], &b = outline[(e + 1) % outline.size()];
            for (int k = 0; k <= 2000; ++k) {
                const double t = k / 2000.0;
                nearest = std::min(nearest, std::hypot(a.x + t * (b.x - a.x) - p.x, a.y + t * (b.y - a.y) - p.y));
            }
        }
        const bool in = contains({outline, {}}, {p.x, p.y});
        const SolidSample<double> s = solids.nearest(p);
        ASSERT_EQ(s.building, 0);
        EXPECT_NEAR(s.distance, in ? -nearest : nearest, 2e-3);
        EXPECT_NEAR(solids.nearest(p + (-s.distance) * s.normal).distance, 0, 1e-9) << "normal misses the surface";
    }
}

TEST(BuildingSolids, a_net_is_a_wall_for_coarse_grains_only) {
    // A house with a net along its eastern wall, both 6 m high.
    std::vector<Building> buildings{building({{rectangle(0, 0, 10, 6), {}}}, 6),
                                    building({{rectangle(10, 0, 11, 6), {}}}, 6)};
    buildings[1].barrier = params::BarrierSpec{{}, 6, {}, 1, {}, 0.4};
    BuildingSolids solids(level_ground(), buildings, 4);
    const Vec in_net{10.4, 3, 1}, in_house{9.8, 3, 1}, before{12, 3, 1};
    EXPECT_TRUE(solids.inside(in_net, 0.4F));
    EXPECT_FALSE(solids.inside(in_net, 0.39F));
    EXPECT_EQ(solids.nearest(before, 0.4F).building, 1);
    EXPECT_NEAR(solids.nearest(before, 0.4F).distance, 1, 1e-12);
    EXPECT_EQ(solids.nearest(before, 0.39F).building, 0);
    EXPECT_NEAR(solids.nearest(before, 0.39F).distance, 2, 1e-12);
    // The way out of the house leads through the net for what the net does not stop.
    EXPECT_NEAR(solids.nearest(in_house, 0.39F).distance, -0.2, 1e-12);
    EXPECT_EQ(solids.nearest(in_house, 0.39F).normal.x, 1);
    EXPECT_LT(solids.nearest(in_net, 0.4F).distance, 0);
    EXPECT_NEAR(solids.nearest(in_net, 0.4F).normal.x, 1, 1e-12) << "into the house is no way out";
    solids.close_nets();
    EXPECT_TRUE(solids.inside(in_net, 0.0F));
}

TEST(BuildingSolids, float_and_double_agree_to_rounding) {
    const BuildingSolids solids(level_ground(), {building({{rectangle(100, 100, 110, 106), {}}}, 5)}, 4);
    const SolidSample<float> s = solids.nearest(Vec3<float>{99.9F, 103, 1});
    EXPECT_NEAR(s.distance, 100 - 99.9F, 1e-7);
    EXPECT_EQ(s.normal.x, -1);
}

TEST(PlaceBuildings, roof_is_the_height_above_the_mean_ground_of_all_parts) {
    const Terrain terrain(make({0, 0, 5, 40, 40}, [](double x, double) { return 100 + 0.4 * x; }));
    std::vector<Building> buildings{building({{rectangle(50, 50, 60, 60), {}}}, 6),
                                    building({{rectangle(50, 50, 60, 60), {}}, {rectangle(100, 50, 110, 80), {}}}, 6),
                                    building({{rectangle(70, 50, 70.02, 50.02), {}}}, 6),
                                    building({{rectangle(-60, -60, -50, -50), {}}}, 6)};
    place_buildings(terrain, buildings);
    EXPECT_NEAR(buildings[0].roof_elevation, 100 + 0.4 * 55 + 6, 0.01);
    EXPECT_NEAR(buildings[1].roof_elevation, 100 + 0.4 * (55 + 3 * 105) / 4 + 6, 0.05);
    EXPECT_NEAR(buildings[2].roof_elevation, 100 + 0.4 * 70.01 + 6, 0.01);
    EXPECT_TRUE(std::isnan(buildings[3].roof_elevation)) << "no ground there";
    const BuildingSolids solids(terrain, {buildings[3]}, 5);
    EXPECT_TRUE(solids.empty());
}

}  // namespace
}  // namespace talus::terrain
