#include "run/second_opinion.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace talus::run {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

Grid<float> row_of(std::vector<float> values, double x_min = 0, double cell = 2) {
    Grid<float> grid(GridGeometry{x_min, 0, cell, static_cast<int>(values.size()), 1});
    grid.values = std::move(values);
    return grid;
}

scene::Scene scene_on(int columns, double cell) {
    scene::Scene scene;
    scene.terrain = terrain::Terrain(Grid<float>(GridGeometry{0, 0, cell, columns, 2}, 5.0F));
    scene.spec.outputs.arrival_depth = 0.1;
    return scene;
}

RunResult with_depths(Grid<float> depths) {
    RunResult result;
    result.observation.maps.peak_depth = std::move(depths);
    return result;
}

TEST(AreaAgreement, IsTheSharedAreaOverTheAreaOfEither) {
    // Cells of 4 m2: two in both, one in the first alone, three in the second alone, one too shallow in both.
    const AreaAgreement areas = area_agreement(row_of({1, 2, 0.3F, none, 0, 0.09F, none, 0.05F}),
                                               row_of({1, 0.2F, none, 3, 0.4F, 0.11F, none, 0.09F}), 0.1);
    EXPECT_DOUBLE_EQ(areas.both, 8);
    EXPECT_DOUBLE_EQ(areas.only_first, 4);
    EXPECT_DOUBLE_EQ(areas.only_second, 12);
    EXPECT_DOUBLE_EQ(areas.intersection_over_union(), 2.0 / 6);
}

TEST(AreaAgreement, IsOneForTheSameAreaZeroForNoneSharedAndUnknownForNone) {
    const Grid<float> west = row_of({1, 1, none, none}), east = row_of({none, none, 1, 1});
    EXPECT_DOUBLE_EQ(area_agreement(west, west, 0.1).intersection_over_union(), 1);
    EXPECT_DOUBLE_EQ(area_agreement(west, east, 0.1).intersection_over_union(), 0);
    EXPECT_TRUE(std::isnan(area_agreement(west, east, 2).intersection_over_union()));
}

TEST(SecondOpinion, ComparesMapsOfDifferentCellsAndPlacesOnTheCoarserOnes) {
    const scene::Scene scene = scene_on(10, 4);
    // Fine cells of 2 m from 4 m on, coarse ones of 4 m from 8 m on.
    RunResult particles = with_depths(row_of({1, 1, 2, 4}, 4)), grid = with_depths(row_of({1, 5}, 8, 4));
    for (Grid<float>* map : {&particles.observation.maps.peak_depth}) {
        map->geometry.rows = 2;
        map->values = {1, 1, 2, 4, 1, 1, 2, 4};
    }
    const SecondOpinion opinion = second_opinion(scene, particles, grid);
    ASSERT_EQ(opinion.difference.geometry, (GridGeometry{4, 0, 4, 3, 1}));
    EXPECT_FLOAT_EQ(opinion.particles.values[0], 1);
    EXPECT_FLOAT_EQ(opinion.particles.values[1], 3);
    EXPECT_TRUE(std::isnan(opinion.particles.values[2]));
    EXPECT_FLOAT_EQ(opinion.difference.values[0], -1);
    EXPECT_FLOAT_EQ(opinion.difference.values[1], -2);
    EXPECT_FLOAT_EQ(opinion.difference.values[2], 5);
    EXPECT_DOUBLE_EQ(opinion.area.intersection_over_union(), 1.0 / 3);
    EXPECT_DOUBLE_EQ(opinion.depth.size(), 5);
    EXPECT_DOUBLE_EQ(opinion.depth.at.x, 14);
}

TEST(SecondOpinion, FindsWhereTheFrontsDifferMostInTime) {
    const scene::Scene scene = scene_on(4, 2);
    RunResult particles = with_depths(row_of({1})), grid = with_depths(row_of({1}));
    particles.observation.front = {{10, 1.0}, {20, 2.0}, {30, 3.0}, {40, 4.0}};
    grid.observation.front = {{10, 1.5}, {20, 4.0}, {30, 2.0}};
    const SecondOpinion opinion = second_opinion(scene, particles, grid);
    EXPECT_DOUBLE_EQ(opinion.arrival.chainage, 20);
    EXPECT_DOUBLE_EQ(opinion.arrival.size(), 2);
    EXPECT_FALSE(second_opinion(scene, with_depths(row_of({none})), grid).arrival.known());
}

}  // namespace
}  // namespace talus::run
