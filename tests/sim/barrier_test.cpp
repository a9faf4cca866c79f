#include "terrain/barrier.hpp"

#include <random>

#include <gtest/gtest.h>

#include "sim/change.hpp"
#include "sim/physics/contact.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

using testing::state_of;
using testing::terrain_of;

Model wall_model() {
    params::MaterialSpec material;
    material.friction_coefficient = 0.2;
    return make_model(material, {}, 0.5);
}

/// Level ground with a thin wall across it at x = 20, its slot 2 m wide around y = 20.
Ground walled(bool slot) {
    const terrain::Terrain terrain = terrain_of(60, 40, 1, [](double, double) { return 10; });
    params::BarrierSpec shape{{{20, 2}, {21, 20}, {20, 38}}, 6, {}, 0.3, {}};
    if (slot) shape.openings = {{std::hypot(1, 18), 2, 0}};
    const auto wall = make_barrier(terrain, "wall", shape);
    EXPECT_TRUE(wall);
    return {terrain, {*wall}, wall_model().support_radius};
}

/// Where the wall's middle is at a plan y, local.
double wall_x(const Ground& ground, float y) {
    const WorldPoint origin = ground.terrain.frame().origin;
    return 20 + 1 - std::abs(y + origin.y - 20) / 18 - origin.x;
}

TEST(Barrier, nothing_gets_through_it_at_any_speed) {
    const Model model = wall_model();
    const Ground ground = walled(false);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> along(-15, 15), height(0.1F, 5), speed(1, 3000);
    for (int k = 0; k < 20000; ++k) {
        const LocalPoint start{static_cast<float>(wall_x(ground, 0)) - 4, along(random), height(random)};
        const LocalPoint way = {0.05F * speed(random), 0.2F * along(random), 0};
        const LocalPoint end = free_end(model, ground, start, way);
        ASSERT_LT(end.x, wall_x(ground, end.y)) << way.x << " m in a step from y = " << start.y << ", z = " << start.z;
    }
}

TEST(Barrier, a_run_leaves_debris_only_through_its_slot) {
    for (const bool slot : {false, true}) {
        std::vector<LocalPoint> points;
        for (int k = 0; k < 3; ++k) {
            for (int j = 0; j < 24; ++j) {
                for (int i = 0; i < 8; ++i) {
                    points.push_back({-18 + 0.5F * static_cast<float>(i), -6 + 0.5F * static_cast<float>(j),
                                      0.25F + 0.5F * static_cast<float>(k)});
                }
            }
        }
        State start = state_of(points, std::vector<LocalPoint>(points.size(), {60, 0, 0}));
        Simulation simulation(wall_model(), walled(slot), std::move(start));
        std::uint32_t beyond = 0;
        for (int step = 0; step < 400; ++step) {
            EXPECT_TRUE(simulation.advance());
            const State& state = simulation.state();
            beyond = 0;
            for (std::uint32_t i = 0; i < state.count; ++i) {
                const LocalPoint p = state.position.at(i);
                ASSERT_FALSE(simulation.ground().solids.inside(p));
                // Splashes may go over it: 6 m.
                beyond += p.x > wall_x(simulation.ground(), p.y) && p.z < 5;
            }
            if (!slot) {
                ASSERT_LE(beyond, simulation.state().count / 4);
            }
        }
        if (slot) {
            EXPECT_GT(beyond, 20U);
        }
    }
}

TEST(TakeDown, frees_what_lay_against_a_wall) {
    std::vector<LocalPoint> points;
    for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 8; ++j) {
            for (int i = 0; i < 8; ++i) {
                points.push_back({-14 + 0.5F * static_cast<float>(i), -2 + 0.5F * static_cast<float>(j),
                                  0.25F + 0.5F * static_cast<float>(k)});
            }
        }
    }
    Simulation simulation(wall_model(), walled(false), state_of(points));
    for (int step = 0; step < 200; ++step) EXPECT_TRUE(simulation.advance());
    simulation.change([](Model& m, Ground& g, State& s) { remove_building(m, g, s, 0); });
    EXPECT_FALSE(stands(simulation.ground().buildings[0]));
    EXPECT_TRUE(simulation.ground().solids.empty());
    for (int step = 0; step < 200; ++step) EXPECT_TRUE(simulation.advance());
    float farthest = -100;
    for (std::uint32_t i = 0; i < simulation.state().count; ++i) {
        farthest = std::max(farthest, simulation.state().position.x[i]);
    }
    EXPECT_GT(farthest, -9.5F) << "the wall stood at about -9.2 there";
}

}  // namespace
}  // namespace talus::sim
