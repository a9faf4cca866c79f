#include "sim/physics/pore_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "core/archive.hpp"
#include "sim/physics/resistance.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

constexpr double earth_gravity = 9.81;

params::MaterialSpec wet_soil(double fraction = 0.62) {
    params::MaterialSpec material;
    material.pore_pressure = params::PorePressure::dilatancy;
    material.permeability = 1e-10;
    material.solid_fraction = fraction;
    material.critical_solid_fraction = 0.64;
    material.grain_density = 2700;
    material.rest_density = 1100 + 1600 * fraction;
    return material;
}

double bulk_density(const EvolvingPressure& law, double fraction) {
    return law.grain_density * fraction + law.fluid_density * (1 - fraction);
}

double hydrostatic(const EvolvingPressure& law, double fraction) {
    return law.fluid_density / bulk_density(law, fraction);
}

Soil<double> soil(double fraction, double ratio, double thickness) {
    return {fraction, ratio, thickness, 0};
}

/// What is left of a small excess after a time in a number of steps.
double left_of_excess(const EvolvingPressure& law, double thickness, double time, int steps) {
    const double m = law.solid_fraction, rest = hydrostatic(law, m), excess = 0.01;
    Soil<double> s = soil(m, rest + excess, thickness);
    for (int k = 0; k < steps; ++k) s = evolve(law, s, earth_gravity, thickness, 0.0, time / steps);
    return (s.pressure_ratio - rest) / excess;
}

TEST(PorePressure, of_soil_at_rest_falls_as_its_consolidation_says) {
    params::MaterialSpec material = wet_soil();
    material.permeability = 1e-12;
    material.compressibility = 0.3;
    const EvolvingPressure law = evolving_pressure_of(material);
    const double h = 0.001, m = law.solid_fraction;  // thin: the effective stress is far below that of reference
    const double density = bulk_density(law, m), effective = (density - law.fluid_density) * earth_gravity * h;
    const double alpha = law.compressibility / (m * (effective + reference_stress));
    const double per_second = 3 * law.permeability / (alpha * law.viscosity * h * h) +
                              law.permeability * earth_gravity * law.fluid_density * (density - law.fluid_density) /
                                  (2 * h * law.viscosity * density);
    for (const double lives : {0.1, 0.5, 1.0, 2.0}) {
        for (const int steps : {1, 100}) {
            EXPECT_NEAR(left_of_excess(law, h, lives / per_second, steps), std::exp(-lives), 0.01 * std::exp(-lives))
                << lives << " lives in " << steps << " steps";
        }
    }
}

TEST(PorePressure, stays_where_no_water_moves) {
    params::MaterialSpec material = wet_soil();
    material.permeability = 0;
    const EvolvingPressure law = evolving_pressure_of(material);
    for (const double dt : {1e-4, 0.01, 1.0, 100.0}) {
        const Soil<double> after = evolve(law, soil(0.62, 0.7, 1.0), earth_gravity, 1.0, 0.0, dt);
        EXPECT_NEAR(after.pressure_ratio, 0.7, 1e-12) << dt;
        EXPECT_EQ(after.solid_fraction, 0.62);
    }
    Soil<double> loose = soil(0.5, 0.5, 1.0), dense = soil(0.68, 0.5, 1.0);
    for (int k = 0; k < 1000; ++k) {
        loose = evolve(law, loose, earth_gravity, 1.0, 1.0, 0.01);
        dense = evolve(law, dense, earth_gravity, 1.0, 1.0, 0.01);
    }
    EXPECT_GT(loose.pressure_ratio, 0.99) << "contracts, and liquefies";
    EXPECT_LT(dense.pressure_ratio, 0.01) << "dilates, and stiffens";
}

TEST(PorePressure, is_hydrostatic_where_water_moves_freely) {
    params::MaterialSpec material = wet_soil();
    material.permeability = 1e-3;
    const EvolvingPressure law = evolving_pressure_of(material);
    for (const double dt : {1e-4, 0.01, 1.0, 100.0}) {
        Soil<double> s = soil(0.62, 0.95, 1.0);
        for (int k = 0; k < 20; ++k) s = evolve(law, s, earth_gravity, 1.0, 0.0, dt);
        EXPECT_NEAR(s.pressure_ratio, hydrostatic(law, s.solid_fraction), 0.002) << dt;
    }
}

