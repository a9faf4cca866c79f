#include "sim/sources/inflow.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "sim/change.hpp"
#include "sim/particle_density.hpp"
#include "sim_fixtures.hpp"
#include "support/allocations.hpp"

namespace talus::sim {
namespace {

using testing::inclined_plane;

/// 6 m wide at x = 20, towards +x: down the plane of sim_fixtures.
terrain::Inflow inflow(std::vector<params::InflowSample> hydrograph) {
    return {"gully", {20, 17}, {20, 23}, std::move(hydrograph)};
}

Ground plane() {
    return Ground(inclined_plane(25));
}

TEST(Inflow, integrates_the_hydrograph_exactly) {
    const terrain::Inflow surges = inflow({{1, 0, 2}, {3, 8, 4}, {4, 0, 4}, {6, 0, 1}, {7, 6, 1}});
    EXPECT_EQ(surges.volume_until(0.5), 0);
    EXPECT_NEAR(surges.volume_until(2), 2, 1e-12);
    EXPECT_NEAR(surges.volume_until(3), 8, 1e-12);
    EXPECT_NEAR(surges.volume_until(5), 12, 1e-12);
    EXPECT_NEAR(surges.volume(), 15, 1e-12);
    EXPECT_NEAR(surges.way_until(2), 2.5, 1e-12);
    EXPECT_NEAR(surges.volume_until(100), 15, 1e-12);
}

TEST(Inflow, integrates_mass_exactly) {
    const terrain::Inflow surge = inflow({{0, 0, 2, 1500}, {2, 6, 2, 2100}, {4, 6, 2, 1200}});
    // The integral of 3 t (1500 + 300 t), then of 6 (2100 - 450 t).
    EXPECT_NEAR(surge.mass_until(1), 1.5 * 1500 + 300, 1e-9);
    EXPECT_NEAR(surge.mass_until(2), 6 * 1500 + 2400, 1e-9);
    EXPECT_NEAR(surge.mass_until(9), 6 * 1500 + 2400 + 12 * 2100 - 900 * 6, 1e-9);
    EXPECT_NEAR(surge.density_between(2, 4), 1650, 1e-9);
    EXPECT_NEAR(surge.density_between(1, 1), 1800, 1e-9);
}

/// 8 x 5 m of the plane, some 35 m2 of it beside a hole.
terrain::Inflow rain(std::vector<params::InflowSample> hydrograph, std::optional<double> direction = {}) {
    terrain::Inflow over{"slope", {}, {}, std::move(hydrograph), {testing::rectangle(20.03, 17.53, 28.05, 22.56)}};
    over.spec.direction = direction;
    over.area.front().holes.push_back({{22, 19}, {24.5, 19}, {24.5, 21}, {22, 21}});
    return over;
}

TEST(Inflow, says_when_debris_came_in_if_its_pore_pressure_decays_from_then) {
    params::MaterialSpec material;
    material.pore_pressure_ratio = 0.6;
    const auto entries = [&](const terrain::Inflow& source) {
        const Model model = make_model(material, {}, 0.5);
        const Ground ground = plane();
        InflowFeeder feeder(model, ground.terrain.frame(), {source});
        State state;
        state.time_step = 0.05;
        for (state.time = 0; state.time < 63; state.time += state.time_step) feeder.inject(model, ground, state);
        EXPECT_GT(state.count, 20U);
        return state.entry_of_id;
    };
    const std::vector<params::InflowSample> late{{60, 8, 2}, {62, 8, 2}};
    EXPECT_TRUE(entries(inflow(late)).empty()) << "it is constant";
    material.pore_pressure_decay_time = 2;
    for (const terrain::Inflow& source : {inflow(late), rain(late)}) {
        double before = 60;
        for (const Entry& entry : entries(source)) {
            EXPECT_GE(entry.time, before - 1e-4) << source.name;
            EXPECT_LE(entry.time, 62.06) << source.name;
            EXPECT_LT(entry.pore_pressure_ratio, 0) << source.name;
            before = entry.time;
        }
        EXPECT_GT(before, 61.5) << source.name;
    }
}

TEST(AreaSource, brings_the_volume_to_the_particle_evenly_over_the_area) {
    for (const double step : {0.001, 0.0137, 0.4}) {
        const Model model = make_model({}, {}, testing::fine_spacing);
        const Ground ground = plane();
        const terrain::Inflow source = rain({{0.5, 0, 0}, {1, 8, 1}, {2, 0, 1}, {3, 4, 2}, {3.3, 0, 2}});
        InflowFeeder feeder(model, ground.terrain.frame(), {source});
        const std::uint32_t all = feeder.remaining();
        EXPECT_EQ(all, std::lround(source.volume() / model.particle_volume()));
        State state;
        state.resize(all);
        for (state.time = 0; state.time < 4; state.time += step) {
            if (feeder.due(state.time)) feeder.inject(model, ground, state);
            EXPECT_EQ(state.count, std::floor(source.volume_until(state.time) / model.particle_volume() + 0.5));
        }
        EXPECT_EQ(state.count, all) << step;
        int upper = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const WorldPoint p = ground.terrain.frame().to_world(state.position.at(i));
            EXPECT_TRUE(contains(source.area.front(), {p.x, p.y})) << p.x << " " << p.y;
            upper += p.x < 24 ? 1 : 0;
            for (std::uint32_t j = 0; j < i; ++j) {
                EXPECT_GE(length(state.position.at(i) - state.position.at(j)), 0.999 * testing::fine_spacing);
            }
        }
        EXPECT_NEAR(upper / static_cast<double>(all), 16.0 / 35, 0.06);
    }
}

TEST(AreaSource, debris_moves_down_the_slope_or_where_it_is_told) {
    const Model model = make_model({}, {}, testing::fine_spacing);
    const Ground ground = plane();
    const double cosine = std::cos(25 * M_PI / 180), sine = std::sin(25 * M_PI / 180);
    for (const bool told : {false, true}) {
        InflowFeeder feeder(model, ground.terrain.frame(),
                            {rain({{0, 10, 3}, {1, 10, 3}}, told ? std::optional(0.0) : std::nullopt)});
        State state;
        state.resize(feeder.remaining());
        state.time = 0.5;
        feeder.inject(model, ground, state);
        ASSERT_GT(state.count, 50U);
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const LocalPoint v = state.velocity.at(i);
            EXPECT_NEAR(v.x, told ? 0 : 3 * cosine, 1e-4);
            EXPECT_NEAR(v.y, told ? 3 : 0, 1e-4);
            EXPECT_NEAR(v.z, told ? 0 : -3 * sine, 1e-4);
        }
    }
}

