#include "sim/rising_water.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/archive.hpp"
#include "sim/physics/resistance.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

using Rows = std::vector<params::PressureSample>;

/// Soil at its critical solid fraction, which shears without a change of volume: friction alone decides.
params::MaterialSpec soil_at_critical_state() {
    params::MaterialSpec material;
    material.pore_pressure = params::PorePressure::dilatancy;
    material.permeability = 1e-11;
    material.solid_fraction = material.critical_solid_fraction = 0.62;
    material.grain_density = 2700;
    material.rest_density = 1100 + 1600 * 0.62;
    material.friction_coefficient = 0.7;
    return material;
}

TEST(RisingWater, is_linear_between_rows_and_constant_outside) {
    const Rows rows = {{10, 0.2}, {20, 0.6}, {40, 0.5}};
    EXPECT_DOUBLE_EQ(ratio_at(rows, 0), 0.2);
    EXPECT_DOUBLE_EQ(ratio_at(rows, 15), 0.4);
    EXPECT_DOUBLE_EQ(ratio_at(rows, 20), 0.6);
    EXPECT_DOUBLE_EQ(ratio_at(rows, 30), 0.55);
    EXPECT_DOUBLE_EQ(ratio_at(rows, 50), 0.5);
}

TEST(RisingWater, is_what_soil_drains_to) {
    params::MaterialSpec material = soil_at_critical_state();
    material.permeability = 1e-3;
    Soil<double> s{0.62, 0.5, 1.0, 0};
    for (int k = 0; k < 20; ++k) s = evolve(evolving_pressure_of(material), s, 9.81, 1.0, 0.0, 0.1, 0.8);
    EXPECT_NEAR(s.pressure_ratio, 0.8, 1e-3);
    EXPECT_LT(s.solid_fraction, 0.62) << "it has sucked in water";
}

/// The ratio of the water at which a slab on an infinite slope has slid by a millimetre, or -1 if it never does: water
/// rises from 0.1 to a highest ratio in 100 s.
double ratio_at_sliding(double highest, double tan_slope, double friction) {
    const EvolvingPressure law = evolving_pressure_of(soil_at_critical_state());
    const double slope = std::atan(tan_slope), gravity = 9.81, dt = 0.01;
    const Rows rows = {{0, 0.1}, {100, highest}};
    Soil<double> s{0.62, 0.1, 1.0, 0};
    double speed = 0, way = 0;
    for (double t = 0; t < 120; t += dt) {
        const double water = ratio_at(rows, t + dt);
        s.pressure_ratio += water - ratio_at(rows, t);
        s = evolve(law, s, gravity * std::cos(slope), 1.0, speed, dt, water);
        const double resists = gravity * std::cos(slope) * friction * friction_share(s, friction);
        speed = std::max(0.0, speed + (gravity * std::sin(slope) - resists) * dt);
        way += speed * dt;
        if (way > 1e-3) return water;
    }
    return -1;
}

TEST(RisingWater, moves_a_slab_where_friction_is_as_steep_as_the_slope) {
    for (const double tan_slope : {0.3, 0.4663, 0.6}) {
        const double critical = 1 - tan_slope / 0.7;
        EXPECT_NEAR(ratio_at_sliding(critical + 0.1, tan_slope, 0.7), critical, 0.01) << tan_slope;
        EXPECT_EQ(ratio_at_sliding(critical - 0.01, tan_slope, 0.7), -1) << tan_slope;
    }
}

TEST(RisingWater, belongs_to_the_particles_of_its_release_until_that_has_failed) {
    Model model;
    model.particle_spacing = 0.5;
    model.releases = {{"dry", 0, 0, 10}, {"wet", 5, 10, 20}};
    model.releases[1].water = {{0, 0.2}, {100, 0.4}};
    StateSummary state;
    state.time_step = 1;
    double way = 0;
    const auto places = [&](std::uint32_t first, std::uint32_t last) {
        EXPECT_EQ(first, 10U);
        const double count = last - first;
        return PlaceSum{count * (3 + way), count * 2, count * 7, last - first};
    };
    raise_water(model, state, places);
    ASSERT_EQ(state.water_of_release.size(), 2U);
    EXPECT_FALSE(water_of(model, state.water_of_release, 3).rises());
    EXPECT_TRUE(water_of(model, state.water_of_release, 12).rises());
    EXPECT_EQ(state.water_of_release[1].started, 0U) << "it is held";
    state.time = 50;
    raise_water(model, state, places);
    EXPECT_NEAR(state.water_of_release[1].ratio, 0.302, 1e-6);
    EXPECT_NEAR(state.water_of_release[1].rise, 0.002, 1e-6);
    EXPECT_TRUE(water_to_come(model, state));
    way = 0.49;
    state.time = 60;
    raise_water(model, state, places);
    EXPECT_EQ(state.water_of_release[1].failed, 0U);
    way = 0.51;
    state.time = 70;
    raise_water(model, state, places);
    EXPECT_FALSE(water_of(model, state.water_of_release, 12).rises());
    EXPECT_EQ(state.water_of_release[1].failed_at, 70);
    EXPECT_NEAR(state.water_of_release[1].ratio, 0.322, 1e-6) << "of the step before";
    EXPECT_FALSE(water_to_come(model, state));
}

