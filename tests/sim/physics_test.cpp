#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "sim/fault.hpp"
#include "sim/physics/contact.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

using testing::block;
using testing::inclined_plane;
using testing::rectangle;
using testing::simulate;

TEST(MechanicalEnergy, never_grows_on_rough_ground) {
    const terrain::Terrain terrain = testing::terrain_of(80, 40, 1, [](double x, double y) {
        return 60 - 0.6 * x + 0.5 * std::sin(0.9 * x) * std::cos(0.7 * y) + 0.02 * (y - 20) * (y - 20);
    });
    terrain::Building house;
    house.footprint = {rectangle(40, 17, 46, 23)};
    house.height = 4;
    Simulation simulation = simulate({}, {}, terrain, {block(terrain, rectangle(6, 14, 16, 26), 1.2)}, 0.5, {house});
    const auto energy = [&] {
        return kinetic_energy(simulation.model(), simulation.state()) +
               potential_energy(simulation.model(), simulation.state());
    };
    const double drop = energy();  // above the lowest ground: what there is to lose
    double previous = drop, least = drop;
    while (simulation.state().time < 6 && simulation.state().outflow == 0) {
        ASSERT_TRUE(simulation.advance());
        const double now = energy();
        EXPECT_LT(now - previous, 2e-5 * drop) << "in one step, at t = " << simulation.state().time;
        EXPECT_LT(now - least, 2e-4 * drop) << "since the least so far, at t = " << simulation.state().time;
        previous = now;
        least = std::min(least, now);
    }
    EXPECT_LT(previous, 0.9 * drop) << "nothing moved: the test would show nothing";
}

TEST(Boundaries, particles_thrown_at_100_mps_never_get_through) {
    const terrain::Terrain terrain = testing::terrain_of(60, 60, 2, [](double x, double y) {
        return 20 + 12 * std::sin(0.15 * x) * std::sin(0.13 * y) + (x > 70 && x < 74 ? 15 : 0);
    });
    terrain::Building wall, house;
    wall.footprint = {rectangle(50, 30, 50.4, 90)};
    wall.height = 40;
    house.footprint = {rectangle(80, 50, 90, 60)};
    house.height = 12;
    std::vector<terrain::Building> buildings{wall, house};
    place_buildings(terrain, buildings);
    for (const double time_step : {1.0 / 20, 1.0 / 60, 1.0 / 240}) {
        params::SolverSpec solver;
        solver.time_step = time_step;
        Model model = make_model({}, solver, 0.5);
        Ground ground(terrain, buildings, model.support_radius);
        auto points = testing::random_points(3000, {-50, -50, 0}, {50, 50, 45}, 11);
        std::erase_if(points, [&](const LocalPoint& p) { return !is_free(ground, p); });
        auto velocities = testing::random_points(points.size(), {-1, -1, -1}, {1, 1, 1}, 12);
        for (LocalPoint& v : velocities) v = v * (100 / (length(v) + 1e-6F));
        Simulation simulation(model, ground, testing::state_of(points, velocities));
        for (int i = 0; i < 40; ++i) {
            EXPECT_TRUE(simulation.advance());
            const State& state = simulation.state();
            for (std::uint32_t k = 0; k < state.count; ++k) {
                ASSERT_TRUE(is_free(ground, state.position.at(k)))
                    << "particle " << state.id[k] << " in step " << i << " of " << time_step << " s";
            }
        }
        EXPECT_EQ(simulation.state().count + simulation.state().outflow, simulation.state().seeded);
    }
}

TEST(Boundaries, a_thin_wall_holds_what_is_thrown_at_it) {
    const terrain::Terrain terrain = testing::terrain_of(40, 40, 1, [](double, double) { return 0; });
    terrain::Building wall;
    wall.footprint = {rectangle(20, 0, 20.2, 40)};
    wall.height = 30;
    std::vector<terrain::Building> buildings{wall};
    place_buildings(terrain, buildings);
    params::SolverSpec solver;
    solver.time_step = 1.0 / 30;
    Model model = make_model({}, solver, 0.4);
    Ground ground(terrain, buildings, model.support_radius);
    const auto points = testing::random_points(200, {-10, -10, 1}, {-5, 10, 10}, 13);
    Simulation simulation(model, ground,
                          testing::state_of(points, std::vector<LocalPoint>(points.size(), {100, 3, 0})));
    for (int i = 0; i < 30; ++i) {
        EXPECT_TRUE(simulation.advance());
        for (std::uint32_t k = 0; k < simulation.state().count; ++k) {
            ASSERT_LT(simulation.state().position.x[k], 0.01) << "behind the wall";
        }
    }
    EXPECT_FALSE(simulation.state().building_contacts.empty());
}