TEST(PorePressure, keeps_effective_stress_where_the_flow_thins) {
    params::MaterialSpec material = wet_soil();
    material.permeability = 0;
    const EvolvingPressure law = evolving_pressure_of(material);
    const double density = bulk_density(law, 0.62), part = (law.fluid_density + 3 * density) / (4 * density);
    const Soil<double> after = evolve(law, soil(0.62, 0.6, 1.0), earth_gravity, 0.8, 0.0, 0.01);
    EXPECT_NEAR((after.pressure_ratio - part) * 0.8, (0.6 - part) * 1.0, 1e-9);
}

TEST(PorePressure, is_bounded_and_finite_for_any_state_and_step) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    const auto between = [&](float low, float high) { return low * std::pow(high / low, unit(random)); };
    for (int k = 0; k < 50000; ++k) {
        params::MaterialSpec material = wet_soil(0.4 + 0.35 * static_cast<double>(unit(random)));
        material.permeability = between(1e-13F, 1e-8F);
        material.compressibility = between(0.003F, 0.3F);
        material.pore_fluid_viscosity = between(0.001F, 0.1F);
        const EvolvingPressure law = evolving_pressure_of(material);
        const float h = between(0.001F, 30);
        const Soil<float> before{0.4F + 0.35F * unit(random), unit(random), h * between(0.3F, 3), 0};
        const Soil<float> after =
            evolve(law, before, 9.81F * unit(random) + 0.01F, h, 40 * unit(random) * unit(random), between(1e-4F, 1));
        ASSERT_TRUE(after.pressure_ratio >= 0 && after.pressure_ratio <= 1) << k;
        ASSERT_TRUE(after.solid_fraction >= 0.3F && after.solid_fraction <= 0.8F) << k;
        ASSERT_TRUE(std::isfinite(after.dilatancy)) << k;
    }
}

TEST(PorePressure, of_one_step_is_that_of_many) {
    const EvolvingPressure law = evolving_pressure_of(wet_soil(0.6));
    for (const double speed : {0.1, 1.0, 5.0}) {
        const Soil<double> start = soil(0.6, 0.6, 0.5);
        Soil<double> fine = start;
        for (int k = 0; k < 1000; ++k) fine = evolve(law, fine, earth_gravity, 0.5, speed, 1e-5);
        EXPECT_NEAR(evolve(law, start, earth_gravity, 0.5, speed, 0.01).pressure_ratio, fine.pressure_ratio, 0.01)
            << speed;
    }
}

/// A slab on an infinite slope, at rest at the start: way in metres and pressure ratio after a time.
struct Slab {
    double way = 0, speed = 0, liquefied_at = -1;
    Soil<double> soil;
};

/// The soil of Iverson et al. (2000), "Acute sensitivity of landslide rates to initial soil porosity", as George &
/// Iverson (2014, table 1) give it; slope and thickness too.
Slab slide(double fraction, double time) {
    params::MaterialSpec material;
    material.pore_pressure = params::PorePressure::dilatancy;
    material.permeability = 1e-11;
    material.solid_fraction = 0.6;
    material.critical_solid_fraction = 0.56;
    material.pore_fluid_viscosity = 0.005;
    material.pore_fluid_density = 1000;
    material.grain_density = 2700;
    material.compressibility = 0.03;
    const EvolvingPressure law = evolving_pressure_of(material);
    constexpr double slope = 31 * M_PI / 180, h = 0.65, dt = 1e-3, friction = 0.86;
    // Water has risen until the slope is about to fail.
    const double psi = fraction - 0.56, angle = (friction + psi) / (1 - friction * psi);
    Slab slab{.soil = {fraction, 1 - std::tan(slope) / angle + 1e-4, h, psi}};
    for (double t = 0; t < time; t += dt) {
        const double resists = earth_gravity * std::cos(slope) * friction * friction_share(slab.soil, friction);
        slab.speed = std::max(0.0, slab.speed + (earth_gravity * std::sin(slope) - resists) * dt);
        slab.soil = evolve(law, slab.soil, earth_gravity * std::cos(slope), h, slab.speed, dt);
        slab.way += slab.speed * dt;
        if (slab.liquefied_at < 0 && slab.soil.pressure_ratio > 0.95) slab.liquefied_at = t;
    }
    return slab;
}