TEST(RisingWater, gives_the_share_of_the_grains_where_pore_pressure_is_prescribed) {
    Model model;
    model.pore_pressure_decay_time = 10;
    model.releases = {{"wet", 0, 0, 10}};
    State state;
    Water water;
    water.ratio = 0.4F;
    water.started = 1;
    water.failed_at = 30;
    state.water_of_release = {water};
    EXPECT_NEAR(share_of_grains(model, state, 3, 100), 0.6, 1e-6) << "does not decay before it has failed";
    state.water_of_release[0].failed = 1;
    EXPECT_NEAR(share_of_grains(model, state, 3, 40), 1 - 0.4 * std::exp(-1), 1e-6);
    EXPECT_EQ(share_of_grains(model, state, 12, 40), 1);
}

/// A layer on a plane of 25 degrees, in which water rises.
Simulation wet_layer(Rows water, params::PorePressure law, params::BackendChoice backend = params::BackendChoice::cpu) {
    params::MaterialSpec material = soil_at_critical_state();
    material.pore_pressure = law;
    material.internal_friction_coefficient = 1.2;  // the layer's edges stand
    params::SolverSpec solver;
    solver.backend = backend;
    const terrain::Terrain terrain = testing::inclined_plane(25, 40, 24);
    terrain::Release release = testing::block(terrain, testing::rectangle(8, 7, 18, 17), 1);
    release.water = std::move(water);
    return testing::simulate(material, solver, terrain, {release}, 0.5);
}

void advance_to_failure(Simulation& run, double latest) {
    while (run.summary().time < latest) {
        ASSERT_TRUE(run.advance());
        if (run.summary().water_of_release.at(0).failed != 0) return;
    }
}

const double critical = 1 - std::tan(25 * M_PI / 180) / 0.7;  // 0.334

TEST(RisingWater, lets_a_layer_fail_about_where_friction_is_as_steep_as_the_slope) {
    for (const auto law : {params::PorePressure::prescribed, params::PorePressure::dilatancy}) {
        Simulation run = wet_layer({{0, 0.2}, {10, 0.5}}, law);
        advance_to_failure(run, 10);
        const Water& water = run.summary().water_of_release.at(0);
        ASSERT_EQ(water.failed, 1U);
        // A layer with ends slides a little early, and takes a few seconds for its first spacing, at 0.03 a second.
        EXPECT_GT(water.ratio, critical - 0.05F);
        EXPECT_LT(water.ratio, critical + 0.12F);
    }
}

TEST(RisingWater, leaves_a_layer_where_it_is_and_awake_while_friction_holds_it) {
    Simulation run = wet_layer({{0, 0.1}, {4, 0.22}}, params::PorePressure::prescribed);
    advance_to_failure(run, 5);
    EXPECT_EQ(run.summary().water_of_release.at(0).failed, 0U);
    EXPECT_EQ(run.summary().awake, run.summary().count);
    EXPECT_NEAR(run.summary().water_of_release[0].ratio, 0.22, 1e-6);
}

TEST(RisingWater, is_that_of_the_processor_on_a_device_and_in_a_saved_run) {
    const Rows rows = {{0, 0.3}, {2, 0.5}};
    Simulation processor = wet_layer(rows, params::PorePressure::dilatancy);
    Simulation device = wet_layer(rows, params::PorePressure::dilatancy, params::BackendChoice::host);
    Simulation restored = wet_layer(rows, params::PorePressure::dilatancy);
    for (int k = 0; k < 30; ++k) {
        ASSERT_TRUE(processor.advance());
        ASSERT_TRUE(device.advance());
    }
    const Soil<float>& one = processor.state().soil_of_id.at(0);
    EXPECT_NEAR(device.state().soil_of_id.at(0).pressure_ratio, one.pressure_ratio, 0.02);
    EXPECT_NEAR(one.pressure_ratio, processor.summary().water_of_release.at(0).ratio, 0.1);
    ArchiveWriter saved;
    processor.save(saved);
    const std::string bytes = saved.take();
    ArchiveReader reader(bytes);
    restored.restore(reader);
    ASSERT_FALSE(reader.failed());
    for (int k = 0; k < 10; ++k) {
        ASSERT_TRUE(processor.advance());
        ASSERT_TRUE(restored.advance());
    }
    EXPECT_EQ(hash_state(restored.state()), hash_state(processor.state()));
    EXPECT_EQ(restored.summary().water_of_release[0].start.x, processor.summary().water_of_release[0].start.x);
}

}  // namespace
}  // namespace talus::sim
