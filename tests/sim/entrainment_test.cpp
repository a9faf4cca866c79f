#include "sim/sources/entrainment.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "sim/physics/resistance.hpp"
#include "sim/sim_fixtures.hpp"

namespace talus::testing {
namespace {

terrain::BedMaterial growing(double rate) {
    terrain::BedMaterial material;
    material.name = "gravel";
    material.growth_rate = rate;
    return material;
}

terrain::BedMaterial sheared(double critical) {
    terrain::BedMaterial material;
    material.law = params::EntrainmentLaw::shear;
    material.critical_shear_stress = critical;
    material.erosion_rate = 0.1;
    material.depth_per_shear = 1e-5;
    return material;
}

/// Lays material on the whole ground.
void lay(sim::Ground& ground, const terrain::BedMaterial& material, float depth) {
    const std::size_t cells = ground.terrain.elevation().values.size();
    ground.bed = {{material},
                  std::vector<std::uint8_t>(cells, 1),
                  std::vector<float>(cells, depth),
                  std::vector<float>(cells, 0)};
}

/// A block on a plane of 25 degrees, steeper than its friction angle.
sim::Simulation slide(const terrain::BedMaterial& material, float depth, params::MaterialSpec moving = {}) {
    const terrain::Terrain terrain = inclined_plane(25);
    moving.friction_coefficient = 0.2;
    sim::Model model = sim::make_model(moving, {}, coarse_spacing);
    sim::Ground ground(terrain);
    Result<sim::State> state = seed_releases(model, ground, {block(terrain, rectangle(8, 15, 14, 25), 1.5)});
    lay(ground, material, depth);
    return {std::move(model), std::move(ground), *std::move(state)};
}

double eroded_volume(const sim::Ground& ground) {
    const double area = ground.terrain.cell() * ground.terrain.cell();
    return area * std::accumulate(ground.bed.eroded.begin(), ground.bed.eroded.end(), 0.0);
}

LocalPoint momentum(const sim::State& state) {
    LocalPoint sum;
    for (std::uint32_t i = 0; i < state.count; ++i) sum += state.velocity.at(i);
    return sum;
}

TEST(Entrainment, brings_debris_whose_pore_pressure_decays_from_then) {
    params::MaterialSpec moving;
    moving.pore_pressure_ratio = 0.3;
    moving.pore_pressure_decay_time = 5;
    sim::Simulation simulation = slide(growing(0.02), 1, moving);
    const std::uint32_t released = simulation.state().count;
    while (simulation.state().entrained < 20) ASSERT_TRUE(simulation.advance());
    const double time = simulation.state().time;
    const auto& entries = simulation.state().entry_of_id;
    ASSERT_EQ(entries.size(), simulation.state().seeded);
    EXPECT_GT(entries[released].time, 0.05);
    EXPECT_NEAR(entries.back().time, time, 0.1);
    EXPECT_NEAR(effective_share(simulation.model(), entries, entries.size() - 1, time), 0.7, 0.01);
    EXPECT_LT(entries[released].time, entries.back().time);
}

TEST(Entrainment, grows_by_the_law_and_takes_it_from_the_ground) {
    sim::Simulation simulation = slide(growing(0.02), 1);
    const sim::State& state = simulation.state();
    const sim::Model& model = simulation.model();
    const sim::Ground& ground = simulation.ground();
    const std::uint32_t released = state.count;
    double expected = 0;
    for (int k = 0; k < 120; ++k) {
        ASSERT_TRUE(simulation.advance());
        for (std::uint32_t i = 0; i < state.count; ++i) {
            expected += 0.02 * length(state.velocity.at(i)) * state.time_step;
        }
    }
    ASSERT_GT(state.entrained, 50U);
    EXPECT_EQ(state.count + state.outflow, released + state.entrained);
    EXPECT_EQ(state.released(), released);
    EXPECT_NEAR(state.entrained, expected, 0.1 * expected) << "but for what has come loose and is no particle yet";
    const double gained = state.entrained * model.particle_volume();
    EXPECT_NEAR(eroded_volume(ground), gained, 1e-4 * gained);
    const terrain::Terrain untouched = inclined_plane(25);
    double sunk = 0;
    for (std::size_t cell = 0; cell < ground.bed.eroded.size(); ++cell) {
        sunk += untouched.elevation().values[cell] - ground.terrain.elevation().values[cell];
    }
    EXPECT_NEAR(sunk, gained, 0.01 * gained) << "cells of 1 m2; elevations are float";
}

TEST(Entrainment, keeps_momentum_and_everybody_elses_speed) {
    sim::Simulation simulation = slide(growing(0.05), 1);
    for (int k = 0; k < 60; ++k) ASSERT_TRUE(simulation.advance());
    const sim::Model& model = simulation.model();
    sim::Ground ground = simulation.ground();
    sim::State state = simulation.state();
    state.resize(2 * state.count);
    sim::Entrainment entrainment;
    std::size_t found = 0;
    for (int k = 0; k < 200 && found == 0; ++k) found = entrainment.find(model, ground, state);
    ASSERT_GT(found, 0U);
    const LocalPoint before = momentum(state);
    const std::uint32_t count = state.count;
    entrainment.apply(model, ground, state);
    EXPECT_EQ(state.count, count + found);
    const LocalPoint after = momentum(state);
    EXPECT_EQ(after.x, before.x);
    EXPECT_EQ(after.z, before.z);
    for (std::uint32_t i = count; i < state.count; ++i) {
        EXPECT_EQ(length(state.velocity.at(i)), 0);
        const LocalPoint p = state.position.at(i);
        EXPECT_NEAR(p.z, ground.terrain.sample(p.x, p.y).height + coarse_spacing / 2, 0.2 * coarse_spacing)
            << "it lies on the ground";
    }
}

TEST(Entrainment, makes_room_without_a_pop) {
    const terrain::Terrain level = terrain_of(30, 30, 1, [](double, double) { return 10; });
    params::SolverSpec solver;
    solver.largest_time_step = 1.0 / 60;
    sim::Model model = sim::make_model({}, solver, coarse_spacing);
    sim::Ground ground(level);
    Result<sim::State> seeded = seed_releases(model, ground, {block(level, rectangle(5, 5, 25, 25), 2)});
    // Debris that seems to move entrains its bed for a moment, and lies still again.
    lay(ground, growing(0.02), 1);
    sim::State state = *seeded;
    state.resize(2 * state.count);
    state.awake = state.count;
    state.time_step = 1.0 / 60;
    std::fill(state.velocity.x.begin(), state.velocity.x.end(), 3.0F);
    sim::Entrainment entrainment;
    for (int k = 0; k < 8; ++k) {
        if (entrainment.find(model, ground, state) > 0) entrainment.apply(model, ground, state);
    }
    ASSERT_GT(state.entrained, 20U);
    std::fill(state.velocity.x.begin(), state.velocity.x.end(), 0.0F);
    state.resize(state.count);
    ground.bed = {};
    sim::Simulation simulation(model, std::move(ground), std::move(state));
    // The block falls apart at its sides; in its middle nothing may happen.
    double fastest = 0, worst = 0;
    for (int k = 0; k < 15; ++k) {
        ASSERT_TRUE(simulation.advance());
        const sim::State& now = simulation.state();
        worst = std::max(worst, now.max_compression);
        for (std::uint32_t i = 0; i < now.count; ++i) {
            const LocalPoint p = now.position.at(i), v = now.velocity.at(i);
            if (std::abs(p.x) < 6 && std::abs(p.y) < 6) fastest = std::max<double>(fastest, length(v));
        }
    }
    EXPECT_LT(fastest, 0.3) << "m/s";
    EXPECT_LT(worst, 0.05) << "squeezed in without room, particles are compressed by 13 %";
}

TEST(Entrainment, ends_where_the_bed_does) {
    constexpr float depth = 0.2F;
    sim::Simulation simulation = slide(growing(0.5), depth);
    for (int k = 0; k < 150; ++k) ASSERT_TRUE(simulation.advance());
    const terrain::Bed& bed = simulation.ground().bed;
    const double particle_depth = simulation.model().particle_volume();  // over a cell of 1 m2
    float deepest = 0;
    for (const float eroded : bed.eroded) deepest = std::max(deepest, eroded);
    EXPECT_GT(deepest, 0);
    EXPECT_LE(deepest, depth + particle_depth);
    // On average over the cells that were swept there is no more than there was.
    double sum = 0, swept = 0;
    for (const float eroded : bed.eroded) {
        sum += eroded;
        swept += eroded > 0;
    }
    EXPECT_LE(sum / swept, depth + 0.1 * particle_depth);
}

TEST(Entrainment, by_shear_needs_the_critical_stress) {
    // 1.5 m of debris at 25 degrees: 2000 x 9.8 x 1.5 x sin 25 = 12.4 kPa, and more where it piles up.
    sim::Simulation strong = slide(sheared(50e3), 1), weak = slide(sheared(5e3), 1);
    for (int k = 0; k < 60; ++k) {
        ASSERT_TRUE(strong.advance());
        ASSERT_TRUE(weak.advance());
    }
    EXPECT_EQ(strong.state().entrained, 0U);
    EXPECT_GT(weak.state().entrained, 5U);
    // No deeper than the law allows for the greatest stress there can have been.
    const double most = 1e-5 * (30e3 - 5e3) + weak.model().particle_volume();
    for (const float eroded : weak.ground().bed.eroded) EXPECT_LE(eroded, most);
}

TEST(Entrainment, does_not_depend_on_the_number_of_threads) {
    const auto run = [](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        sim::Simulation simulation = slide(growing(0.03), 1);
        for (int k = 0; k < 80; ++k) EXPECT_TRUE(simulation.advance());
        EXPECT_GT(simulation.state().entrained, 20U);
        return hash_state(simulation.state());
    };
    EXPECT_EQ(run(1), run(2));
}

TEST(Entrainment, stops_the_run_at_the_particle_limit) {
    sim::Simulation simulation = slide(growing(0.2), 1);
    simulation.change([](sim::Model& model, sim::Ground&, sim::State& state) {
        model.solver.particle_limit = static_cast<int>(state.count) + 10;
    });
    Status stepped;
    for (int k = 0; k < 150 && stepped; ++k) stepped = simulation.advance();
    ASSERT_FALSE(stepped);
    EXPECT_NE(stepped.error().message.find("solver.particle_limit"), std::string::npos) << stepped.error().message;
}

TEST(Entrainment, without_a_bed_finds_nothing) {
    sim::Simulation simulation = slide(growing(0.2), 1);
    simulation.change([](sim::Model&, sim::Ground& ground, sim::State&) { ground.bed = {}; });
    for (int k = 0; k < 60; ++k) ASSERT_TRUE(simulation.advance());
    EXPECT_EQ(simulation.state().entrained, 0U);
}

}  // namespace
}  // namespace talus::testing
