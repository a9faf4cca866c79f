#include "sim/physics/resistance.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "sim/physics/columns.hpp"
#include "sim/physics/stress.hpp"
#include "sim/physics/viscosity.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

using testing::block;
using testing::inclined_plane;
using testing::rectangle;
using testing::simulate;

constexpr float none = std::numeric_limits<float>::quiet_NaN();

Model model_of(const params::MaterialSpec& material, double spacing = 0.1) {
    return make_model(material, {}, spacing);
}

terrain::GroundSample<double> level() {
    return {0, {0, 0, 1}};
}

TEST(VoellmyDrag, is_that_of_the_thickness_of_the_flow) {
    params::MaterialSpec material;
    material.turbulent_friction = 200;
    const Model model = model_of(material);
    const auto ground = ground_resistance(model, Vec3<double>{});
    const double dt = 1e-4;
    const auto slower = slowed_by_drag(model, ground, level(), 0.4, 1.0, {3, 4, -1}, dt);
    const double deceleration = model.gravity * 25 / (200 * 1.0);
    EXPECT_NEAR((5 - std::hypot(slower.x, slower.y)) / dt, deceleration, 1e-3 * deceleration);
    EXPECT_NEAR(slower.x / slower.y, 0.75, 1e-9) << "against the motion";
    EXPECT_EQ(slower.z, -1) << "along the ground only";
}

TEST(VoellmyDrag, falls_with_the_cube_root_of_the_thickness_where_it_is_given_for_one) {
    params::MaterialSpec material;
    material.turbulent_friction = 200;
    const Model same = model_of(material);
    material.turbulent_friction_thickness = 0.15;
    const Model manning = model_of(material);
    const auto drag = [&](const Model& model, double thickness) {  // k v dt of v / (1 + k v dt)
        const auto ground = ground_resistance(model, Vec3<double>{});
        return 5 / slowed_by_drag(model, ground, level(), 0.05, thickness, {5, 0, 0}, 0.1).x - 1;
    };
    EXPECT_NEAR(drag(manning, 0.15) / drag(same, 0.15), 1, 2e-4);
    EXPECT_NEAR(drag(manning, 1.2) / drag(same, 1.2), 0.5, 2e-4) << "eight times as thick";
    EXPECT_NEAR(drag(manning, 0.01875) / drag(same, 0.01875), 2, 2e-4);
}

/// Speed after dv/dt = -(a v + b v^2), by many small steps of the midpoint rule.
double slowed_by_steps(double speed, double a, double b, double time) {
    constexpr int steps = 20000;
    const double dt = time / steps;
    for (int k = 0; k < steps; ++k) {
        const double middle = speed - dt / 2 * (a * speed + b * speed * speed);
        speed -= dt * (a * middle + b * middle * middle);
    }
    return speed;
}

TEST(LaminarDrag, is_that_of_the_thickness_of_the_flow) {
    params::MaterialSpec material;
    material.laminar_viscosity = 0.05;
    const Model model = model_of(material);
    ASSERT_TRUE(slows_by_speed(model));
    const auto ground = ground_resistance(model, Vec3<double>{});
    const double dt = 1e-5;
    const auto slower = slowed_by_drag(model, ground, level(), 0.4, 0.5, {3, 4, -1}, dt);
    EXPECT_NEAR((5 - std::hypot(slower.x, slower.y)) / dt, 3 * 0.05 * 5 / 0.25, 1e-3);
    EXPECT_EQ(slower.z, -1) << "along the ground only";
    EXPECT_EQ(slowed_by_drag(model, ground, level(), 0.61, 0.5, {5, 0, 0}, 0.1).x, 5) << "in the air above the flow";
}

TEST(LaminarDrag, follows_its_equation_over_a_step_beside_turbulent_drag) {
    params::MaterialSpec material;
    material.laminar_viscosity = 0.05;
    material.turbulent_friction = 300;
    const Model model = model_of(material);
    const auto ground = ground_resistance(model, Vec3<double>{});
    for (const double thickness : {0.1, 0.2, 0.5}) {
        const double a = 0.15 / (thickness * thickness), b = model.gravity / (300 * thickness);
        for (const double dt : {0.001, 0.01, 0.03}) {
            const double exact = slowed_by_steps(8, a, b, dt);
            EXPECT_NEAR(slowed_by_drag(model, ground, level(), 0.05, thickness, {8, 0, 0}, dt).x, exact, 2e-4 * exact);
        }
    }
}

