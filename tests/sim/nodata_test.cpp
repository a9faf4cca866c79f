#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "sim/reference/reference.hpp"
#include "sim/step.hpp"
#include "sim_fixtures.hpp"
#include "simd/dispatch.hpp"

namespace talus::sim {
namespace {

using reference::Vector;

/// Where an elevation model has no data, in the way of the debris. The lowest cell, which sets the frame, is known.
struct Gap {
    const char* name;
    bool (*has)(double x, double y);
};

const Gap gaps[] = {
    {"cell", [](double x, double y) { return std::abs(x - 24.5) < 0.6 && std::abs(y - 20.5) < 0.6; }},
    {"square", [](double x, double y) { return std::abs(x - 28) < 4 && std::abs(y - 20) < 4; }},
    {"disc", [](double x, double y) { return std::hypot(x - 28, y - 20) < 4; }},
    {"collar", [](double x, double y) { return x > 20 + 0.3 * y && y > 2; }},
};

class Nodata : public ::testing::TestWithParam<std::tuple<Gap, params::InternalFriction>> {
  protected:
    static terrain::Terrain plane(const Gap* gap) {
        return testing::terrain_of(60, 40, 1, [&](double x, double y) {
            return gap && gap->has(x, y) ? std::numeric_limits<double>::quiet_NaN() : 200 - 0.6 * x;
        });
    }
    /// Viscous debris that is slowed by the ground in every way, above the gap.
    static Simulation debris(const terrain::Terrain& terrain) {
        params::SolverSpec solver;
        solver.internal_friction = std::get<1>(GetParam());
        params::MaterialSpec material;
        material.turbulent_friction = 500;
        material.viscosity = 0.2;
        return testing::simulate(material, solver, terrain,
                                 {testing::block(terrain, testing::rectangle(17, 17, 23, 24), 1.2)}, 0.5);
    }
    [[nodiscard]] static const Gap& gap() { return std::get<0>(GetParam()); }
};

TEST_P(Nodata, is_left_by_the_debris_that_meets_it_and_nothing_is_lost) {
    const terrain::Terrain terrain = plane(&gap());
    Simulation simulation = debris(terrain);
    const State& state = simulation.state();
    while (state.time < 4) {
        const Status stepped = simulation.advance();
        ASSERT_TRUE(stepped) << stepped.error().message;
        ASSERT_EQ(state.count + state.outflow, state.seeded);
        for (std::uint32_t i = 0; i < state.count; ++i) {
            ASSERT_TRUE(terrain.covers(state.position.x[i], state.position.y[i])) << "at t = " << state.time;
        }
    }
    EXPECT_GT(state.outflow, 20U);
}

TEST_P(Nodata, does_not_move_the_neighbours_of_what_leaves) {
    Simulation simulation = debris(plane(&gap())), complete = debris(plane(nullptr));
    reference::Backend backend;
    StageTimes times;
    while (simulation.state().outflow == 0) {
        reference::State exact(simulation.state());
        ASSERT_TRUE(simulation.advance());
        ASSERT_TRUE(complete.advance());
        ASSERT_LT(simulation.state().time, 4);
        if (simulation.state().outflow == 0) continue;
        exact.time_step = simulation.state().time_step;
        step(backend, simulation.model(), simulation.ground(), exact, times);
        const State& all = complete.state();
        std::vector<LocalPoint> unhindered(all.seeded);
        for (std::uint32_t i = 0; i < all.count; ++i) unhindered[all.id[i]] = all.position.at(i);
        for (std::uint32_t i = 0; i < simulation.state().count; ++i) {
            const std::uint32_t id = simulation.state().id[i];
            const LocalPoint p = simulation.state().position.at(i);
            const Vector& expected = exact.particles[id].position;
            EXPECT_LT(length(p - unhindered[id]), 1e-3);
            EXPECT_LT(length(Vector{p.x, p.y, p.z} - expected), 2e-4);
        }
    }
}

TEST_P(Nodata, gives_the_same_bits_on_every_instruction_set) {
    const std::vector<std::string> sets = simd::instruction_sets();
    std::uint64_t expected = 0;
    for (const std::string& set : sets) {
        ASSERT_TRUE(simd::choose_instruction_set(set));
        Simulation simulation = debris(plane(&gap()));
        for (int i = 0; i < 150; ++i) ASSERT_TRUE(simulation.advance());
        EXPECT_GT(simulation.state().outflow, 0U);
        const std::uint64_t hash = hash_state(simulation.state());
        if (set == sets.front()) expected = hash;
        EXPECT_EQ(hash, expected) << set;
    }
    ASSERT_TRUE(simd::choose_instruction_set(sets.front()));
}

INSTANTIATE_TEST_SUITE_P(Terrain, Nodata,
                         ::testing::Combine(::testing::ValuesIn(gaps),
                                            ::testing::Values(params::InternalFriction::stress,
                                                              params::InternalFriction::pair)),
                         [](const auto& one) {
                             return std::string(std::get<0>(one.param).name) +
                                    (std::get<1>(one.param) == params::InternalFriction::pair ? "_pair" : "_stress");
                         });

}  // namespace
}  // namespace talus::sim
