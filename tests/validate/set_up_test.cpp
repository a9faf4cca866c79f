#include "validate/set_up.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace talus::validate {
namespace {

TEST(Trial, shows_what_a_device_has_moved_after_every_step_and_at_the_end) {
    const Incline incline(0.5, 20, 20);
    params::MaterialSpec material;
    material.friction_coefficient = 0.1;
    sim::Model model = sim::make_model(material, {}, 0.5);
    sim::Ground ground(incline.terrain());
    const auto points = fill_lattice(incline, 0.5, -1, 4, -1, 4, [](double, double) { return 1.0; });
    Watch watch;
    watch.backend = params::BackendChoice::host;
    Trial trial({std::move(model), std::move(ground), state_at_rest(points)}, watch);
    const sim::State& state = trial.state();
    const auto fastest = [&] {
        float most = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) most = std::max(most, state.velocity.x[i]);
        return most;
    };
    ASSERT_TRUE(trial.advance_to(0.2));
    const float before = fastest();
    EXPECT_GT(before, 0.1F);
    std::vector<float> speeds;
    ASSERT_TRUE(trial.advance_to(0.5, [&] { speeds.push_back(fastest()); }));
    ASSERT_GT(speeds.size(), 2U);
    EXPECT_GT(speeds[0], before);
    EXPECT_GT(speeds[1], speeds[0]);
    EXPECT_EQ(fastest(), speeds.back());
}

TEST(Trial, takes_no_step_that_is_too_long_for_the_viscosity) {
    const Incline incline(0.5, 20, 6);
    const auto problem = [&](double viscosity) {
        params::MaterialSpec material;
        material.viscosity = viscosity;
        params::SolverSpec solver;
        solver.time_step = 1.0 / 120;
        const Watch watch;
        Trial trial({sim::make_model(material, solver, 0.5), sim::Ground(incline.terrain()),
                     state_at_rest({incline.point(0, 0, 0.25)})},
                    watch);
        return std::pair(trial.advance_to(0.1), trial.problem());
    };
    EXPECT_EQ(problem(2), std::pair(true, std::string()));
    EXPECT_EQ(
        problem(2.1),
        std::pair(false, std::string("the viscosity needs steps of at most 0.00794 s, the case takes 0.00833 s")));
}

TEST(OpeningGate, opens_evenly_from_the_middle_over_its_whole_width) {
    const std::vector<GateLeaf> leaves = opening_gate(2, 0.8, 10);
    ASSERT_EQ(leaves.size(), 20);
    for (double t = 0; t <= 0.8; t += 0.01) {
        double open = 0, edge = 0;
        for (const GateLeaf& leaf : leaves) {
            if (leaf.gone > t) continue;
            open += leaf.to - leaf.from;
            edge = std::max({edge, -leaf.from, leaf.to});
        }
        EXPECT_NEAR(open / 2, t / 0.8, 0.05 + 1e-9) << t;
        EXPECT_NEAR(2 * edge, open, 1e-9) << "a gap in the middle";
    }
    for (const GateLeaf& leaf : opening_gate(2, 0, 3)) EXPECT_EQ(leaf.gone, 0);
}

TEST(Trial, holds_debris_behind_a_wall_until_that_is_taken_away) {
    const Incline incline(0.5, 20, 6);
    params::MaterialSpec material;
    material.friction_coefficient = 0.1;
    sim::Model model = sim::make_model(material, {}, 0.5);
    const double below = incline.point(1.5, 0, 0).x;
    std::vector<terrain::Building> walls = make_slice(incline.terrain(), 2, 5);
    walls.push_back(make_wall(incline.terrain(), below, -3, below + 0.2, 3, 5));
    sim::Ground ground(incline.terrain(), walls, model.support_radius);
    const auto points = fill_lattice(incline, 0.5, -1, 4, -1, 4, [](double, double) { return 1.0; });
    Watch watch;
    watch.thread_count = 1;
    Trial trial({std::move(model), std::move(ground), state_at_rest(points)}, watch);
    const auto front = [&] {
        const auto& x = trial.state().position.x;
        return *std::max_element(x.begin(), x.begin() + trial.state().count) + trial.ground().terrain.frame().origin.x;
    };
    ASSERT_TRUE(trial.advance_to(2));
    EXPECT_LT(front(), below);
    trial.remove_wall(2);
    ASSERT_TRUE(trial.advance_to(3));
    EXPECT_GT(front(), below + 1);
}

TEST(Trial, moves_debris_alike_whether_its_walls_and_maps_are_observed_or_not) {
    const Watch watch;
    const auto start = [] {
        terrain::Terrain terrain = make_terrain(12, 8, 1, [](double, double) { return 0.0; });
        const std::vector<terrain::Building> walls = make_slice(terrain, 1.5, 3);
        params::MaterialSpec material;
        material.friction_coefficient = 0.1;
        sim::Model model = sim::make_model(material, {}, 0.5);
        sim::Ground ground(terrain, walls, model.support_radius);
        return run::RunStart{std::move(model), std::move(ground), state_at_rest(fill_block(0, 0, 4, 3, 4, 0.5))};
    };
    Trial observed(start(), watch, OnFault::stop, Observed::yes), plain(start(), watch);
    ASSERT_TRUE(observed.advance_to(1));
    ASSERT_TRUE(plain.advance_to(1));
    EXPECT_EQ(plain.state().position.x, observed.state().position.x);
    EXPECT_GT(observed.observer().impacts()[0].impulse, 0);
    EXPECT_EQ(plain.observer().impacts()[0].impulse, 0);
    EXPECT_GT(observed.observer().timeseries().size(), plain.observer().timeseries().size());
}

}  // namespace
}  // namespace talus::validate