TEST(LaminarDrag, never_reverses_the_motion_however_stiff_it_is) {
    params::MaterialSpec material;
    material.laminar_viscosity = 1e6;
    material.turbulent_friction = 1;
    const Model model = model_of(material);
    const auto ground = ground_resistance(model, Vec3<float>{});
    const terrain::GroundSample<float> flat{0, {0, 0, 1}};
    for (const float thickness : {0.0025F, 0.1F, 10.0F}) {
        const float left = slowed_by_drag(model, ground, flat, 0.0F, thickness, {1000, 0, 0}, 0.1F).x;
        EXPECT_GE(left, 0) << thickness;
        EXPECT_LT(left, 0.01F) << thickness;
    }
}

TEST(LaminarDrag, is_the_same_from_dynamic_and_kinematic_viscosity) {
    params::MaterialSpec material;
    material.rest_density = 1800;
    material.laminar_dynamic_viscosity = 90;
    EXPECT_DOUBLE_EQ(model_of(material).laws.laminar_viscosity, 0.05);
}

TEST(LaminarDrag, is_that_of_the_zone) {
    Model model = model_of({});
    Grid<terrain::CoverCell> cells(inclined_plane(0, 10, 10).elevation().geometry, {none, none, none, 0});
    model.cover = terrain::GroundCover(cells);
    EXPECT_FALSE(slows_by_speed(model));
    cells.at(5, 5).laminar_viscosity = 0.2F;
    model.cover = terrain::GroundCover(cells);
    ASSERT_TRUE(slows_by_speed(model));
    EXPECT_FLOAT_EQ(ground_resistance(model, Vec3<float>{0.5, 0.5, 0}).laminar_viscosity, 0.2F);
    EXPECT_EQ(ground_resistance(model, Vec3<float>{1.5, 0.5, 0}).laminar_viscosity, 0) << "as elsewhere";
}

TEST(FlowThickness, counts_scattered_particles_as_the_area_does) {
    // Particles at random: the mean over them of what a column holds is one particle of their own too high.
    std::uint64_t seed = 7;
    const auto random = [&] {
        seed = seed * 6364136223846793005U + 1442695040888963407U;
        return static_cast<double>(seed >> 33U) / 2147483648.0;
    };
    constexpr int columns = 60;
    for (const double mean : {0.5, 1.0, 2.0}) {
        std::vector<Vec3<float>> points(static_cast<std::size_t>(mean * columns * columns));
        for (auto& p : points) p = {static_cast<float>(columns * random()), static_cast<float>(columns * random()), 0};
        Grid<double> held(GridGeometry{0, 0, 1, columns + 2, columns + 2}, 0);
        const auto at = [&](std::int64_t column, std::int64_t row) -> double& {
            return held.at(static_cast<int>(column) + 1, static_cast<int>(row) + 1);
        };
        for (const auto& p : points) {
            for_each_column(p.x, p.y, 1, [&](auto column, auto row, float share) { at(column, row) += share; });
        }
        double counted = 0, plain = 0;
        int inside = 0;
        for (const auto& p : points) {
            if (p.x < 2 || p.x > columns - 2 || p.y < 2 || p.y > columns - 2) continue;
            double here = 0;
            for_each_column(p.x, p.y, 1, [&](auto column, auto row, float share) { here += share * at(column, row); });
            plain += here;
            counted += counted_by_area(here);
            ++inside;
        }
        EXPECT_NEAR(plain / inside, mean + 4.0 / 9, 0.08 * mean) << "with the particle itself";
        EXPECT_NEAR(counted / inside, mean, 0.16 * mean);
        EXPECT_GT(plain / inside - mean, 2 * (counted / inside - mean));
    }
    for (const double layers : {2, 3, 10}) EXPECT_DOUBLE_EQ(counted_by_area(4 * layers), 4 * layers) << "as it is";
}

TEST(CubeRoot, is_that_of_the_library_to_a_ten_thousandth) {
    for (double x = 0.0025; x < 400; x *= 1.07) EXPECT_NEAR(rough_cube_root(x) / std::cbrt(x), 1, 1e-4) << x;
}