TEST(Boundaries, an_impulse_tells_the_speed_of_what_hit_the_wall) {
    const terrain::Terrain terrain = testing::terrain_of(40, 40, 1, [](double, double) { return 0; });
    terrain::Building wall;
    wall.footprint = {rectangle(20, 0, 22, 40)};
    wall.height = 30;
    std::vector<terrain::Building> buildings{wall};
    place_buildings(terrain, buildings);
    params::MaterialSpec material;
    material.building_friction_coefficient = 0;
    const Model model = make_model(material, {}, 0.4);
    Simulation simulation(model, Ground(terrain, buildings, model.support_radius),
                          testing::state_of({{-2, 0, 10}}, {{12, 5, 0}}));
    double speed = 0, impulse = 0;
    while (simulation.state().time < 0.5) {
        ASSERT_TRUE(simulation.advance());
        for (const BuildingContact& contact : simulation.state().building_contacts) {
            speed = std::max(speed, double(contact.speed));
            impulse += contact.impulse;
        }
    }
    EXPECT_NEAR(speed, 13.1, 0.1) << "13 m/s, and what it has fallen";
    EXPECT_NEAR(impulse / model.particle_mass(), 12, 0.01);
}

/// Four buildings around a square pit in the middle of level ground, `width` m wide.
std::vector<terrain::Building> pit(const terrain::Terrain& terrain, double width) {
    const double a = 10 - width / 2, b = 10 + width / 2;
    std::vector<terrain::Building> buildings(4);
    const Polygon walls[] = {rectangle(0, 0, a, 20), rectangle(b, 0, 20, 20), rectangle(0, 0, 20, a),
                             rectangle(0, b, 20, 20)};
    for (std::size_t k = 0; k < buildings.size(); ++k) {
        buildings[k].footprint = {walls[k]};
        buildings[k].height = 20;
    }
    place_buildings(terrain, buildings);
    return buildings;
}

/// A rest lattice around the origin: `n` by `n` columns of `layers` particles.
std::vector<LocalPoint> lattice(int n, int layers, float spacing) {
    std::vector<LocalPoint> points;
    const float first = (1 - static_cast<float>(n)) / 2 * spacing;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            for (int k = 0; k < layers; ++k) {
                points.push_back({first + static_cast<float>(i) * spacing, first + static_cast<float>(j) * spacing,
                                  (static_cast<float>(k) + 0.5F) * spacing});
            }
        }
    }
    return points;
}

TEST(Boundaries, both_walls_of_a_corner_bear_what_stands_in_it) {
    // Water in a pit: where the nearest wall only is seen, particles in the corners pack 15 % closer.
    const terrain::Terrain terrain = testing::terrain_of(20, 20, 1, [](double, double) { return 0; });
    const std::vector<terrain::Building> buildings = pit(terrain, 4);
    params::MaterialSpec water;
    water.friction_coefficient = 0;
    const Model model = make_model(water, {}, 0.5);
    Simulation simulation(model, Ground(terrain, buildings, model.support_radius),
                          testing::state_of(lattice(8, 10, 0.5F)));
    double height = 0;
    while (simulation.state().time < 4) ASSERT_TRUE(simulation.advance());
    const State& state = simulation.state();
    for (std::uint32_t i = 0; i < state.count; ++i) height += state.position.z[i] / double(state.count);
    EXPECT_LT(state.max_compression, 0.03);
    EXPECT_NEAR(height, 2.5, 0.05);
    std::vector<int> touched(buildings.size());
    std::vector<int> walls_of(state.count);
    for (const BuildingContact& contact : state.building_contacts) {
        ++touched[static_cast<std::size_t>(contact.building)];
        ++walls_of[contact.particle];
    }
    EXPECT_GT(*std::min_element(touched.begin(), touched.end()), 60);
    EXPECT_GE(std::count(walls_of.begin(), walls_of.end(), 2), 20) << "a particle presses on one wall only";
}

TEST(Boundaries, walls_rub_with_their_own_friction_where_it_is_set_apart) {
    const terrain::Terrain terrain = testing::terrain_of(20, 20, 1, [](double, double) { return 0; });
    terrain::Building wall;
    wall.footprint = {rectangle(12, 0, 14, 20)};  // its face at local x = 2
    wall.height = 10;
    std::vector<terrain::Building> buildings{wall};
    place_buildings(terrain, buildings);
    // A particle 0.01 m clear of touching the wall wants 0.03 m towards it and 0.05 m along it: a push of 0.02 m.
    const auto moved_along = [&](std::optional<double> building_friction) {
        params::MaterialSpec material;
        material.friction_coefficient = 0.6;
        material.building_friction_coefficient = building_friction;
        const Model model = make_model(material, {}, 0.4);
        const Ground ground(terrain, buildings, model.support_radius);
        ContactMemories<double> contacts;
        const Vec3<double> end =
            resolve_contacts<double>(model, sample_boundary<double>(model, ground, {1.79, 0, 5}), {}, {0.03, 0.05, 0},
                                     0, uniform_grip<double>(model), contacts);
        EXPECT_NEAR(contacts[1].normal, 0.02, 1e-6);
        EXPECT_NEAR(end.x, 0.01, 1e-6);
        return end.y;
    };
    EXPECT_NEAR(moved_along(0), 0.05, 1e-6);
    EXPECT_NEAR(moved_along(0.25), 0.05 - 0.25 * 0.02, 1e-6);
    EXPECT_NEAR(moved_along(std::nullopt), 0.05 - 0.6 * 0.02, 1e-6) << "equal to the ground's unless set apart";
}

