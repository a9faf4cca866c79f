#include "sim/physics/samosat.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "sim/physics/resistance.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

using testing::inclined_plane;

/// With the constants of com1DFA, and its mu.
params::MaterialSpec loose_snow() {
    params::MaterialSpec material;
    material.samosat = true;
    material.friction_coefficient = 0.155;
    material.rest_density = 200;
    return material;
}

TEST(Samosat, logarithm_is_that_of_the_library) {
    for (double x = 1; x < 1e4; x *= 1.07) EXPECT_NEAR(natural_log(x), std::log(x), 1e-5) << x;
    for (double x = 1e4; x < 1e7; x *= 1.3) EXPECT_NEAR(natural_log(x), std::log(x), 1e-3) << x;
    EXPECT_EQ(natural_log(1.0F), 0);
}

TEST(Samosat, has_the_stress_worked_out_by_hand) {
    // h = 1 m, v = 20 m/s, 30 degrees: ln 20 = 2.995732, over 0.43 and with 4.13 11.09682, whose square is 123.1394.
    const Samosat law = samosat_of(loose_snow());
    ASSERT_TRUE(law.on);
    EXPECT_NEAR(wall_drag(law, 1.0), 1 / 123.1394, 1e-8);
    // sigma = 200 x 9.80665 x cos 30 = 1698.561 Pa, R_s = 200 x 400 / 1698.561 = 47.09869.
    const double sigma = 1698.561;
    EXPECT_NEAR(slow_share(law.fluidization, sigma / 200, 400.0), 0.222 / 47.32069, 1e-7);
    const double stress =
        0.155 * (1 + slow_share(law.fluidization, sigma / 200, 400.0)) * sigma + 200 * 400 * wall_drag(law, 1.0);
    EXPECT_NEAR(stress, 914.18, 0.01) << "Pa";
    // 2 m/s under 0.1 m: R_s = 4.7099, ln 2 = 0.693147, 5.741970 squared 32.97022.
    EXPECT_NEAR(slow_share(law.fluidization, sigma / 2000, 4.0), 0.222 / 4.931869, 1e-6);
    EXPECT_NEAR(wall_drag(law, 0.1), 1 / 32.97022, 1e-7);
}

TEST(Samosat, is_finite_for_thin_slow_and_weightless_debris) {
    const Samosat law = samosat_of(loose_snow());
    for (const double thickness : {0.05, 0.049, 1e-6, 0.0}) {
        EXPECT_DOUBLE_EQ(wall_drag(law, thickness), 1 / (4.13 * 4.13)) << thickness << ": no thinner than R";
    }
    EXPECT_EQ(slow_share(0.222F, 1.0F, 0.0F), 1) << "at rest";
    EXPECT_EQ(slow_share(0.222F, 0.0F, 0.0F), 0);
    EXPECT_EQ(slow_share(0.222F, -1.0F, 4.0F), 0) << "nothing presses";
    EXPECT_EQ(slow_share(0.222F, 0.0F, 1e6F), 0);
    EXPECT_EQ(slow_share(0.0F, 1.0F, 0.0F), 0) << "without that part of the law";
    EXPECT_LT(slow_share(0.222F, 1.0F, 1e30F), 1e-20F);
    EXPECT_FALSE(samosat_of({}).on);
}

TEST(Samosat, slows_the_flow_by_its_thickness_and_never_reverses_it) {
    const Model model = make_model(loose_snow(), {}, 0.1);
    ASSERT_TRUE(slows_by_speed(model));
    ASSERT_TRUE(resists_by_particle(model));
    const auto ground = ground_resistance(model, Vec3<double>{});
    const terrain::GroundSample<double> level{0, {0, 0, 1}};
    const double dt = 1e-5;
    const auto slower = slowed_by_drag(model, ground, level, 0.4, 1.0, {12, 16, -1}, dt);
    EXPECT_NEAR((20 - std::hypot(slower.x, slower.y)) / dt, 400 / 123.1394, 1e-3);
    EXPECT_EQ(slower.z, -1) << "along the ground only";
    EXPECT_EQ(slowed_by_drag(model, ground, level, 1.11, 1.0, {5, 0, 0}, 0.1).x, 5) << "in the air above the flow";
    for (const double thickness : {1e-9, 0.025, 1.0}) {
        const double left = slowed_by_drag(model, ground, level, 0.0, thickness, {1000, 0, 0}, 1.0).x;
        EXPECT_GE(left, 0) << thickness;
        EXPECT_LT(left, 110) << thickness;
        EXPECT_EQ(slowed_by_drag(model, ground, level, 0.0, thickness, {0, 0, 0}, 1.0).x, 0) << thickness;
    }
}