TEST(VoellmyDrag, never_reverses_the_motion_and_leaves_what_flies_alone) {
    params::MaterialSpec material;
    material.turbulent_friction = 1;
    const Model model = model_of(material);
    const auto ground = ground_resistance(model, Vec3<double>{});
    const auto slower = slowed_by_drag(model, ground, level(), 0.05, 0.5, {1e4, 0, 0}, 10.0);
    EXPECT_GT(slower.x, 0);
    EXPECT_LT(slower.x, 1e-2);
    EXPECT_LT(slowed_by_drag(model, ground, level(), 1.09, 1.0, {5, 0, 0}, 0.1).x, 5) << "on top of the flow";
    EXPECT_EQ(slowed_by_drag(model, ground, level(), 1.11, 1.0, {5, 0, 0}, 0.1).x, 5) << "in the air above it";
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(slowed_by_drag(model, ground, level(), unknown, 1.0, {5, 0, 0}, 0.1).x, 5);
}

TEST(VoellmyDrag, thickness_is_volume_over_area_at_right_angles_to_the_ground) {
    const Model model = model_of({});
    const double slope = 0.5;
    const terrain::GroundSample<double> steep{0, {std::sin(slope), 0, std::cos(slope)}};
    // Three layers of a lattice of 0.1 m: four particles each in a column twice as wide.
    EXPECT_NEAR(flow_thickness(model, level(), 12.0), 0.3, 1e-9);
    EXPECT_NEAR(flow_thickness(model, steep, 12.0), 0.3 * std::cos(slope), 1e-9);
    EXPECT_NEAR(flow_thickness(model, level(), 0.1), 0.025, 1e-9) << "one alone is not thinner than this";
}

/// Speed after three seconds of the middle of a single layer, spread so far apart that no particle presses on another.
double speed_of_thin_layer(double start, double apart, const params::MaterialSpec& material, double slope) {
    constexpr double spacing = 0.1;
    constexpr int side = 24;
    const terrain::Terrain terrain = inclined_plane(slope * 180 / M_PI, 60, 8);
    Model model = make_model(material, {}, spacing);
    Ground ground(terrain);
    std::vector<LocalPoint> points, velocities;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const double x = 3 + apart * std::cos(slope) * i, y = 2.4 + apart * j;
            const double z = 200 - std::tan(slope) * x + model.contact_distance() / std::cos(slope);
            points.push_back(terrain.frame().to_local({x, y, z}));
            velocities.push_back(
                {static_cast<float>(start * std::cos(slope)), 0, static_cast<float>(-start * std::sin(slope))});
        }
    }
    Simulation simulation(std::move(model), std::move(ground), testing::state_of(points, velocities));
    while (simulation.state().time < 3) EXPECT_TRUE(simulation.advance());
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

TEST(VoellmyDrag, holds_for_debris_that_is_thinner_than_a_particle) {
    constexpr double apart = 0.14, slope = M_PI / 6;
    params::MaterialSpec material;
    material.friction_coefficient = 0.2;
    material.turbulent_friction = 150;
    material.viscosity = 0;
    // Particles of 0.1 m in a lattice: none stands where there are more than elsewhere, as scattered ones do.
    const double in_column = 0.04 / (apart * apart), thickness = counted_by_area(in_column) * 0.001 / 0.04;  // 1, m
    EXPECT_NEAR(thickness, 0.001 / (apart * apart), 0.18 * 0.001 / (apart * apart));
    const double law = std::sqrt(150 * thickness * (std::sin(slope) - 0.2 * std::cos(slope)));
    EXPECT_NEAR(speed_of_thin_layer(0.7 * law, apart, material, slope), law, 0.06 * law);
    EXPECT_NEAR(speed_of_thin_layer(1.3 * law, apart, material, slope), law, 0.06 * law);
}

TEST(VoellmyDrag, leaves_what_walls_take_out_of_the_area_of_a_column) {
    const terrain::Terrain terrain = inclined_plane(0, 20, 20);
    std::vector<terrain::Building> walls(1);
    walls[0].footprint = {rectangle(10, 2, 18, 18)};
    walls[0].height = 5;
    place_buildings(terrain, walls);
    const Model model = make_model({}, {}, 0.5);
    const Ground ground(terrain, walls, model.support_radius);
    const auto open_at = [&](double x) {
        const LocalPoint p = terrain.frame().to_local({x, 10, 200.25});
        return open_share(model, ground, Vec3<double>{p.x, p.y, p.z}, terrain::largest_grain);
    };
    EXPECT_NEAR(open_at(10), 0.5, 1e-4) << "on the wall half of a column is beyond it";
    EXPECT_NEAR(open_at(9), 1 - 1.0 / 24, 1e-4) << "a column's width, two spacings, away";
    EXPECT_EQ(open_at(7), 1);
    for (double x = 9; x < 10; x += 0.1) EXPECT_GT(open_at(x), open_at(x + 0.05));
}