TEST(AreaSource, does_not_pop_apart_even_where_debris_piles_up) {
    // 60 m3 onto 35 m2 in 4 s, with friction enough for it to stay: it lies in layers on top of each other.
    params::MaterialSpec rough;
    rough.friction_coefficient = 0.9;
    const Model model = make_model(rough, {}, testing::fine_spacing);
    const Ground ground = plane();
    InflowFeeder feeder(model, ground.terrain.frame(), {rain({{0, 15, 0}, {4, 15, 0}})});
    Simulation simulation(model, ground, State{}, std::move(feeder));
    double worst = 0, fastest = 0;
    while (simulation.state().time < 4.5) {
        EXPECT_TRUE(simulation.advance());
        worst = std::max(worst, simulation.state().max_compression);
        fastest = std::max(fastest, simulation.state().max_speed);
    }
    EXPECT_EQ(simulation.inflow().remaining(), 0U);
    EXPECT_LT(worst, 0.1);
    EXPECT_LT(fastest, std::sqrt(2 * 9.81 * 1.7)) << "a fall from the top of the pile";
}

TEST(AreaSource, an_area_smaller_than_a_particle_still_brings_its_volume) {
    terrain::Inflow spring = rain({{0, 2, 1}, {2, 2, 1}});
    spring.area = {testing::rectangle(20.01, 20.01, 20.06, 20.05)};
    const Model model = make_model({}, {}, testing::fine_spacing);
    const Ground ground = plane();
    InflowFeeder feeder(model, ground.terrain.frame(), {spring});
    State state;
    state.resize(feeder.remaining());
    state.time = 3;
    feeder.inject(model, ground, state);
    EXPECT_EQ(state.count, std::lround(4 / model.particle_volume()));
}

