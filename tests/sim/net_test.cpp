#include "sim/physics/net.hpp"

#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "sim/change.hpp"
#include "sim/physics/contact.hpp"
#include "sim_fixtures.hpp"
#include "terrain/barrier.hpp"

namespace talus::sim {
namespace {

using testing::state_of;
using testing::terrain_of;

TEST(GrainRank, is_spread_evenly_over_any_run_of_ids) {
    for (const std::uint32_t first : {0U, 5000U, 4000000000U}) {
        for (const float share : {0.1F, 0.5F, 0.9F}) {
            int passing = 0, pairs = 0;
            constexpr int ids = 20000;
            for (std::uint32_t k = 0; k < ids; ++k) {
                const bool passes = grain_rank(first + k) < share;
                passing += passes;
                pairs += passes && grain_rank(first + k + 1) < share;
            }
            EXPECT_NEAR(passing, ids * share, 4 * std::sqrt(ids * share * (1 - share)));
            EXPECT_NEAR(pairs, ids * share * share, 0.03 * ids) << "neighbours follow each other";
        }
    }
    EXPECT_GE(grain_rank(0), 0);
    EXPECT_LT(grain_rank(0xffffffffU), 1);
}

Model net_model(const params::SolverSpec& solver = {}) {
    params::MaterialSpec material;
    material.friction_coefficient = 0.2;
    return make_model(material, solver, 0.5);
}

/// Level ground with a net of 6 m across it at x = 20.
Ground netted(std::optional<double> passing_share, bool stands = true) {
    const terrain::Terrain terrain = terrain_of(60, 40, 1, [](double, double) { return 10; });
    std::vector<terrain::Building> buildings;
    if (stands) {
        const auto net = make_barrier(terrain, "net", {{{20, 2}, {21, 20}, {20, 38}}, 6, {}, 0.5, {}, passing_share});
        EXPECT_TRUE(net);
        buildings.push_back(*net);
    }
    return {terrain, buildings, net_model().support_radius};
}

/// Where the net's middle is at a plan y, local.
double net_x(const Ground& ground, float y) {
    const WorldPoint origin = ground.terrain.frame().origin;
    return 20 + 1 - std::abs(y + origin.y - 20) / 18 - origin.x;
}

/// Debris thrown at the net.
Simulation thrown(Ground ground, const params::SolverSpec& solver = {}, float speed = 15) {
    std::vector<LocalPoint> points;
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 24; ++j) {
            for (int i = 0; i < 10; ++i) {
                points.push_back({-18 + 0.5F * static_cast<float>(i), -6 + 0.5F * static_cast<float>(j),
                                  0.25F + 0.5F * static_cast<float>(k)});
            }
        }
    }
    State start = state_of(points, std::vector<LocalPoint>(points.size(), {speed, 0, 0}));
    return {net_model(solver), std::move(ground), std::move(start)};
}

TEST(Net, stops_coarse_grains_at_any_speed_and_fine_ones_at_none) {
    const Model model = net_model();
    const Ground ground = netted(0.4);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> along(-15, 15), height(0.1F, 5), speed(1, 3000), rank(0, 1);
    for (int k = 0; k < 20000; ++k) {
        const LocalPoint start{static_cast<float>(net_x(ground, 0)) - 4, along(random), height(random)};
        const LocalPoint way = {0.05F * speed(random), 0.2F * along(random), 0};
        const float grain = rank(random);
        const LocalPoint end = free_end(model, ground, start, way, grain);
        if (grain < 0.4F) {
            ASSERT_EQ(end.x, start.x + way.x);
        } else {
            ASSERT_LT(end.x, net_x(ground, end.y)) << way.x << " m in a step from y = " << start.y;
        }
    }
}

TEST(Net, holds_coarse_grains_that_a_step_would_carry_past_it) {
    params::SolverSpec solver;
    solver.time_step = 0.02;
    Simulation simulation = thrown(netted(0.4), solver, 150);  // 3 m in a step
    std::uint32_t fine_beyond = 0;
    for (int step = 0; step < 5; ++step) {
        (void)simulation.advance();  // such an impact may be a fault
        const State& state = simulation.state();
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const LocalPoint p = state.position.at(i);
            if (p.x < net_x(simulation.ground(), p.y) || p.z > 5) continue;
            ASSERT_LT(grain_rank(state.id[i]), 0.4F) << "step " << step;
            ++fine_beyond;
        }
    }
    EXPECT_GT(fine_beyond, 50U);
}

