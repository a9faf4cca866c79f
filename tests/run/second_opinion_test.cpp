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
    HazardMaps& maps = result.observation.maps;
    maps = {depths, depths, depths, depths, depths, depths};
    return result;
}

TEST(AreaAgreement, is_the_shared_area_over_the_area_of_either) {
    // Cells of 4 m2: two in both, one in the first alone, three in the second alone, one too shallow in both.
    const AreaAgreement areas = area_agreement(row_of({1, 2, 0.3F, none, 0, 0.09F, none, 0.05F}),
                                               row_of({1, 0.2F, none, 3, 0.4F, 0.11F, none, 0.09F}), 0.1);
    EXPECT_DOUBLE_EQ(areas.both, 8);
    EXPECT_DOUBLE_EQ(areas.only_first, 4);
    EXPECT_DOUBLE_EQ(areas.only_second, 12);
    EXPECT_DOUBLE_EQ(areas.intersection_over_union(), 2.0 / 6);
}

TEST(AreaAgreement, is_one_for_the_same_area_zero_for_none_shared_and_unknown_for_none) {
    const Grid<float> west = row_of({1, 1, none, none}), east = row_of({none, none, 1, 1});
    EXPECT_DOUBLE_EQ(area_agreement(west, west, 0.1).intersection_over_union(), 1);
    EXPECT_DOUBLE_EQ(area_agreement(west, east, 0.1).intersection_over_union(), 0);
    EXPECT_TRUE(std::isnan(area_agreement(west, east, 2).intersection_over_union()));
}

TEST(SecondOpinion, compares_maps_of_different_cells_and_places_on_the_coarser_ones) {
    const scene::Scene scene = scene_on(10, 4);
    // Fine cells of 2 m from 4 m on, coarse ones of 4 m from 8 m on.
    Grid<float> fine = row_of({1, 1, 2, 4}, 4);
    fine.geometry.rows = 2;
    fine.values = {1, 1, 2, 4, 1, 1, 2, 4};
    const RunResult particles = with_depths(fine), grid = with_depths(row_of({1, 5}, 8, 4));
    const SecondOpinion opinion = second_opinion(scene, particles, grid);
    const MapPair& depth = opinion.depth;
    ASSERT_EQ(depth.difference.geometry, (GridGeometry{4, 0, 4, 3, 1}));
    EXPECT_FLOAT_EQ(depth.particles.values[0], 1);
    EXPECT_FLOAT_EQ(depth.particles.values[1], 3);
    EXPECT_TRUE(std::isnan(depth.particles.values[2]));
    EXPECT_FLOAT_EQ(depth.difference.values[0], -1);
    EXPECT_FLOAT_EQ(depth.difference.values[1], -2);
    EXPECT_FLOAT_EQ(depth.difference.values[2], 5);
    EXPECT_DOUBLE_EQ(opinion.area.intersection_over_union(), 1.0 / 3);
    EXPECT_DOUBLE_EQ(depth.largest.size(), 5);
    EXPECT_DOUBLE_EQ(depth.largest.at.x, 14);
}

TEST(SecondOpinion, compares_peaks_of_speed_on_the_cells_of_each_and_medians_on_the_ground_of_both) {
    const scene::Scene scene = scene_on(8, 2);
    RunResult particles = with_depths(row_of({1, 1, 1, 1, 1, none, none}));
    RunResult grid = with_depths(row_of({0.05F, 0.05F, 1, 1, 1, 1, none}));
    particles.observation.maps.peak_speed = row_of({30, 20, 4, 5, 6, none, none});
    grid.observation.maps.peak_speed = row_of({1, 1, 8, 10, 80, 20, none});
    const MapPair speed = second_opinion(scene, particles, grid).speed;
    EXPECT_DOUBLE_EQ(speed.peak_particles.value, 30);
    EXPECT_DOUBLE_EQ(speed.peak_particles.at.x, 1);
    EXPECT_DOUBLE_EQ(speed.peak_depth_averaged.value, 80);
    EXPECT_DOUBLE_EQ(speed.peak_depth_averaged.at.x, 9);
    // Where both are deeper than 0.1 m; the spike of one cell does not change it.
    EXPECT_DOUBLE_EQ(speed.median_particles, 5);
    EXPECT_DOUBLE_EQ(speed.median_depth_averaged, 10);
    EXPECT_DOUBLE_EQ(speed.largest.size(), 74);
    EXPECT_FLOAT_EQ(speed.difference.values[5], 20) << "no debris is 0";
    EXPECT_TRUE(std::isnan(speed.difference.values[6]));
}

