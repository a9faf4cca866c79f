#include "terrain/release.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "terrain/grids.hpp"
#include "terrain/inflow.hpp"

namespace talus::terrain {
namespace {

/// A plane that rises eastward.
Terrain plane(double slope, double cell = 5, int cells = 60) {
    return Terrain(make({0, 0, cell, cells, cells}, [slope](double x, double) { return slope * x; }));
}

Ring square(double x, double y, double size) {
    return {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
}

Ring circle(double x, double y, double radius) {
    Ring ring;
    for (int i = 0; i < 720; ++i) {
        const double a = i * std::numbers::pi / 360;
        ring.push_back({x + radius * std::cos(a), y + radius * std::sin(a)});
    }
    return ring;
}

Release release(const Polygon& polygon, double thickness) {
    Release r;
    r.patches.push_back({polygon, thickness});
    return r;
}

TEST(ReleaseVolume, slab_on_a_slope_is_its_true_area_times_thickness) {
    for (const double slope : {0.0, 0.5, 1.0}) {
        const double expected = 20 * 20 * std::sqrt(1 + slope * slope) * 1.5;
        const double volume = release_volume(plane(slope), release({square(101.3, 97.7, 20), {}}, 1.5));
        EXPECT_NEAR(volume, expected, 1e-3 * expected) << "slope " << slope;
    }
}

TEST(ReleaseVolume, patches_smaller_than_a_cell_and_round_ones_are_exact_to_a_per_mille) {
    const Terrain flat = plane(0);
    EXPECT_NEAR(release_volume(flat, release({square(101, 101, 1.7), {}}, 2)), 2 * 1.7 * 1.7, 2e-3 * 1.7 * 1.7);
    const double ring = std::numbers::pi * (17.0 * 17.0 - 6.0 * 6.0);
    EXPECT_NEAR(release_volume(flat, release({circle(150, 150, 17), {circle(152, 149, 6)}}, 1)), ring, 1e-3 * ring);
    const Polygon sliver{{{100, 100}, {160, 130}, {160, 130.4}}, {}};
    EXPECT_NEAR(release_volume(flat, release(sliver, 1)), plan_area(sliver), 2e-3 * plan_area(sliver));
}

TEST(ReleaseVolume, patches_add_up_and_each_has_its_thickness) {
    Release two = release({square(100, 100, 10), {}}, 1);
    two.patches.push_back({{square(110, 100, 10), {}}, 3});
    EXPECT_NEAR(release_volume(plane(0), two), 400, 0.4);
    EXPECT_EQ(two.thickness_at({105, 105}), 1);
    EXPECT_EQ(two.thickness_at({115, 105}), 3);
    EXPECT_EQ(two.thickness_at({125, 105}), 0);
    EXPECT_EQ(two.extent().x_min, 100);
    EXPECT_EQ(two.extent().x_max, 120);
}

TEST(ReleaseVolume, ground_that_is_not_covered_counts_nothing) {
    // Cell centres span 2.5 to 297.5 m: half of this square lies beyond.
    EXPECT_NEAR(release_volume(plane(0), release({square(-17.5, 100, 40), {}}, 1)), 20 * 40, 4);
}

TEST(ReleaseVolume, raster_thickness_replaces_the_patches_own_within_them) {
    Release r = release({square(100, 100, 20), {}}, 99);
    r.thickness_raster = Grid<float>(GridGeometry{95, 95, 5, 4, 4}, 2.0F);  // covers 95 to 115
    r.thickness_raster->at(1, 1) = nodata;
    r.thickness_raster->at(2, 1) = -1;
    EXPECT_NEAR(release_volume(plane(0), r), 2 * (15 * 15 - 50), 0.5);
    EXPECT_EQ(r.thickness_at({108, 113}), 2);
    EXPECT_EQ(r.thickness_at({102, 102}), 0);  // nodata
    EXPECT_EQ(r.thickness_at({106, 102}), 0);  // negative
    EXPECT_EQ(r.thickness_at({97, 97}), 0);    // outside the patch
    EXPECT_EQ(r.thickness_at({118, 118}), 0);  // outside the raster

    r.patches.clear();  // the raster alone
    EXPECT_EQ(r.thickness_at({97, 97}), 2);
    EXPECT_NEAR(release_volume(plane(0), r), 2 * (400 - 50), 0.7);
}

TEST(ReleaseVolume, on_curved_ground_agrees_with_a_fine_sum) {
    const Terrain terrain(
        make({0, 0, 2, 60, 60}, [](double x, double y) { return 0.01 * (x - 60) * (x - 60) + 4 * std::sin(y / 9); }));
    const Release r = release({circle(55, 62, 18), {}}, 0.8);
    double expected = 0;
    const double h = 0.04;
    for (double y = 40 + h / 2; y < 84; y += h) {
        for (double x = 30 + h / 2; x < 80; x += h) {
            const double t = r.thickness_at({x, y});
            if (t > 0) expected += t / terrain.slope_cosine_at({x, y}) * h * h;
        }
    }
    EXPECT_NEAR(release_volume(terrain, r), expected, 1e-3 * expected);
}

TEST(MeanThickness, is_normal_to_the_slope_and_of_the_ground_that_has_any) {
    const Terrain slope = plane(1);
    Release slab = release({square(100, 100, 20), {}}, 1.5);
    const auto mean = [&] {
        slab.volume = release_volume(slope, slab);
        return mean_thickness(slope, slab);
    };
    EXPECT_NEAR(mean(), 1.5, 1e-3);
    slab.spec.thickness_direction = params::ThicknessDirection::vertical;
    EXPECT_NEAR(mean(), 1.5 / std::sqrt(2.0), 1e-3);
    slab.spec.thickness_direction = params::ThicknessDirection::normal;
    slab.thickness_raster = make({90, 90, 5, 8, 8}, [](double x, double) { return x < 105 ? 0 : x < 110 ? 1 : 3; });
    EXPECT_NEAR(mean(), (1 + 3 + 3) / 3.0, 5e-3) << "a quarter of the polygon is bare";
    slab.patches.front().thickness = 0;
    slab.thickness_raster.reset();
    EXPECT_EQ(mean(), 0);
}

TEST(MeanThickness, of_an_inflow_is_its_discharge_over_width_and_velocity) {
    Inflow inflow;
    inflow.from = {0, 0};
    inflow.to = {3, 4};
    inflow.hydrograph = {{.time = 0, .velocity = 9}, {.time = 10, .velocity = 2}};
    EXPECT_EQ(inflow.mean_thickness(), 0);
    inflow.hydrograph.push_back({.time = 20, .discharge = 8, .velocity = 2});
    EXPECT_DOUBLE_EQ(inflow.mean_thickness(), 4 / (5.0 * 2)) << "of the surge, not of the ten seconds before it";
    inflow.hydrograph.push_back({.time = 30, .discharge = 8, .velocity = 2});
    EXPECT_DOUBLE_EQ(inflow.mean_thickness(), 6 / (5.0 * 2));
}

}  // namespace
}  // namespace talus::terrain