TEST(InertialFriction, limits_what_rough_ground_holds) {
    params::MaterialSpec material;
    material.internal_friction_coefficient = 0.4;
    material.inertial_friction_coefficient = 0.7;
    material.inertial_number = 0.3;
    material.grain_diameter = 0.02;
    material.grain_density = material.rest_density;
    const Model model = model_of(material);
    // Sheared at 20 per second under a pressure that makes the inertial number 0.3: half way up.
    const double distance = 0.05, speed = 20 * distance, root = 20 * 0.02 / 0.3;
    EXPECT_NEAR(friction_beside_ground(model, 5.0, speed, distance, root * root), 0.55, 1e-9);
    EXPECT_NEAR(friction_beside_ground(model, 5.0, 0.0, distance, root * root), 0.4, 1e-9) << "slowly";
    EXPECT_EQ(friction_beside_ground(model, 0.3, speed, distance, root * root), 0.3) << "smooth ground is slid on";
    EXPECT_EQ(friction_beside_ground(model_of({}), 5.0, speed, distance, 1.0), 5) << "without the law";
    EXPECT_EQ(shear_beside_ground(model, 0.3), 0) << "smooth ground shears nothing";

    // Beside the ground the lattice sees half of an even shear; the ground makes up for what is missing.
    DisplacementGradient<double> beside;
    const double slope = model.boundary.at(distance).slope;
    for (int i = -3; i <= 3; ++i) {
        for (int j = -3; j <= 3; ++j) {
            for (int k = 1; k <= 3; ++k) {
                const Vec3<double> apart{0.1 * i, 0.1 * j, 0.1 * k};
                const double q = length(apart) / model.support_radius, r = model.support_radius;
                if (q >= 1) continue;
                const double scale = kernels::WendlandC2::slope_over_q(q) * model.kernel.particle_volume;
                beside.add({0.1 * k, 0, 0}, apart * (scale / (r * r * r * r * r)));
            }
        }
    }
    EXPECT_NEAR(beside.x.z, model.kernel.gradient_moment / 2, 1e-6);
    add_ground_shear(beside, {distance, 0, 0}, {0, 0, 1}, slope, shear_beside_ground(model, 5.0));
    EXPECT_NEAR(beside.x.z, model.kernel.gradient_moment, 1e-4);
}

TEST(ForestDrag, is_that_of_cylinders_across_the_flow) {
    Model model = model_of({});
    Grid<terrain::CoverCell> cells(inclined_plane(0, 10, 10).elevation().geometry, {none, none, none, 0});
    cells.at(5, 5).stem_drag = 0.5F * 1.2F * 0.08F * 0.3F;  // C_D n D / 2
    model.cover = terrain::GroundCover(cells);
    ASSERT_TRUE(slows_by_speed(model));
    const double dt = 1e-4;
    const auto among =
        slowed_by_drag(model, ground_resistance(model, Vec3<double>{0.5, 0.5, 0}), level(), 0.4, 1.0, {6, 0, 0}, dt);
    EXPECT_NEAR((6 - among.x) / dt, 0.5 * 1.2 * 0.08 * 0.3 * 36, 1e-3);
    const auto beside =
        slowed_by_drag(model, ground_resistance(model, Vec3<double>{1.5, 0.5, 0}), level(), 0.4, 1.0, {6, 0, 0}, dt);
    EXPECT_EQ(beside.x, 6);
}

