#include "terrain/terrain.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "terrain/grids.hpp"

namespace talus::terrain {
namespace {

Grid<float> rough_ground(const GridGeometry& geometry, float highest, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> any(0, highest);
    Grid<float> grid(geometry);
    for (float& z : grid.values) z = any(random);
    return grid;
}

/// Calls `check` along the edges that run north between the cells of a grid of 20 x 20 cells of 5 m.
template <class Check>
void at_cell_edges(const Check& check) {
    for (int c = 1; c < 18; ++c) {
        for (float y = -40; y < 40; y += 1.3F) check(-47.5F + 5 * static_cast<float>(c), y);
    }
}

TEST(Terrain, a_plane_is_reproduced_exactly_everywhere_between_cell_centres) {
    const GridGeometry g{820000, 825000, 5, 40, 30};
    const Terrain terrain(make(g, [](double x, double y) { return 100 + 0.5 * (x - 820000) - 0.25 * (y - 825000); }));
    const double inverse_length = 1 / std::sqrt(1 + 0.5 * 0.5 + 0.25 * 0.25);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> in_x(2.5, 197.5), in_y(2.5, 147.5);
    for (int i = 0; i < 1000; ++i) {
        const double x = in_x(random), y = in_y(random);
        EXPECT_NEAR(terrain.elevation_at({820000 + x, 825000 + y}), 100 + 0.5 * x - 0.25 * y, 2e-5);
        EXPECT_NEAR(terrain.slope_cosine_at({820000 + x, 825000 + y}), inverse_length, 1e-6);
    }
    const auto normal = terrain.sample(1.0F, 2.0F).normal;
    EXPECT_NEAR(normal.x, -0.5 * inverse_length, 3e-6);
    EXPECT_NEAR(normal.y, 0.25 * inverse_length, 1e-6);
    EXPECT_NEAR(normal.z, inverse_length, 1e-6);
}

TEST(Terrain, frame_is_the_middle_of_the_grid_at_the_lowest_elevation) {
    const Terrain terrain(make({1000, 2000, 2, 10, 20}, [](double x, double) { return x; }));
    EXPECT_EQ(terrain.frame().origin.x, 1010);
    EXPECT_EQ(terrain.frame().origin.y, 2020);
    EXPECT_EQ(terrain.frame().origin.z, 1001);
    EXPECT_NEAR(terrain.sample(-9.0F, 0.0F).height, 0, 1e-6);
}

TEST(Terrain, heights_agree_from_both_sides_of_every_cell_edge) {
    const Terrain terrain(rough_ground({0, 0, 5, 20, 20}, 50, 2));
    at_cell_edges([&](float x, float y) {
        const float on = terrain.sample(x, y).height;
        EXPECT_NEAR(terrain.sample(std::nextafter(x, -100.0F), y).height, on, 1e-3);
        EXPECT_NEAR(terrain.sample(std::nextafter(x, 100.0F), y).height, on, 1e-3);
    });
}

TEST(Terrain, cell_centres_carry_their_own_elevation) {
    const Grid<float> grid = rough_ground({0, 0, 0.7, 15, 12}, 50, 3);
    const Terrain terrain(grid);
    for (int r = 0; r < 12; ++r) {
        for (int c = 0; c < 15; ++c) {
            const PlanPoint p = grid.geometry.centre(c, r);
            const auto sample = terrain.sample(p.x - terrain.frame().origin.x, p.y - terrain.frame().origin.y);
            EXPECT_NEAR(sample.height + terrain.frame().origin.z, grid.at(c, r), 1e-3);
        }
    }
}

TEST(Terrain, normal_is_that_of_the_smooth_ground_below) {
    const Terrain terrain(
        make({0, 0, 1, 50, 50}, [](double x, double y) { return 0.02 * x * y + 3 * std::sin(x / 7); }));
    std::mt19937 random(4);
    std::uniform_real_distribution<double> at(-22, 22);
    for (int i = 0; i < 500; ++i) {
        const double x = at(random), y = at(random);
        const auto n = terrain.sample(x, y).normal;
        // At summits and bottoms, where the slope at the nearest centre is set level, wrong by half the curvature,
        // 3/49, over a cell; without twist, by up to 0.15 of the mixed derivative, 0.02, from each side.
        EXPECT_NEAR(-n.x / n.z, 0.02 * (y + 25) + 3.0 / 7 * std::cos((x + 25) / 7), 0.034);
        EXPECT_NEAR(-n.y / n.z, 0.02 * (x + 25), 6e-3);
        EXPECT_NEAR(length(n), 1, 1e-12);
    }
}

TEST(Terrain, normals_turn_gradually_from_cell_to_cell) {
    const Terrain terrain(rough_ground({0, 0, 5, 20, 20}, 20, 9));
    at_cell_edges([&](float x, float y) {
        const auto west = terrain.sample(x - 2e-4F, y).normal, east = terrain.sample(x + 2e-4F, y).normal;
        EXPECT_NEAR(length(east - west), 0, 5e-3);
    });
}

TEST(Terrain, heights_and_normals_belong_to_one_surface) {
    const Terrain terrain(make({0, 0, 2, 30, 30}, [](double x, double y) {
        return 0.05 * x * y + 2 * std::sin(x / 3) + (x > 31 ? -12 : 0);  // with a cliff
    }));
    std::mt19937 random(8);
    std::uniform_real_distribution<double> at(-25, 25);
    for (int i = 0; i < 2000; ++i) {
        const double x = at(random), y = at(random), h = 1e-5;
        const auto n = terrain.sample(x, y).normal;
        EXPECT_NEAR(-n.x / n.z, (terrain.sample(x + h, y).height - terrain.sample(x - h, y).height) / (2 * h), 1e-4);
        EXPECT_NEAR(-n.y / n.z, (terrain.sample(x, y + h).height - terrain.sample(x, y - h).height) / (2 * h), 1e-4);
    }
}

TEST(Terrain, does_not_swell_beside_a_cliff) {
    const Terrain terrain(make({0, 0, 1, 20, 5}, [](double x, double) { return x < 10 ? 10 : 0; }));
    for (double x = -9; x <= 9; x += 0.05) {
        const double z = terrain.sample(x, 0.0).height;
        EXPECT_LE(z, 10 + 1e-9);
        EXPECT_GE(z, -1e-9);
        if (x < -0.5) {
            EXPECT_NEAR(z, 10, 1e-9);
        }
    }
}

TEST(Terrain, normals_beside_nodata_and_at_the_rim_are_taken_from_the_side_that_is_known) {
    Grid<float> grid = make({0, 0, 1, 12, 12}, [](double x, double y) { return 0.5 * x - 0.25 * y; });
    grid.at(5, 5) = nodata;
    const Terrain terrain(grid);
    int covered = 0;
    for (float x = -5.5F; x <= 5.5F; x += 0.25F) {
        for (float y = -5.5F; y <= 5.5F; y += 0.25F) {
            if (!terrain.covers(x, y)) continue;
            ++covered;
            const auto n = terrain.sample(x, y).normal;
            EXPECT_NEAR(-n.x / n.z, 0.5, 1e-5);
            EXPECT_NEAR(-n.y / n.z, -0.25, 1e-5);
        }
    }
    EXPECT_GT(covered, 1800);
}

TEST(Terrain, covers_the_hull_of_cell_centres_and_nothing_else) {
    const Terrain terrain(make({0, 0, 2, 10, 10}, [](double, double) { return 5; }));
    EXPECT_TRUE(terrain.covers(-9.0F, -9.0F));
    EXPECT_TRUE(terrain.covers(9.0F, 9.0F));
    EXPECT_FALSE(terrain.covers(-9.01F, 0.0F));
    EXPECT_FALSE(terrain.covers(0.0F, 9.01F));
    EXPECT_FALSE(terrain.covers(std::numeric_limits<float>::quiet_NaN(), 0.0F));
    EXPECT_FALSE(terrain.covers(std::numeric_limits<float>::infinity(), 0.0F));
    EXPECT_TRUE(std::isnan(terrain.elevation_at({0.5, 10})));
    EXPECT_TRUE(std::isnan(terrain.slope_cosine_at({0.5, 10})));
}

TEST(Terrain, does_not_cover_cells_with_a_nodata_corner) {
    Grid<float> grid = make({0, 0, 1, 10, 10}, [](double, double) { return 5; });
    grid.at(4, 4) = nodata;  // centre at local (-0.5, -0.5)
    const Terrain terrain(grid);
    for (const float dx : {-0.9F, 0.9F}) {
        for (const float dy : {-0.9F, 0.9F}) EXPECT_FALSE(terrain.covers(-0.5F + dx, -0.5F + dy));
    }
    EXPECT_TRUE(terrain.covers(-0.5F + 1.01F, -0.5F));
    EXPECT_TRUE(terrain.covers(-0.5F, -0.5F - 1.01F));
    EXPECT_TRUE(std::isnan(terrain.elevation_at({4.5, 4.9})));
    EXPECT_EQ(terrain.frame().origin.z, 5) << "nodata must not become the lowest elevation";
}

TEST(Terrain, continues_as_a_plane_where_there_is_no_data) {
    const auto plane = [](double x, double y) { return 0.5 * x - 0.25 * y; };
    const Terrain complete(make({0, 0, 1, 30, 20}, plane));
    Grid<float> grid = make({0, 0, 1, 30, 20}, plane);
    for (int row = 0; row < 20; ++row) {
        for (int column = 0; column < 30; ++column) {
            const bool collar = column + row < 8, hole = std::abs(column - 20) < 4 && std::abs(row - 10) < 3;
            if (collar || hole || (column == 12 && row == 12)) grid.at(column, row) = nodata;
        }
    }
    Terrain gaps(std::move(grid));
    for (const bool changed : {false, true}) {
        for (double x = -18; x <= 18; x += 0.35) {
            for (double y = -12; y <= 12; y += 0.35) {
                const auto here = gaps.sample(x, y), there = complete.sample(x, y);
                EXPECT_NEAR(here.height + gaps.frame().origin.z, there.height + complete.frame().origin.z, 1e-4);
                EXPECT_NEAR(here.normal.x, there.normal.x, 1e-5);
            }
        }
        if (!changed) gaps.set_elevation(gaps.cell_at(-3.5F, 2.5F), gaps.elevation().at(11, 12));  // beside the hole
    }
    EXPECT_FALSE(gaps.covers(-2.5F, 2.5F));
    EXPECT_TRUE(std::isnan(gaps.elevation_at({12.5, 12.5})));
}

TEST(Terrain, beyond_the_grid_the_edge_cell_goes_on) {
    const Terrain terrain(make({0, 0, 2, 10, 10}, [](double x, double) { return 2 * x; }));
    EXPECT_NEAR(terrain.sample(15.0F, 0.0F).height, 2 * (15 + 9), 1e-4);
    EXPECT_NEAR(terrain.sample(-15.0F, 0.0F).height, 2 * (-15 + 9), 1e-4);
}

}  // namespace
}  // namespace talus::terrain
