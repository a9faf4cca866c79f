#include "observe/building_impact.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "observe/particles.hpp"

namespace talus::observe {
namespace {

using test::block;

/// On level ground: a building that nothing touches and a house of 10 x 10 m whose western wall is at x = 4.
sim::Ground ground_with_buildings() {
    sim::Ground ground = test::make_ground();
    ground.buildings.resize(2);
    ground.buildings[0].name = "untouched";
    ground.buildings[1].name = "house";
    ground.buildings[1].footprint = {{{{1004, 1995}, {1014, 1995}, {1014, 2005}, {1004, 2005}}, {}}};
    ground.buildings[1].roof_elevation = 56;
    return ground;
}

/// The middle of a patch of the western wall.
constexpr LocalPoint patch_middle{4, 0.5F, 0.5F};

/// Debris moving at `speed` against building 1: `count` particles touch it in every step and give it `force` together.
struct Collision {
    sim::Model model;
    sim::Ground ground = ground_with_buildings();
    sim::State state;
    ImpactRecorder recorder;
    LocalPoint place = patch_middle;
    float speed = 1e6F;  ///< all of an impulse arrives in its step

    explicit Collision(double window, double spacing = 0.4, double patch_edge = 1)
        : model(test::make_model(spacing)),
          state(block(0.4, 0, -8, 10, 40, 3, {})),
          recorder(model, ground, state, [&] {
              params::OutputSpec outputs;
              outputs.impact_filter_window = window;
              outputs.impact_patch_edge = patch_edge;
              return outputs;
          }()) {}