TEST(PorePressure, is_that_of_the_release_and_decays_from_its_start) {
    params::MaterialSpec material;
    material.pore_pressure_ratio = 0.5;
    material.pore_pressure_decay_time = 4;
    Model model = model_of(material);
    model.releases = {{"early", 0, 0, 10, {}}, {"late", 2, 10, 20, 0.8}};
    const std::vector<Entry> released;
    EXPECT_DOUBLE_EQ(effective_share(model, released, 3, 0), 0.5);
    EXPECT_NEAR(effective_share(model, released, 3, 4), 1 - 0.5 * std::exp(-1), 1e-12);
    EXPECT_DOUBLE_EQ(effective_share(model, released, 12, 1), 1 - 0.8) << "not before it starts";
    EXPECT_NEAR(effective_share(model, released, 12, 6), 1 - 0.8 * std::exp(-1), 1e-12);
    model.pore_pressure_decay_time = 0;
    EXPECT_DOUBLE_EQ(effective_share(model, released, 12, 100), 1 - 0.8);
    model.pore_pressure_ratio = 0;
    EXPECT_TRUE(has_pore_pressure(model)) << "of one release";
    model.releases[1].pore_pressure_ratio = 0;
    EXPECT_FALSE(resists_by_particle(model));
}

TEST(PorePressure, of_what_comes_in_or_is_entrained_decays_from_then) {
    params::MaterialSpec material;
    material.pore_pressure_ratio = 0.5;
    material.pore_pressure_decay_time = 4;
    const Model model = model_of(material);
    const std::vector<Entry> entries{{}, {60, -1}, {60, 0.2F}};
    EXPECT_DOUBLE_EQ(effective_share(model, entries, 1, 60), 0.5);
    EXPECT_NEAR(effective_share(model, entries, 1, 64), 1 - 0.5 * std::exp(-1), 1e-12);
    EXPECT_NEAR(effective_share(model, entries, 2, 64), 1 - 0.2 * std::exp(-1), 1e-8) << "with a ratio of its own";
}

/// How far the middle of a block 1 m thick has slid after a second.
double slid(const params::MaterialSpec& material, double degrees) {
    const terrain::Terrain terrain = inclined_plane(degrees, 60, 30);
    Simulation simulation = simulate(material, {}, terrain, {block(terrain, rectangle(10, 10, 20, 20), 1)}, 0.25);
    const auto middle = [&] {
        double sum = 0;
        for (std::uint32_t i = 0; i < simulation.state().count; ++i) sum += simulation.state().position.x[i];
        return sum / simulation.state().count;
    };
    const double before = middle();
    while (simulation.state().time < 1) EXPECT_TRUE(simulation.advance());
    return (middle() - before) / std::cos(degrees * M_PI / 180);
}

TEST(PorePressure, sets_debris_going_that_dry_friction_would_hold) {
    params::MaterialSpec material;
    material.friction_coefficient = 0.6;
    EXPECT_LT(slid(material, 20), 0.1) << "its edges fall over";
    material.pore_pressure_ratio = 0.7;  // 0.18 of friction is left; tan 20 is 0.36
    const double acceleration = 9.80665 * (std::sin(M_PI / 9) - 0.18 * std::cos(M_PI / 9));
    EXPECT_NEAR(slid(material, 20), acceleration / 2, 0.15 * acceleration / 2);
}

TEST(Cohesion, holds_a_slab_up_to_its_strength) {
    // A sheet 1 m thick pulls with rho g h sin(20) = 6.7 kPa.
    params::MaterialSpec material;
    material.friction_coefficient = 0;
    material.cohesion = 9000;
    EXPECT_LT(slid(material, 20), 0.1);
    material.cohesion = 3000;
    const double acceleration = 9.80665 * std::sin(M_PI / 9) - 3000.0 / 2000 / 1;
    EXPECT_NEAR(slid(material, 20), acceleration / 2, 0.15 * acceleration / 2);
}

TEST(InertialFriction, rises_from_slow_to_fast_shear) {
    // Simple shear of rate 5 /s under a pressure of 0.5 m2/s2 (over density), in a step of 0.01 s.
    const double dt = 0.01, grain = 0.02, pressure = 0.5;
    const Deviator<double> shear{0, 0, 0, 5 * dt / 2, 0};
    const double number = 5 * grain / std::sqrt(pressure);
    EXPECT_NEAR(inertial_friction(0.4, 0.3, 0.25, grain, shear, pressure * dt * dt), 0.4 + 0.3 / (0.25 / number + 1),
                1e-12);
    EXPECT_EQ(inertial_friction(0.4, 0.3, 0.25, grain, {}, pressure), 0.4);
    EXPECT_NEAR(inertial_friction(0.4, 0.3, 0.25, grain, shear, 0.0), 0.7, 1e-12) << "without pressure: fast";
}