TEST(Step, is_shortened_while_debris_is_deeper_than_pressure_can_follow) {
    // 60 layers in a pit that begin without any pressure fall into themselves, particle on particle, if let.
    const terrain::Terrain terrain = testing::terrain_of(20, 20, 1, [](double, double) { return 0; });
    params::MaterialSpec water;
    water.friction_coefficient = 0;
    const Model model = make_model(water, {}, 0.25);
    Simulation simulation(model, Ground(terrain, pit(terrain, 1), model.support_radius),
                          testing::state_of(lattice(4, 60, 0.25F)));
    double shortest = 1, worst = 0;
    while (simulation.state().time < 1) {
        ASSERT_TRUE(simulation.advance());
        shortest = std::min(shortest, simulation.state().time_step);
        worst = std::max(worst, simulation.state().mean_compression);
    }
    EXPECT_LT(shortest, 1.0 / 200);
    EXPECT_LT(worst, 0.06);
    EXPECT_LT(simulation.state().mean_compression, 0.01);
}

TEST(MassBalance, counts_what_leaves_the_terrain) {
    const terrain::Terrain terrain = inclined_plane(40, 24, 24);
    params::MaterialSpec material;
    material.friction_coefficient = 0.1;
    Simulation simulation = simulate(material, {}, terrain, {block(terrain, rectangle(12, 9, 18, 15), 1)}, 0.5);
    const std::uint32_t seeded = simulation.state().seeded;
    while (simulation.state().count > 0 && simulation.state().time < 10) {
        const Status stepped = simulation.advance();
        ASSERT_TRUE(stepped) << stepped.error().message;
        ASSERT_EQ(simulation.state().count + simulation.state().outflow, seeded);
    }
    EXPECT_EQ(simulation.state().outflow, seeded);
}

std::uint64_t hash_on_threads(int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute([] {
        const terrain::Terrain terrain = testing::terrain_of(
            60, 40, 1, [](double x, double y) { return 40 - 0.5 * x + 0.01 * (y - 20) * (y - 20); });
        Simulation simulation = simulate({}, {}, terrain, {block(terrain, rectangle(6, 12, 20, 28), 1.2)}, 0.45);
        for (int i = 0; i < 60; ++i) EXPECT_TRUE(simulation.advance());
        return hash_state(simulation.state());
    });
}

TEST(Determinism, the_result_hash_is_the_same_on_1_2_and_4_threads) {
    const std::uint64_t one = hash_on_threads(1);
    EXPECT_EQ(hash_on_threads(2), one);
    EXPECT_EQ(hash_on_threads(4), one);
}

TEST(TimeStep, keeps_a_particle_from_moving_more_than_the_displacement_limit) {
    const terrain::Terrain terrain = inclined_plane(45, 80, 40);
    params::MaterialSpec material;
    material.friction_coefficient = 0.05;
    params::SolverSpec solver;
    for (const double limit : {0.5, 0.2}) {
        solver.displacement_limit = limit;
        Simulation simulation =
            simulate(material, solver, terrain, {block(terrain, rectangle(5, 15, 11, 21), 0.8)}, 0.4);
        while (simulation.state().time < 2.5) {
            ASSERT_TRUE(simulation.advance());
            EXPECT_LE(simulation.state().max_speed * simulation.state().time_step, limit * 0.4 * 1.1);
        }
        EXPECT_LT(simulation.state().time_step, 1.0 / 60) << "never fast enough to matter";
    }
}

TEST(TimeStep, never_takes_more_than_the_velocity_difference_from_viscous_debris) {
    const terrain::Terrain terrain = inclined_plane(20, 40, 40);
    params::MaterialSpec material;
    material.viscosity = 3;  // as a high kinematic viscosity with fine particles
    Simulation simulation = simulate(material, {}, terrain, {block(terrain, rectangle(5, 15, 9, 19), 0.8)}, 0.4);
    while (simulation.state().time < 0.5) {
        ASSERT_TRUE(simulation.advance());
        EXPECT_LE(3 * simulation.state().time_step, 1.0 / 60 + 1e-9);
    }
    EXPECT_GE(3 * simulation.state().time_step, 0.9 / 60) << "shorter than viscosity needs";
}

TEST(Fault, names_the_time_and_the_parameter_to_change) {
    Model model = make_model({}, {}, 0.5);
    State state = testing::state_of({{0, 0, 5}});
    state.time = 3.25;
    EXPECT_TRUE(find_fault(model, state, 6));
    state.max_speed = std::nan("");
    EXPECT_NE(find_fault(model, state, 6).error().message.find("t = 3.25 s"), std::string::npos);
    state.max_speed = 0;
    state.mean_compression = 0.9;
    EXPECT_NE(find_fault(model, state, 6).error().message.find("solver.iteration_count"), std::string::npos);
    state.mean_compression = 0;
    state.max_speed = 60;
    EXPECT_NE(find_fault(model, state, 6).error().message.find("more than its fall can explain"), std::string::npos);
}

}  // namespace
}  // namespace talus::sim
