#include "observe/map_accumulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "observe/particles.hpp"

namespace talus::observe {
namespace {

using test::advance;
using test::block;

/// The value of a map at a local position (world = local + (1000, 2000)).
float value_at(const Grid<float>& map, double x, double y) {
    const GridGeometry& g = map.geometry;
    return map.at(static_cast<int>(std::floor((1000 + x - g.x_min) / g.cell)),
                  static_cast<int>(std::floor((2000 + y - g.y_min) / g.cell)));
}

/// As of the last add, at a local position; 0 where no debris is.
double speed_now(const MapAccumulator& maps, double x, double y) {
    const Grid<float> speed = maps.present().speed;
    return speed.values.empty() || !speed.geometry.extent().contains({1000 + x, 2000 + y}) ? 0 : value_at(speed, x, y);
}

TEST(MapAccumulator, depth_of_a_slab_is_its_layers_thick_wherever_it_lies_on_the_map) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    for (const double shift : {0.0, 0.13, 0.27, 0.5, 0.71}) {
        const sim::State state = block(0.4, -12 + shift, -12 + shift, 60, 60, 5);
        MapAccumulator maps(model, ground, state, 1, 0.1);
        maps.add(state);
        const HazardMaps result = maps.maps();
        for (double x = -9.5; x < 9; ++x) {
            for (double y = -9.5; y < 9; ++y) EXPECT_NEAR(value_at(result.peak_depth, x, y), 2.0, 0.04);
        }
        EXPECT_TRUE(std::isnan(value_at(result.peak_depth, -18, 0)));
    }
}

TEST(MapAccumulator, the_map_holds_exactly_the_volume_of_the_particles) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -3.17, -3.03, 17, 13, 3, {1.3F, 0.2F, 0});
    test::add_particle(state, {99.9F, -99.9F, 0});  // in the map's corner
    MapAccumulator maps(model, ground, state, 1, 0.1);
    for (int step = 0; step < 30; ++step) {
        maps.add(state);
        EXPECT_EQ(maps.volume(), state.count * model.particle_volume());
        advance(state, 0.37);
    }
}

TEST(MapAccumulator, debris_in_any_order_makes_the_same_maps) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> place(-100, 100), speed(0, 30);
    for (int i = 0; i < 60000; ++i) {  // over all of the ground and its rim: 4 x 4 times as many tiles as a task holds
        test::add_particle(state, {place(random), place(random), 0}, {speed(random), speed(random), 0});
    }
    const auto maps_of = [&] {
        MapAccumulator maps(model, ground, state, 0.4, 0.1);
        maps.add(state);
        EXPECT_EQ(maps.volume(), state.count * model.particle_volume());
        return maps.maps();
    };
    const HazardMaps scattered = maps_of();
    std::vector<std::uint32_t> order(state.count);
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(std::floor(state.position.y[a] / 3), state.position.x[a]) <
               std::pair(std::floor(state.position.y[b] / 3), state.position.x[b]);
    });
    const sim::State before = state;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        state.position.set(i, before.position.at(order[i]));
        state.velocity.set(i, before.velocity.at(order[i]));
    }
    const HazardMaps sorted = maps_of();
    for (const auto map : {&HazardMaps::peak_depth, &HazardMaps::peak_speed, &HazardMaps::peak_pressure,
                           &HazardMaps::arrival_time, &HazardMaps::deposit_depth}) {
        const Grid<float>&a = scattered.*map, &b = sorted.*map;
        ASSERT_EQ(a.geometry, b.geometry);
        std::size_t filled = 0;
        for (std::size_t k = 0; k < b.values.size(); ++k) {
            // No cell may be empty in one of them alone.
            ASSERT_EQ(std::isnan(a.values[k]), std::isnan(b.values[k])) << k;
            if (std::isnan(a.values[k])) continue;
            ASSERT_EQ(a.values[k], b.values[k]) << k;
            ++filled;
        }
        EXPECT_GT(filled, 10000U);
    }
}