TEST(Samosat, doubles_friction_at_rest_and_loses_that_with_speed) {
    const Model model = make_model(loose_snow(), {}, 0.1);
    const terrain::Terrain level = inclined_plane(0, 10, 10);
    const double dt = 0.01, fall = model.gravity * dt;
    const Vec3<double> touching{0, 0, level.sample(0.0, 0.0).height + 0.05};
    const auto friction = [&](double speed, double pressure) {
        return moving_friction(model, level, 0.155, touching, {speed, 0, -fall}, pressure, 1.0, dt);
    };
    EXPECT_NEAR(friction(0, 5), 0.31, 1e-12);
    // Stress over density 2 + 9.80665 x 0.05 = 2.490333, R_s = 0.401553: 1 + 0.222 / 0.623553.
    EXPECT_NEAR(friction(1, 2), 0.155 * 1.356024, 1e-6);
    EXPECT_NEAR(friction(1, 0), 0.155 * (1 + 0.222 / (0.222 + 1 / 0.980665)), 1e-6) << "at least its own weight";
    EXPECT_NEAR(friction(100, 2), 0.155, 1e-4);
    EXPECT_EQ(moving_friction(make_model({}, {}, 0.1), level, 0.4, touching, {1, 0, 0}, 2.0, 1.0, dt), 0.4)
        << "without the law";
    // Gravity of the step is no motion: on a slope as well, debris at rest has all of it.
    const terrain::Terrain slope = inclined_plane(20, 40, 10);
    EXPECT_NEAR(
        moving_friction(model, slope, 0.155, {0, 0, slope.sample(0.0, 0.0).height + 0.05}, {0, 0, -fall}, 0.0, 1.0, dt),
        0.31, 1e-9);
}

TEST(Samosat, gives_debris_inside_the_friction_of_the_ground_at_rest_unless_the_scene_has_another) {
    params::MaterialSpec material = loose_snow();
    EXPECT_DOUBLE_EQ(make_model(material, {}, 0.1).internal_friction_coefficient, 0.31);
    EXPECT_DOUBLE_EQ(make_model(material, {}, 0.1).building_friction_coefficient, 0.155);
    material.samosat_fluidization = 0;
    EXPECT_DOUBLE_EQ(make_model(material, {}, 0.1).internal_friction_coefficient, 0.155);
    material.internal_friction_coefficient = 0.6;
    EXPECT_DOUBLE_EQ(make_model(material, {}, 0.1).internal_friction_coefficient, 0.6);
}

constexpr double apart = 0.14, spacing_of_sheet = 0.1;

/// Speed after some seconds of the middle of a single layer of particles, so far apart that none presses on another.
double speed_of_layer(double start, double tangent, double time) {
    constexpr int side = 20;
    const double slope = std::atan(tangent);
    const terrain::Terrain terrain = inclined_plane(slope * 180 / M_PI, 60, 8);
    params::MaterialSpec material = loose_snow();
    material.viscosity = 0;
    Model model = make_model(material, {}, spacing_of_sheet);
    Ground ground(terrain);
    std::vector<LocalPoint> points, velocities;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const double x = 3 + apart * std::cos(slope) * i, y = 2.4 + apart * j;
            const double z = 200 - tangent * x + model.contact_distance() / std::cos(slope);
            points.push_back(terrain.frame().to_local({x, y, z}));
            velocities.push_back(
                {static_cast<float>(start * std::cos(slope)), 0, static_cast<float>(-start * std::sin(slope))});
        }
    }
    Simulation simulation(std::move(model), std::move(ground), testing::state_of(points, velocities));
    while (simulation.state().time < time) EXPECT_TRUE(simulation.advance());
    double sum = 0;
    int inside = 0;
    const State& state = simulation.state();
    for (std::uint32_t k = 0; k < state.count; ++k) {
        const std::uint32_t i = state.id[k] / side, j = state.id[k] % side;
        if (i < side / 3 || i >= 2 * side / 3 || j < side / 3 || j >= 2 * side / 3) continue;
        sum += std::hypot(state.velocity.x[k], state.velocity.z[k]);
        ++inside;
    }
    return sum / inside;
}

TEST(Samosat, holds_debris_on_a_slope_on_which_it_would_slide_on) {
    EXPECT_LT(speed_of_layer(0, 0.29, 0.5), 1e-3) << "below 2 mu";
    EXPECT_LT(speed_of_layer(0.1, 0.29, 1.5), 1e-3) << "slow debris stops";
    EXPECT_GT(speed_of_layer(0, 0.34, 1), 0.1) << "above 2 mu";
}

TEST(Samosat, gives_debris_its_terminal_velocity_from_above_and_from_below) {
    const double tangent = 0.5, cosine = 1 / std::sqrt(1.25), gravity = ModelValues{}.gravity;
    // Particles in a lattice: none stands where there are more than elsewhere, as scattered ones do.
    const double in_column = 0.04 / (apart * apart), thickness = counted_by_area(in_column) * 0.001 / 0.04;
    const Samosat law = samosat_of(loose_snow());
    // g (tan - mu (1 + slow_share)) cos = drag v^2 / h, where the drag is the smaller, the slower.
    double law_speed = 0;
    for (int k = 0; k < 50; ++k) {
        const double share = slow_share(law.fluidization, gravity * cosine * spacing_of_sheet, law_speed * law_speed);
        const double left = gravity * cosine * (tangent - 0.155 * (1 + share));
        law_speed = std::sqrt(left * thickness / wall_drag(law, thickness));
    }
    EXPECT_NEAR(speed_of_layer(0.8 * law_speed, tangent, 1.5), law_speed, 0.06 * law_speed);
    EXPECT_NEAR(speed_of_layer(1.2 * law_speed, tangent, 1.5), law_speed, 0.06 * law_speed);
}

}  // namespace
}  // namespace talus::sim