TEST(Net, holds_its_share_of_a_run_and_lets_some_of_the_rest_through) {
    for (const params::InternalFriction friction : {params::InternalFriction::stress, params::InternalFriction::pair}) {
        params::SolverSpec solver;
        solver.internal_friction = friction;
        Simulation simulation = thrown(netted(0.5), solver);
        std::uint32_t through = 0;
        double impulse = 0;
        std::vector<bool> beyond(simulation.state().seeded);
        std::vector<float> height(simulation.state().seeded);
        for (int step = 0; step < 300; ++step) {
            EXPECT_TRUE(simulation.advance());
            const State& state = simulation.state();
            ASSERT_EQ(state.count + state.outflow, state.seeded);
            for (const BuildingContact& contact : state.building_contacts) {
                ASSERT_GE(grain_rank(state.id[contact.particle]), 0.5F) << "a grain that passes bears on the net";
                impulse += contact.impulse;
            }
            for (std::uint32_t i = 0; i < state.count; ++i) {
                const LocalPoint p = state.position.at(i);
                const std::uint32_t id = state.id[i];
                const float rank = grain_rank(id);
                ASSERT_FALSE(simulation.ground().solids.inside(p, rank));
                const bool now = p.x > net_x(simulation.ground(), p.y);
                // Splashes may go over it: 6 m.
                const bool crosses = now && !beyond[id] && std::max(p.z, height[id]) < 5;
                ASSERT_FALSE(crosses && rank >= 0.5F) << "step " << step;
                through += crosses;
                beyond[id] = now;
                height[id] = p.z;
            }
        }
        EXPECT_GT(through, 50U);
        EXPECT_GT(impulse, 0);
    }
}

std::uint64_t hash_after(Ground ground, int threads = 0) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads > 0 ? threads : 2));
    Simulation simulation = thrown(std::move(ground));
    for (int step = 0; step < 120; ++step) EXPECT_TRUE(simulation.advance());
    return hash_state(simulation.state());
}

TEST(Net, without_meshes_is_a_wall_and_with_meshes_for_everything_is_not_there) {
    const std::uint64_t wall = hash_after(netted({})), none = hash_after(netted({}, false));
    EXPECT_EQ(hash_after(netted(0)), wall);
    EXPECT_EQ(hash_after(netted(1)), none);
    EXPECT_NE(wall, none);
}

TEST(Net, gives_the_same_bits_on_1_and_2_threads) {
    const std::uint64_t one = hash_after(netted(0.5), 1);
    EXPECT_EQ(hash_after(netted(0.5), 2), one);
    EXPECT_NE(hash_after(netted(0.3), 2), one);
}

TEST(Net, put_up_in_debris_pushes_only_what_it_holds_aside) {
    std::vector<LocalPoint> points;
    for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 12; ++j) {
            for (int i = 0; i < 14; ++i) {
                points.push_back({-12.4F + 0.5F * static_cast<float>(i), -3 + 0.5F * static_cast<float>(j),
                                  0.25F + 0.5F * static_cast<float>(k)});
            }
        }
    }
    Simulation simulation(net_model(), netted(0.5, false), state_of(points));
    for (int step = 0; step < 60; ++step) EXPECT_TRUE(simulation.advance());
    simulation.change([&](Model& m, Ground& g, State& s) {
        g = netted(0.5);
        clear_solids(m, g, s, {-100, -100, 100, 100});
    });
    const State& state = simulation.state();
    int fine_within = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const LocalPoint p = state.position.at(i);
        const float rank = grain_rank(state.id[i]);
        EXPECT_FALSE(simulation.ground().solids.inside(p, rank));
        fine_within += rank < 0.5F && simulation.ground().solids.inside(p);
    }
    EXPECT_GT(fine_within, 10);
}

}  // namespace
}  // namespace talus::sim