TEST(SecondOpinion, a_half_covered_cell_keeps_the_speed_of_its_debris_and_the_volume_of_its_depth) {
    const scene::Scene scene = scene_on(10, 4);
    const RunResult particles = with_depths(row_of({6, none}, 4)), grid = with_depths(row_of({5}, 4, 4));
    const SecondOpinion opinion = second_opinion(scene, particles, grid);
    // A row of fine cells, half as high as the coarse ones.
    EXPECT_FLOAT_EQ(opinion.depth.particles.values[0], 1.5);
    EXPECT_FLOAT_EQ(opinion.speed.particles.values[0], 6);
}

/// Debris that covers a band from (10, 10) east to `end`, at 5 m/s, and followed itself.
RunResult followed_to(double end) {
    RunResult result = with_depths(Grid<float>(GridGeometry{0, 0, 1, 300, 21}, none));
    observe::Observation& o = result.observation;
    for (int column = 8; column < end; ++column) {
        for (int row = 6; row < 15; ++row) {
            o.maps.peak_depth.at(column, row) = o.maps.peak_speed.at(column, row) = 1;
            o.maps.arrival_time.at(column, row) = static_cast<float>(std::max(0, column - 20) / 5.0);
            o.maps.arrival_speed.at(column, row) = 5;
        }
    }
    o.run_out.along_flow = end - 10;
    o.run_out.toe = {end, 10};
    o.followed_path = terrain::FlowPath({{10, 10}, {end, 10}}, 40);
    o.run_out.front_chainage = end - 10;
    o.timeseries.resize(1);
    o.timeseries[0].time = 1000;
    o.timeseries[0].front_chainage = end - 10;
    return result;
}

TEST(TakeOnePath, the_front_of_neither_model_ends_with_the_path_of_the_other) {
    for (const bool particles_farther : {false, true}) {
        scene::Scene scene = scene_on(300, 1), grid_scene = scene_on(300, 1);
        RunResult particles = followed_to(particles_farther ? 278 : 238),
                  grid = followed_to(particles_farther ? 238 : 278);
        take_one_path(scene, particles, grid_scene, grid);
        EXPECT_DOUBLE_EQ(scene.flow_path.length(), 268);
        EXPECT_DOUBLE_EQ(grid_scene.flow_path.length(), 268);
        EXPECT_EQ(scene.flow_path_origin, scene::PathOrigin::followed);
        EXPECT_EQ(grid_scene.notes.size(), 1U);
        const observe::Observation& farther = (particles_farther ? particles : grid).observation;
        const observe::Observation& other = (particles_farther ? grid : particles).observation;
        EXPECT_NEAR(farther.run_out.front_chainage, 268, 1.5);
        EXPECT_NEAR(other.run_out.front_chainage, 228, 2.5);
        EXPECT_NEAR(other.timeseries[0].front_chainage, 228, 2.5);
        EXPECT_DOUBLE_EQ(other.followed_path->length(), 268);
        EXPECT_NEAR(front_at(other, 150).arrival_time, (150 + 10 - 20) / 5.0, 0.5);
    }
}

TEST(TakeOnePath, leaves_a_path_that_the_scene_gives) {
    scene::Scene scene = scene_on(300, 1), grid_scene = scene_on(300, 1);
    scene.flow_path = grid_scene.flow_path = terrain::FlowPath({{0, 0}, {100, 0}}, 40);
    RunResult particles = followed_to(238), grid = followed_to(278);
    particles.observation.followed_path = grid.observation.followed_path = std::nullopt;
    take_one_path(scene, particles, grid_scene, grid);
    EXPECT_DOUBLE_EQ(scene.flow_path.length(), 100);
    EXPECT_DOUBLE_EQ(particles.observation.run_out.front_chainage, 228);
    EXPECT_TRUE(scene.notes.empty());
}

TEST(SecondOpinion, finds_where_the_fronts_differ_most_in_time) {
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