    void step(double time_step, double force, std::uint32_t first, std::uint32_t count) {
        begin(time_step);
        for (std::uint32_t i = first; i < first + count; ++i) touch(i, force / count, place);
        recorder.after_step(model, ground, state);
    }
    void begin(double time_step) {
        state.time += time_step;
        state.time_step = time_step;
        state.building_contacts.clear();
    }
    void touch(std::uint32_t particle, double force, const LocalPoint& at) {
        state.building_contacts.push_back({particle, 1, static_cast<float>(force * state.time_step), at, speed});
    }
    const BuildingImpact& house() const { return recorder.impacts()[1]; }
};

TEST(ImpactRecorder, a_constant_force_is_found_whatever_the_steps) {
    for (const double time_step : {0.001, 0.0037, 0.05, 0.5}) {
        Collision c(0.2);
        for (double t = 0; t < 1; t += time_step) c.step(time_step, 50000, 0, 10);
        EXPECT_NEAR(c.house().peak_force, 50000, 1) << time_step;
        EXPECT_NEAR(c.house().peak_impact_pressure, 50000, 1) << time_step;
    }
}

TEST(ImpactRecorder, a_short_knock_is_spread_over_the_window) {
    for (const double time_step : {0.001, 0.004}) {
        Collision c(0.2);
        c.step(time_step, 600 / time_step, 0, 2);  // 600 N s
        EXPECT_NEAR(c.house().peak_force, 3000, 0.1);
        EXPECT_NEAR(c.house().peak_impact_pressure, 3000, 0.1);
    }
}

TEST(ImpactRecorder, knocks_add_up_within_the_window_and_not_beyond) {
    Collision c(0.2);
    c.step(0.01, 60000, 0, 2);
    for (int i = 0; i < 5; ++i) c.step(0.01, 0, 0, 0);
    c.step(0.01, 60000, 0, 2);
    EXPECT_NEAR(c.house().peak_force, 2 * 600 / 0.2, 0.1);
    for (int i = 0; i < 30; ++i) c.step(0.01, 0, 0, 0);
    c.step(0.01, 90000, 0, 2);
    EXPECT_NEAR(c.house().peak_force, 2 * 600 / 0.2, 0.1);
    EXPECT_NEAR(c.house().peak_impact_pressure, 2 * 600 / 0.2, 0.1);
}

/// 20 kPa on the western wall, 10 x 6 m, by particles of this spacing.
double pressure_of_even_load(double spacing, double patch_edge) {
    Collision c(0.2, spacing, patch_edge);
    for (int k = 0; k < 21; ++k) {
        c.begin(0.01);
        for (double y = -5 + spacing / 2; y < 5; y += spacing) {
            for (double z = spacing / 2; z < 6; z += spacing) {
                c.touch(0, 20000 * spacing * spacing, {4, static_cast<float>(y), static_cast<float>(z)});
            }
        }
        c.recorder.after_step(c.model, c.ground, c.state);
    }
    EXPECT_NEAR(c.house().peak_force, 20000 * 60, 20);
    return c.house().peak_impact_pressure;
}

TEST(ImpactRecorder, pressure_depends_on_the_patch_and_not_on_the_spacing) {
    for (const double spacing : {2.0, 1.0, 0.5, 0.25}) {
        EXPECT_NEAR(pressure_of_even_load(spacing, 1), 20000, 1) << spacing;
        EXPECT_NEAR(pressure_of_even_load(spacing, 0.5), 20000, 1) << spacing;
    }
    EXPECT_NEAR(pressure_of_even_load(0.5, 10), 12000, 1) << "1200 kN on 10 x 10 m, though the wall is 6 m high";
}

/// A stream as high as the western wall, 10 x 6 m, of a lattice whose layers arrive at it one after the other.
TEST(ImpactRecorder, a_stream_presses_with_its_momentum_flux_whatever_its_spacing) {
    const double density = 2000, speed = 8;
    for (const double spacing : {2.0, 1.0, 0.5, 0.25}) {
        Collision c(0.2, spacing);
        c.speed = static_cast<float>(speed);
        const double time_step = 0.005, between = spacing / speed;
        double next = 0, delivered = 0;
        while (c.state.time < 2) {
            c.begin(time_step);
            for (; next < c.state.time; next += between) {
                for (double y = -5 + spacing / 2; y < 5; y += spacing) {
                    for (double z = spacing / 2; z < 6; z += spacing) {
                        const double impulse = density * spacing * spacing * spacing * speed;
                        c.touch(0, impulse / time_step, {4, static_cast<float>(y), static_cast<float>(z)});
                        delivered += impulse;
                    }
                }
            }
            c.recorder.after_step(c.model, c.ground, c.state);
        }
        EXPECT_NEAR(c.house().peak_force / (density * speed * speed * 60), 1, 0.02) << spacing;
        EXPECT_NEAR(c.house().peak_impact_pressure / (density * speed * speed), 1, 0.02) << spacing;
        EXPECT_NEAR(c.house().impulse / delivered, 1, 1e-6) << spacing;
    }
}

TEST(ImpactRecorder, an_impulse_arrives_with_the_debris_behind_it_and_none_of_it_is_lost) {
    Collision c(0.2, 0.4);
    c.speed = 2;  // the two spacings take 0.4 s, twice the window
    c.step(0.01, 60000, 0, 1);
    double sum = 0;
    for (int i = 0; i < 80; ++i) {
        c.recorder.add_row(c.state);
        sum += c.house().history.back().force * 0.01;
        c.step(0.01, 0, 0, 0);
    }
    EXPECT_NEAR(c.house().peak_force, 600 / 0.4, 1);
    EXPECT_NEAR(c.house().impulse, 600, 0.01);
    EXPECT_NEAR(sum, 600, 0.1);
    EXPECT_NEAR(c.house().history.back().force, 0, 1e-6);
}

TEST(ImpactRecorder, debris_at_rest_passes_its_pressure_on_at_the_speed_of_waves) {
    Collision c(0.2, 0.4);
    c.speed = 0;
    c.step(0.01, 60000, 0, 1);
    for (int i = 0; i < 80; ++i) c.step(0.01, 0, 0, 0);
    EXPECT_NEAR(c.house().peak_force, 600 / (2 * std::sqrt(0.4 / c.model.gravity)), 1);
}

TEST(ImpactRecorder, a_structure_fails_when_the_rest_of_a_blow_arrives) {
    Collision c(0.2, 0.4);
    c.ground.buildings[1].resistance.pressure = 2000;
    c.speed = 4;  // 0.2 s
    c.step(0.01, 60000, 0, 1);
    EXPECT_TRUE(c.recorder.failed().empty());
    for (int i = 0; i < 30; ++i) c.step(0.01, 0, 0, 0);
    EXPECT_NEAR(c.house().failure_time, 0.14, 0.011) << "no touch since the first, but 2/3 of it has arrived";
}

TEST(ImpactRecorder, a_lone_particle_presses_on_no_less_than_the_reference_area) {
    for (const float y : {0.5F, 0.9F, 1.0F, 4.99F, 5.0F}) {  // also at the corner
        Collision c(0.2);
        c.place = {4, y, 0.3F};
        c.step(0.01, 1e5, 0, 1);
        EXPECT_NEAR(c.house().peak_force, 5000, 1);
        EXPECT_LE(c.house().peak_impact_pressure, 5001) << y;
        EXPECT_GE(c.house().peak_impact_pressure, 5000 / 2.01) << y;
    }
}

TEST(ImpactRecorder, depth_and_dynamic_pressure_are_those_of_the_flow_in_front_of_the_wall) {
    Collision c(0.2);
    for (float& x : c.state.velocity.x) x = 6;
    for (float& y : c.state.velocity.y) y = 8;
    c.step(0.01, 0, 0, 0);
    EXPECT_FALSE(c.house().hit);
    EXPECT_EQ(c.house().peak_depth, 0);
    c.step(0.01, 1000, 810, 3);
    EXPECT_TRUE(c.house().hit);
    EXPECT_NEAR(c.house().first_hit_time, 0.02, 1e-12);
    EXPECT_NEAR(c.house().peak_depth, 1.2, 1e-5);
    EXPECT_NEAR(c.house().peak_dynamic_pressure, 2000 * 36, 1) << "of the velocity towards the wall";
    EXPECT_NEAR(c.house().peak_speed, 10, 1e-5);
    EXPECT_FALSE(c.recorder.impacts()[0].hit);
    EXPECT_TRUE(std::isnan(c.recorder.impacts()[0].first_hit_time));
    EXPECT_EQ(c.recorder.impacts()[0].name, "untouched");
    for (float& x : c.state.position.x) x -= 1;
    c.step(0.01, 0, 0, 0);
    c.recorder.add_row(c.state);
    ASSERT_EQ(c.house().history.size(), 1U);
    EXPECT_EQ(c.house().history[0].depth, 0) << "it has gone back";
    EXPECT_NEAR(c.house().history[0].impact_pressure, 1000 * 0.01 / 0.2, 1e-3);
}

TEST(ImpactRecorder, impulse_is_that_of_all_steps_and_its_history_falls_to_no_force) {
    Collision c(0.2);
    for (int i = 0; i < 100; ++i) c.step(0.01, 50000, 0, 10);
    EXPECT_NEAR(c.house().impulse, 50000, 5);
    c.recorder.add_row(c.state);
    for (int i = 0; i < 100; ++i) c.step(0.01, 0, 0, 0);
    c.recorder.add_row(c.state);
    ASSERT_EQ(c.house().history.size(), 2U);
    EXPECT_NEAR(c.house().history[0].force, 50000, 5);
    EXPECT_NEAR(c.house().history[0].impact_pressure, 50000, 5);
    EXPECT_NEAR(c.house().history[1].force, 0, 1e-9);
    EXPECT_NEAR(c.house().history[1].impulse, 50000, 5);
    EXPECT_TRUE(c.recorder.impacts()[0].history.empty()) << "it was never hit";
}

TEST(ImpactRecorder, resistance_is_exceeded_once_by_the_filtered_pressure) {
    Collision c(0.2);
    c.ground.buildings[1].resistance.pressure = 32000;
    for (int i = 0; i < 50; ++i) c.step(0.01, 31000, 0, 10);
    EXPECT_TRUE(c.recorder.failed().empty());
    EXPECT_TRUE(std::isnan(c.house().failure_time));
    int failures = 0;
    double when = 0;
    for (int i = 0; i < 50; ++i) {
        c.step(0.01, 34000, 0, 10);
        if (!c.recorder.failed().empty()) when = c.state.time;
        failures += static_cast<int>(c.recorder.failed().size());
    }
    EXPECT_EQ(failures, 1);
    EXPECT_EQ(c.house().failure_time, when);
    // The window's mean gets there when a third of it is at the higher force.
    EXPECT_NEAR(when, 0.57, 0.015);
}

TEST(ImpactRecorder, buildings_come_behind_and_records_begin_anew) {
    Collision c(0.2);
    for (int k = 0; k < 10; ++k) c.step(0.05, 50000, 0, 10);
    c.ground.buildings.emplace_back().name = "new";
    c.recorder.follow(c.model, c.ground, c.state);
    ASSERT_EQ(c.recorder.impacts().size(), 3U);
    EXPECT_EQ(c.recorder.impacts()[2].name, "new");
    EXPECT_NEAR(c.house().peak_force, 50000, 1);
    c.recorder.forget(c.model, c.ground, c.state, 1);
    EXPECT_FALSE(c.house().hit);
    EXPECT_EQ(c.house().peak_force, 0);
    EXPECT_EQ(c.house().name, "house");
    for (int k = 0; k < 10; ++k) c.step(0.05, 20000, 0, 10);
    EXPECT_NEAR(c.house().peak_force, 20000, 1) << "nothing is left of the events before";
    EXPECT_NEAR(c.house().peak_impact_pressure, 20000, 1);
}

}  // namespace
}  // namespace talus::observe