TEST(PorePressure, liquefies_loose_soil_and_lets_dense_soil_creep) {
    const Slab loose = slide(0.48, 3), dense = slide(0.59, 20);
    EXPECT_GT(loose.liquefied_at, 0.6);
    EXPECT_LT(loose.liquefied_at, 2);
    EXPECT_GT(loose.speed, 5);
    EXPECT_LT(dense.speed, 0.001) << "shear dilates it, and it creeps as fast as water is sucked in";
    EXPECT_GT(dense.speed, 0);
    EXPECT_GT(slide(0.555, 10).way, 20);
    EXPECT_LT(slide(0.565, 10).way, 0.2) << "the divide is at the critical solid fraction";
}

TEST(PorePressure, changes_the_friction_of_dry_debris_by_its_share_and_the_angle_of_dilatancy) {
    Soil<double> s = soil(0.6, 0.25, 1);
    EXPECT_NEAR(friction_share(s, 0.5), 0.75, 1e-12);
    s.dilatancy = 0.1;
    EXPECT_NEAR(friction_share(s, 0.5), 0.75 * std::tan(std::atan(0.5) + std::atan(0.1)) / 0.5, 1e-12);
    s.dilatancy = -0.9;
    EXPECT_EQ(friction_share(s, 0.5), 0) << "never drives";
}

/// A layer on a plane that its dry friction holds and hydrostatic pressure does not.
Simulation layer(double fraction, params::BackendChoice backend = params::BackendChoice::cpu, double bump = 0) {
    params::MaterialSpec material = wet_soil(fraction);
    material.friction_coefficient = 0.7;
    params::SolverSpec solver;
    solver.backend = backend;
    solver.time_step = 1.0 / 60;
    const terrain::Terrain terrain = testing::terrain_of(60, 30, 1, [=](double x, double y) {
        const bool spike = std::lround(x) % 7 == 0 && std::lround(y) % 5 == 0;
        return 100 - 0.55 * x + (spike ? bump : 0) - (x > 30 ? bump : 0);
    });
    return testing::simulate(material, solver, terrain,
                             {testing::block(terrain, testing::rectangle(15, 11, 27, 19), 1.5)}, 0.5);
}

double mean_way(const State& state, const State& from) {
    double sum = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) sum += state.position.x[i];
    for (std::uint32_t i = 0; i < from.count; ++i) sum -= from.position.x[i];
    return sum / state.count;
}

TEST(EvolvingPorePressure, starts_hydrostatic_and_with_the_solid_fraction_of_the_release) {
    Simulation run = layer(0.6);
    ASSERT_TRUE(run.advance());
    const double rest = hydrostatic(run.model().evolving_pressure, 0.6);
    ASSERT_EQ(run.state().soil_of_id.size(), run.state().seeded);
    for (const Soil<float>& s : run.state().soil_of_id) {
        ASSERT_NEAR(s.pressure_ratio, rest, 0.1) << "changed by one step alone, not by the search for a state at rest";
        ASSERT_NEAR(s.solid_fraction, 0.6, 1e-4);
    }
}

TEST(EvolvingPorePressure, lets_loose_debris_run_and_holds_dense_debris) {
    Simulation loose = layer(0.55), dense = layer(0.68);
    const State loose_start = loose.state(), dense_start = dense.state();
    for (int k = 0; k < 150; ++k) {
        ASSERT_TRUE(loose.advance());
        ASSERT_TRUE(dense.advance());
    }
    EXPECT_GT(mean_way(loose.state(), loose_start), 2 * mean_way(dense.state(), dense_start) + 1);
}

