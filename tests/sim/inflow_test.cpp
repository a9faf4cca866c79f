#include "sim/inflow.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "sim_fixtures.hpp"
#include "support/allocations.hpp"

namespace talus {
namespace {

using testing::inclined_plane;

constexpr double spacing = 0.4;

/// 6 m wide at x = 20, towards +x: down the plane of sim_fixtures.
Inflow inflow(std::vector<InflowSample> hydrograph) {
    return {"gully", {20, 17}, {20, 23}, std::move(hydrograph)};
}

Model plane() {
    return make_model({}, {}, inclined_plane(25), {}, spacing);
}

void let_in(Simulation& simulation, InflowFeeder& feeder) {
    if (!feeder.due(simulation.state().time)) return;
    simulation.change([&](Model& m, State& s) { feeder.feed(m, s); });
}

TEST(Inflow, integrates_the_hydrograph_exactly) {
    const Inflow surges = inflow({{1, 0, 2}, {3, 8, 4}, {4, 0, 4}, {6, 0, 1}, {7, 6, 1}});
    EXPECT_EQ(surges.volume_until(0.5), 0);
    EXPECT_NEAR(surges.volume_until(2), 2, 1e-12);
    EXPECT_NEAR(surges.volume_until(3), 8, 1e-12);
    EXPECT_NEAR(surges.volume_until(5), 12, 1e-12);
    EXPECT_NEAR(surges.volume(), 15, 1e-12);
    EXPECT_NEAR(surges.way_until(2), 2.5, 1e-12);
    EXPECT_NEAR(surges.volume_until(100), 15, 1e-12);
}

TEST(InflowFeeder, brings_the_volume_to_the_particle_whatever_the_steps) {
    for (const double step : {0.001, 0.0137, 0.4}) {
        const Model model = plane();
        const Inflow surges = inflow({{0.5, 0, 3}, {1, 20, 5}, {2, 0, 4}, {2.5, 0, 0}, {3, 10, 2}, {3.3, 0, 2}});
        InflowFeeder feeder(model, {surges});
        const std::uint32_t all = feeder.to_come();
        EXPECT_EQ(all, std::lround(surges.volume() / model.particle_volume()));
        State state;
        state.resize(all);
        for (state.time = 0; state.time < 4; state.time += step) {
            if (feeder.due(state.time)) feeder.feed(model, state);
            EXPECT_EQ(state.count, state.seeded);
            // What has not filled a row yet is still outside.
            const double in = surges.volume_until(state.time) / model.particle_volume();
            EXPECT_LE(state.count, in + 1);
        }
        EXPECT_EQ(state.count, all) << step;
        EXPECT_EQ(feeder.to_come(), 0U);
    }
}

TEST(InflowFeeder, new_debris_is_no_denser_than_at_rest_and_moves_with_the_inflow) {
    const Model model = plane();
    const double thickness = 1.2, velocity = 5;
    InflowFeeder feeder(model,
                        {inflow({{0, 6 * thickness * velocity, velocity}, {9, 6 * thickness * velocity, velocity}})});
    Simulation simulation(model, State{}, feeder.to_come());
    double worst = 0, fastest = 0;
    while (simulation.state().time < 2) {
        let_in(simulation, feeder);
        simulation.advance();
        worst = std::max(worst, simulation.state().max_compression);
        for (std::uint32_t i = 0; i < simulation.state().count; ++i) {
            const LocalPoint v = simulation.state().velocity.at(i);
            const double x =
                simulation.state().position.x[i] - simulation.model().terrain.frame().to_local({20, 0, 0}).x;
            if (x < 2 * spacing) fastest = std::max<double>(fastest, length(v));
        }
    }
    EXPECT_GT(simulation.state().count, 500U);
    EXPECT_LT(worst, 0.1);
    EXPECT_LT(fastest, 1.1 * velocity);
}

TEST(InflowFeeder, allocates_nothing_while_it_runs) {
    const Model model = plane();
    InflowFeeder feeder(model, {inflow({{0, 30, 5}, {5, 30, 5}})});
    Simulation simulation(model, State{}, feeder.to_come());
    while (simulation.state().time < 1.5) {
        let_in(simulation, feeder);
        simulation.advance();
    }
    const long before = test::allocation_count();
    const std::uint32_t count = simulation.state().count;
    for (int k = 0; k < 40; ++k) {
        let_in(simulation, feeder);
        simulation.advance();
    }
    EXPECT_GT(simulation.state().count, count + 50);
    EXPECT_LE(test::allocation_count() - before, 20) << "neighbour lists may grow with the debris, nothing else does";
}

}  // namespace
}  // namespace talus