TEST(MapAccumulator, deposit_is_where_debris_lies_at_the_end_and_keeps_its_volume) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -20, -4, 20, 20, 4, {10, 0, 0});
    MapAccumulator maps(model, ground, state, 1, 0.1);
    for (int step = 0; step <= 20; ++step) {
        if (step > 0) advance(state, 0.1);
        maps.add(state);
    }
    const HazardMaps result = maps.maps();
    EXPECT_NEAR(value_at(result.deposit_depth, 4.5, 0.5), 1.6, 0.04);
    EXPECT_EQ(value_at(result.deposit_depth, -16.5, 0.5), 0) << "reached, but nothing stayed";
    EXPECT_NEAR(value_at(result.peak_depth, -16.5, 0.5), 1.6, 0.04);
    double volume = 0;
    for (const float depth : result.deposit_depth.values) volume += std::isnan(depth) ? 0 : depth;
    EXPECT_NEAR(volume, state.count * model.particle_volume(), 1e-3 * volume);
}

TEST(MapAccumulator, speed_is_averaged_over_depth_and_pressure_follows_from_it) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -8, -8, 40, 40, 4);
    for (std::uint32_t i = 0; i < state.count; ++i) {  // 2 m/s in the lowest layer, 8 in the highest
        state.velocity.x[i] = 2 + 2 * std::floor(state.position.z[i] / 0.4F);
    }
    MapAccumulator maps(model, ground, state, 1, 0.1);
    maps.add(state);
    const HazardMaps result = maps.maps();
    EXPECT_NEAR(value_at(result.peak_speed, 0.5, 0.5), 5, 1e-3);
    EXPECT_NEAR(value_at(result.peak_pressure, 0.5, 0.5), 2000 * 25, 20);
    EXPECT_NEAR(speed_now(maps, 0.5, 0.5), 5, 1e-3);
    EXPECT_EQ(speed_now(maps, 50, 50), 0);
}

TEST(MapAccumulator, peaks_are_over_all_steps_and_speed_and_volume_of_the_last_step_alone) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -8, -8, 40, 40, 2, {3, 0, 0});
    MapAccumulator maps(model, ground, state, 1, 0.1);
    maps.add(state);
    for (float& v : state.velocity.x) v = 1;
    maps.add(state);
    EXPECT_NEAR(value_at(maps.maps().peak_speed, 0.5, 0.5), 3, 1e-3);
    EXPECT_NEAR(speed_now(maps, 0.5, 0.5), 1, 1e-3);
    for (float& x : state.position.x) x += 40;
    maps.add(state);
    EXPECT_EQ(speed_now(maps, 0.5, 0.5), 0);
    EXPECT_NEAR(value_at(maps.maps().peak_depth, 0.5, 0.5), 0.8, 0.02);
}

TEST(MapAccumulator, debris_arrives_when_it_is_deeper_than_the_arrival_depth) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -30, -8, 50, 40, 4, {5, 0, 0});  // front edge at x = -10, 1.6 m deep
    MapAccumulator maps(model, ground, state, 1, 0.8);
    maps.add(state);
    for (int step = 0; step < 400; ++step) {
        advance(state, 0.01);
        maps.add(state);
    }
    const HazardMaps result = maps.maps();
    EXPECT_EQ(value_at(result.arrival_time, -15.5, 0.5), 0);
    // Half the depth: when the front edge passes the cell's middle.
    for (double x = -5.5; x < 9; ++x) EXPECT_NEAR(value_at(result.arrival_time, x, 0.5), (x + 10) / 5, 0.05);
}

TEST(MapAccumulator, a_lone_particle_makes_no_peak) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -8, -8, 40, 40, 2);
    test::add_particle(state, {40.1F, 0.1F, 0}, {50, 0, 0});
    MapAccumulator maps(model, ground, state, 1, 0.1);
    for (int step = 0; step < 50; ++step) {
        maps.add(state);
        advance(state, 0.003);
    }
    for (const float speed : maps.maps().peak_speed.values) EXPECT_FALSE(speed > 1e-3);
}

TEST(MapAccumulator, held_and_broken_particles_do_not_count) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -8, -8, 10, 10, 2);
    state.held.assign(state.count, 1);
    state.held[0] = 0;
    state.held[1] = 0;
    state.position.x[1] = std::nanf("");
    state.velocity.y[0] = std::nanf("");
    MapAccumulator maps(model, ground, state, 1, 0.1);
    maps.add(state);
    EXPECT_EQ(maps.volume(), model.particle_volume());
}