TEST(ViscosityOnGround, stops_a_linear_profile_on_the_surface) {
    params::MaterialSpec material;
    material.viscosity_on_ground = true;
    const Model model = model_of(material);
    // Far from the ground there is none of it; at the ground the whole half-space takes part.
    EXPECT_EQ(model.boundary.sticking_at(model.support_radius), 0);
    EXPECT_GT(model.boundary.sticking_at(0.5 * model.particle_spacing), model.boundary.at(0.05).density);
    const auto slower = slowed_by_ground(model, level(), 0.05, {1, 0, -2}, 1e9);
    EXPECT_GE(slower.x, 0);
    EXPECT_LT(slower.x, 1e-6);
    EXPECT_EQ(slower.z, -2);
}

/// Sum over a rest lattice of what `term` makes of an offset in spacings and of q.
template <class Term>
double lattice_sum(const Model& model, const Term& term) {
    const double ratio = model.support_radius / model.particle_spacing;
    double sum = 0;
    for (int i = -3; i <= 3; ++i) {
        for (int j = -3; j <= 3; ++j) {
            for (int k = -3; k <= 3; ++k) {
                const double q = std::sqrt(double(i * i + j * j + k * k)) / ratio;
                if (q < 1) sum += term(k, q);
            }
        }
    }
    return sum * model.kernel.particle_volume / std::pow(model.support_radius, 3);
}

TEST(ViscosityOnGround, takes_from_even_shear_what_viscosity_passes_on_inside) {
    params::MaterialSpec material;
    material.viscosity_on_ground = true;
    const Model model = model_of(material);
    const double spacing = model.particle_spacing;
    // Through a plane between two layers go m pairs of layers m apart, whose velocities differ by m times the shear.
    const double passed_on = lattice_sum(model, [&](int layers, double q) {
        return layers > 0 ? layers * layers * spacing * kernels::WendlandC2::value(q) : 0;
    });
    double taken = 0;
    for (double d = spacing / 2; d < model.support_radius; d += spacing) taken += d * model.boundary.sticking_at(d);
    EXPECT_NEAR(taken, passed_on, 1e-3 * passed_on);
}

TEST(Cohesion, inside_makes_up_for_what_sums_over_neighbours_do_not_pass_on) {
    params::MaterialSpec material;
    material.cohesion = 800;
    const Model model = model_of(material);
    const double ratio = model.support_radius / model.particle_spacing;
    const double passed_on = lattice_sum(model, [&](int layers, double q) {
        return layers * layers / (ratio * ratio) * kernels::WendlandC2::slope_over_q(q);
    });
    EXPECT_GT(passed_on, 0.9);
    EXPECT_LT(passed_on, 1);
    const double dt = 0.01;
    EXPECT_NEAR(internal_strength(model, dt) * passed_on, 800 * dt * dt / model.rest_density, 1e-12);
}

TEST(RoughZone, stops_debris_that_runs_elsewhere) {
    const terrain::Terrain terrain = inclined_plane(20, 60, 40);
    params::MaterialSpec material;
    material.friction_coefficient = 0.1;
    material.internal_friction_coefficient = 0.6;
    Model model = make_model(material, {}, 0.25);
    Ground ground(terrain);
    Grid<terrain::CoverCell> cells(terrain.elevation().geometry, {none, none, none, 0});
    for (int row = 0; row < 20; ++row) {
        for (int column = 0; column < 60; ++column) cells.at(column, row).friction_coefficient = 0.8F;
    }
    model.cover = terrain::GroundCover(cells);
    auto seeded = seed_releases(
        model, ground,
        {block(terrain, rectangle(10, 6, 16, 14), 0.75), block(terrain, rectangle(10, 26, 16, 34), 0.75)});
    ASSERT_TRUE(seeded);
    Simulation simulation(std::move(model), std::move(ground), *std::move(seeded));
    while (simulation.state().time < 2) ASSERT_TRUE(simulation.advance());
    double rough = 0, smooth = 1e9;
    int in_rough = 0;
    for (std::uint32_t i = 0; i < simulation.state().count; ++i) {
        const float speed = length(simulation.state().velocity.at(i));
        if (simulation.state().position.y[i] < 0) {
            rough += speed;
            ++in_rough;
        } else {
            smooth = std::min<double>(smooth, speed);
        }
    }
    ASSERT_GT(in_rough, 100);
    EXPECT_LT(rough / in_rough, 0.1);
    EXPECT_GT(smooth, 2);
}

}  // namespace
}  // namespace talus::sim