TEST(InflowFeeder, gives_particles_the_density_of_the_hydrograph) {
    for (const bool over_area : {false, true}) {
        const std::vector<params::InflowSample> rows{{0, 20, 4, 1400}, {1, 20, 4, 2200}, {2, 20, 4, 1800}};
        const terrain::Inflow surge = over_area ? rain(rows) : inflow(rows);
        const Model model = make_model({}, {}, testing::fine_spacing);
        const Ground ground = plane();
        InflowFeeder feeder(model, ground.terrain.frame(), {surge});
        State state;
        state.resize(feeder.remaining());
        for (state.time = 0; state.time < 2.5; state.time += 0.01) {
            if (feeder.due(state.time)) feeder.inject(model, ground, state);
        }
        double mass = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) mass += density_of(model, state, i) * model.particle_volume();
        EXPECT_NEAR(mass, surge.mass_until(2), 0.005 * surge.mass_until(2));
        EXPECT_LT(density_of(model, state, 0), 1480);
        EXPECT_NEAR(density_of(model, state, state.count - 1), 1800, 60);
        const std::uint32_t more = add_particle(state, {}, {}, 0);
        EXPECT_EQ(density_of(model, state, more), model.rest_density) << "what the bed gives later has its own";
    }
}

TEST(InflowFeeder, brings_the_volume_to_the_particle_whatever_the_steps) {
    for (const double step : {0.001, 0.0137, 0.4}) {
        const Model model = make_model({}, {}, testing::fine_spacing);
        const Ground ground = plane();
        const terrain::Inflow surges =
            inflow({{0.5, 0, 3}, {1, 20, 5}, {2, 0, 4}, {2.5, 0, 0}, {3, 10, 2}, {3.3, 0, 2}});
        InflowFeeder feeder(model, ground.terrain.frame(), {surges});
        const std::uint32_t all = feeder.remaining();
        EXPECT_EQ(all, std::lround(surges.volume() / model.particle_volume()));
        State state;
        state.resize(all);
        for (state.time = 0; state.time < 4; state.time += step) {
            if (feeder.due(state.time)) feeder.inject(model, ground, state);
            EXPECT_EQ(state.count, state.seeded);
            // What has not filled a row yet is still outside.
            const double in = surges.volume_until(state.time) / model.particle_volume();
            EXPECT_LE(state.count, in + 1);
        }
        EXPECT_EQ(state.count, all) << step;
        EXPECT_EQ(feeder.remaining(), 0U);
    }
}

TEST(InflowFeeder, new_debris_is_no_denser_than_at_rest_and_moves_with_the_inflow) {
    const Model model = make_model({}, {}, testing::fine_spacing);
    const Ground ground = plane();
    const double thickness = 1.2, velocity = 5;
    InflowFeeder feeder(model, ground.terrain.frame(),
                        {inflow({{0, 6 * thickness * velocity, velocity}, {9, 6 * thickness * velocity, velocity}})});
    Simulation simulation(model, ground, State{}, std::move(feeder));
    double worst = 0, fastest = 0;
    while (simulation.state().time < 2) {
        EXPECT_TRUE(simulation.advance());
        worst = std::max(worst, simulation.state().max_compression);
        for (std::uint32_t i = 0; i < simulation.state().count; ++i) {
            const LocalPoint v = simulation.state().velocity.at(i);
            const double x =
                simulation.state().position.x[i] - simulation.ground().terrain.frame().to_local({20, 0, 0}).x;
            if (x < 2 * testing::fine_spacing) fastest = std::max<double>(fastest, length(v));
        }
    }
    EXPECT_GT(simulation.state().count, 500U);
    EXPECT_LT(worst, 0.1);
    EXPECT_LT(fastest, 1.1 * velocity);
}

TEST(InflowFeeder, allocates_nothing_while_it_runs) {
    const Model model = make_model({}, {}, testing::fine_spacing);
    const Ground ground = plane();
    InflowFeeder feeder(model, ground.terrain.frame(), {inflow({{0, 30, 5}, {5, 30, 5}})});
    Simulation simulation(model, ground, State{}, std::move(feeder));
    while (simulation.state().time < 1.5) {
        EXPECT_TRUE(simulation.advance());
    }
    const long before = test::allocation_count();
    const std::uint32_t count = simulation.state().count;
    for (int k = 0; k < 40; ++k) {
        EXPECT_TRUE(simulation.advance());
    }
    EXPECT_GT(simulation.state().count, count + 50);
    EXPECT_LE(test::allocation_count() - before, 20) << "neighbour lists may grow with the debris, nothing else does";
}

}  // namespace
}  // namespace talus::sim