TEST(MapAccumulator, maps_share_a_frame_on_the_terrains_raster_around_the_debris) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    const sim::State state = block(0.4, 0, 0, 25, 25, 2);  // 10 m square
    MapAccumulator maps(model, ground, state, 0.5, 0.1);
    maps.add(state);
    const HazardMaps result = maps.maps();
    const GridGeometry& g = result.peak_depth.geometry;
    for (const Grid<float>* map :
         {&result.peak_speed, &result.peak_pressure, &result.arrival_time, &result.deposit_depth}) {
        EXPECT_EQ(map->geometry, g);
        EXPECT_EQ(map->values.size(), g.size());
    }
    EXPECT_EQ(std::fmod(g.x_min - 900, 0.5), 0);
    EXPECT_EQ(std::fmod(g.y_min - 1900, 0.5), 0);
    EXPECT_NEAR(g.x_min, 1000 - 20, 1);
    EXPECT_NEAR(g.extent().x_max, 1010 + 20, 1);
    EXPECT_NEAR(g.extent().y_max, 2010 + 20, 1);
}

TEST(MapAccumulator, maps_end_at_the_terrain_and_exist_even_without_debris) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, -99, -99, 10, 10, 2);
    MapAccumulator near_corner(model, ground, state, 1, 0.1);
    near_corner.add(state);
    EXPECT_EQ(near_corner.maps().peak_depth.geometry.x_min, 900);
    EXPECT_EQ(near_corner.maps().peak_depth.geometry.y_min, 1900);
    state.held.assign(state.count, 1);
    MapAccumulator nothing(model, ground, state, 1, 0.1);
    nothing.add(state);
    const HazardMaps result = nothing.maps();
    EXPECT_GT(result.peak_depth.geometry.size(), 4U);
    for (const float depth : result.peak_depth.values) EXPECT_TRUE(std::isnan(depth));
}

TEST(MapAccumulator, shows_debris_as_it_lies_now) {
    const sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, 0, 0, 40, 40, 5, {3, 0, 0});
    MapAccumulator maps(model, ground, state, 1, 0.1);
    maps.add(state);
    test::advance(state, 10);
    maps.add(state);
    const auto now = maps.present();
    const GridGeometry& window = now.depth.geometry;
    EXPECT_EQ(window.x_min, maps.geometry().x_min + now.first_column * window.cell);
    EXPECT_EQ(window.y_min, maps.geometry().y_min + now.first_row * window.cell);
    EXPECT_GE(window.x_min, 1000 + 30 - 10) << "not where it was before";
    double volume = 0;
    for (const float depth : now.depth.values) volume += depth;
    EXPECT_NEAR(volume, state.count * model.particle_volume(), 1e-3);
    const auto column = static_cast<int>(1038 - window.x_min), row = static_cast<int>(2008 - window.y_min);
    EXPECT_NEAR(now.depth.at(column, row), 2, 0.1);
    EXPECT_NEAR(now.speed.at(column, row), 3, 0.01);
    const MapAccumulator nothing(model, ground, state, 1, 0.1);
    EXPECT_EQ(nothing.present().depth.values.size(), 0U);
}

TEST(MapAccumulator, peak_pressures_are_of_the_density_at_their_time) {
    sim::Model model = test::make_model(0.4);
    const sim::Ground ground = test::make_ground();
    sim::State state = block(0.4, 0, 0, 40, 40, 5, {4, 0, 0});
    MapAccumulator maps(model, ground, state, 1, 0.1);
    maps.add(state);
    model.rest_density = 3000;
    maps.follow(model, state);
    const auto pressure_at = [&](double x) {
        const Grid<float> map = maps.maps().peak_pressure;
        return map.at(static_cast<int>(x - map.geometry.x_min), static_cast<int>(2008 - map.geometry.y_min));
    };
    EXPECT_NEAR(pressure_at(1008), 2000 * 16, 200);
    maps.add(state);
    EXPECT_NEAR(pressure_at(1008), 3000 * 16, 300);
    model.rest_density = 1000;
    maps.follow(model, state);
    test::advance(state, 10);
    maps.add(state);
    EXPECT_NEAR(pressure_at(1008), 3000 * 16, 300) << "the densest before";
    EXPECT_NEAR(pressure_at(1048), 1000 * 16, 100) << "reached later";
}

}  // namespace
}  // namespace talus::observe