TEST(EvolvingPorePressure, stays_within_its_bounds_over_steps_and_spikes) {
    Simulation run = layer(0.6, params::BackendChoice::cpu, 3);
    for (int k = 0; k < 150; ++k) ASSERT_TRUE(run.advance());
    ASSERT_EQ(run.state().soil_of_id.size(), run.state().seeded);
    for (const Soil<float>& s : run.state().soil_of_id) {
        ASSERT_TRUE(s.pressure_ratio >= 0 && s.pressure_ratio <= 1);
        ASSERT_TRUE(s.solid_fraction >= 0.3F && s.solid_fraction <= 0.8F);
        ASSERT_GT(s.thickness, 0);
    }
}

TEST(EvolvingPorePressure, is_that_of_the_processor_on_a_device) {
    Simulation processor = layer(0.6), device = layer(0.6, params::BackendChoice::host);
    for (int k = 0; k < 60; ++k) {
        ASSERT_TRUE(processor.advance());
        ASSERT_TRUE(device.advance());
    }
    const State &a = processor.state(), &b = device.state();
    ASSERT_EQ(a.soil_of_id.size(), b.soil_of_id.size());
    double mean_a = 0, mean_b = 0;
    for (const Soil<float>& s : a.soil_of_id) mean_a += s.pressure_ratio / static_cast<double>(a.seeded);
    for (const Soil<float>& s : b.soil_of_id) mean_b += s.pressure_ratio / static_cast<double>(b.seeded);
    EXPECT_NEAR(mean_b, mean_a, 0.01);
    EXPECT_NE(mean_a, 0);
}

/// Debris in a pit, asleep after 4 s if it may be: the share that is.
double asleep_in_pit(const params::MaterialSpec& material) {
    const terrain::Terrain terrain = testing::terrain_of(
        20, 20, 1, [](double x, double y) { return std::max(std::abs(x - 10), std::abs(y - 10)) < 2.6 ? 0 : 4; });
    Simulation pit = testing::simulate(material, {}, terrain,
                                       {testing::block(terrain, testing::rectangle(7.6, 7.6, 12.4, 12.4), 1.6)}, 0.5);
    while (pit.summary().time < 4) {
        if (!pit.advance()) return -1;
    }
    return 1 - static_cast<double>(pit.summary().awake) / pit.summary().count;
}

TEST(EvolvingPorePressure, keeps_debris_awake_until_it_is_in_balance) {
    params::MaterialSpec material = wet_soil();
    material.pore_pressure_ratio = 0.7;
    material.permeability = 1e-14;
    EXPECT_EQ(asleep_in_pit(material), 0) << "its pressure has hardly fallen";
    material.permeability = 1e-5;
    EXPECT_GT(asleep_in_pit(material), 0.3) << "it has drained";
    material.pore_pressure = params::PorePressure::prescribed;
    EXPECT_GT(asleep_in_pit(material), 0.3) << "its pressure stays as it is";
}

TEST(PorePressure, is_in_balance_within_a_hundredth_of_hydrostatic) {
    const EvolvingPressure law = evolving_pressure_of(wet_soil());
    for (const double fraction : {0.5, 0.62, 0.7}) {
        const double rest = hydrostatic(law, fraction);
        EXPECT_TRUE(in_balance(law, soil(fraction, rest, 1)));
        EXPECT_TRUE(in_balance(law, soil(fraction, rest + 0.009, 1)));
        EXPECT_FALSE(in_balance(law, soil(fraction, rest + 0.011, 1)));
        EXPECT_FALSE(in_balance(law, soil(fraction, rest - 0.011, 1)));
    }
}

TEST(EvolvingPorePressure, goes_on_from_a_saved_run) {
    Simulation run = layer(0.6), restored = layer(0.6);
    for (int k = 0; k < 20; ++k) ASSERT_TRUE(run.advance());
    ArchiveWriter saved;
    run.save(saved);
    const std::string bytes = saved.take();
    ArchiveReader reader(bytes);
    restored.restore(reader);
    ASSERT_FALSE(reader.failed());
    for (int k = 0; k < 20; ++k) {
        ASSERT_TRUE(run.advance());
        ASSERT_TRUE(restored.advance());
    }
    EXPECT_EQ(hash_state(restored.state()), hash_state(run.state()));
    EXPECT_EQ(restored.state().soil_of_id.front().pressure_ratio, run.state().soil_of_id.front().pressure_ratio);
}

}  // namespace
}  // namespace talus::sim
