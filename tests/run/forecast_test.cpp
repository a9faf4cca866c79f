#include "run/forecast.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>

#include "run/run.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

namespace fs = std::filesystem;

sim::Model sliding(double friction) {
    sim::Model model;
    model.friction_coefficient = friction;
    model.particle_spacing = 1;
    model.rest_density = 2000;
    return model;
}

/// A plane that falls by `slope` eastwards.
sim::Ground plane(double slope) {
    Grid<float> heights(GridGeometry{0, 0, 2, 200, 20});
    for (int row = 0; row < 20; ++row) {
        for (int column = 0; column < 200; ++column) {
            heights.at(column, row) = static_cast<float>(500 - slope * 2 * column);
        }
    }
    return sim::Ground(terrain::Terrain(heights));
}

TEST(StopTimes, of_a_block_on_level_ground_is_its_speed_over_the_friction) {
    const SlidingBlock block{{-150, 0, 0}, {10, 0, 0}, 1};
    const auto stops = stop_times(sliding(0.25), plane(0), {block}, 0.1, 100);
    EXPECT_NEAR(stops.at(0), 10 / (0.25 * 9.80665), 0.15);
}

TEST(StopTimes, end_where_the_terrain_ends_and_at_the_horizon) {
    const SlidingBlock block{{-190, 0, 0}, {0, 0, 0}, 1};
    const double angle = std::atan(0.5), pull = 9.80665 * (std::sin(angle) - 0.25 * std::cos(angle));
    const double way = 389 / std::cos(angle);  // from the start to the last column of cell centres
    const auto stops = stop_times(sliding(0.25), plane(0.5), {block}, 0.1, 100);
    EXPECT_NEAR(stops.at(0), std::sqrt(2 * way / pull), 0.4);
    EXPECT_DOUBLE_EQ(stop_times(sliding(0.25), plane(0.5), {block}, 0.1, 3).at(0), 3);
}

TEST(StopTimes, a_late_block_starts_late) {
    const SlidingBlock early{{-150, 0, 0}, {10, 0, 0}, 1};
    SlidingBlock late = early;
    late.start = 7;
    const auto stops = stop_times(sliding(0.25), plane(0), {late, early}, 0.1, 100);
    EXPECT_NEAR(stops.at(1) - stops.at(0), 7, 1e-9);
}

params::SolverSpec solver() {
    params::SolverSpec spec;
    spec.end_time = 300;
    spec.stop_moving_share = 0.001;
    spec.stop_duration = 3;
    return spec;
}

/// Of debris that all moves, and stops everywhere at once.
Outlook coasting(double time) {
    return {.coasting = time, .half_stopped = time, .moving_share = 1, .enough_share = 0.001, .energy = 1};
}

TEST(TheClock, while_all_moves_the_end_is_that_of_the_blocks) {
    RunClock clock(solver());
    clock.tick(1, 10, [] { return coasting(30); });
    EXPECT_DOUBLE_EQ(clock.expected_end(), 43);
    EXPECT_NEAR(clock.wall_remaining(), 3.3, 1e-9);  // a tenth of a second of wall time per simulated second
    EXPECT_NEAR(clock.share_done(), 1 / 4.3, 1e-9);
}

TEST(TheClock, where_some_blocks_stop_much_later_debris_straggles) {
    RunClock even(solver()), uneven(solver());
    Outlook outlook = coasting(30);
    outlook.half_stopped = 26;
    even.tick(1, 10, [&] { return outlook; });
    EXPECT_DOUBLE_EQ(even.expected_end(), 43);
    outlook.half_stopped = 15;
    uneven.tick(1, 10, [&] { return outlook; });
    EXPECT_DOUBLE_EQ(uneven.expected_end(), 43 + (30. / 15 - 1.25) * (10 + 30) / 2);
}

TEST(TheClock, knows_that_energy_or_momentum_may_end_the_run_sooner) {
    for (const bool by_energy : {true, false}) {
        params::SolverSpec spec = solver();
        (by_energy ? spec.stop_energy_share : spec.stop_momentum_share) = by_energy ? 0.01 : 0.1;
        RunClock clock(spec), without(solver());
        for (double time = 1; time <= 40; time += 1) {
            Outlook outlook = coasting(200);
            outlook.energy = time < 10 ? time : 10 * std::exp(-(time - 10) / 20);
            clock.tick(time, time, [&] { return outlook; });
            without.tick(time, time, [&] { return outlook; });
        }
        EXPECT_NEAR(clock.expected_end(), 10 + 20 * std::log(100) + 3, 2) << by_energy;
        EXPECT_GT(without.expected_end(), 200);
    }
}

TEST(TheClock, never_passes_the_end_time) {
    RunClock clock(solver());
    clock.tick(1, 10, [] { return coasting(290); });
    EXPECT_DOUBLE_EQ(clock.expected_end(), 300);
}

TEST(TheClock, waits_for_what_is_still_to_come) {
    RunClock clock(solver());
    clock.tick(1, 10, [] {
        return Outlook{.coasting = 0, .moving_share = 0, .enough_share = 0.001, .energy = 1, .wait = 50};
    });
    EXPECT_DOUBLE_EQ(clock.expected_end(), 63);
}

TEST(TheClock, what_sleeps_costs_less) {
    RunClock awake(solver()), asleep(solver());
    Outlook outlook{.coasting = 20, .moving_share = 0.1, .enough_share = 0.001, .energy = 1};
    const auto fastest = [] { return coasting(25); };
    for (RunClock* clock : {&awake, &asleep}) clock->tick(0.5, 5, fastest);
    outlook.energy = 0.5;
    awake.tick(1, 10, [&] { return outlook; });
    outlook.cost_asleep = 0.25;
    asleep.tick(1, 10, [&] { return outlook; });
    EXPECT_DOUBLE_EQ(asleep.expected_end(), awake.expected_end());
    EXPECT_NEAR(asleep.wall_remaining(), awake.wall_remaining() * (0.25 + 0.75 * 0.2), 1e-9);
}

TEST(TheClock, steps_grow_longer_as_debris_comes_to_rest) {
    RunClock clock(solver());
    double time = 0, wall_time = 0;
    const auto look = [] { return coasting(30); };
    const auto step = [&](double length) { clock.tick(wall_time += 0.1, time += length, look); };
    for (int i = 0; i < 10; ++i) step(0.4);
    for (int i = 0; i < 100; ++i) step(0.1);
    EXPECT_NEAR(clock.wall_remaining(), 30 * (1 + 0.5) / 2 + 3 * 0.5,
                0.3);  // a second of wall time per simulated second
}

/// Debris of which ever less moves: half of it after every 10 s, which blocks that slide alone know nothing of.
TEST(TheClock, follows_the_decay_of_a_straggling_tail) {
    RunClock clock(solver());
    const double end = 10 * std::log2(1000) + 3;
    for (double time = 1; time < 90; time += 1) {
        const double share = std::exp2(-time / 10);
        clock.tick(time / 10, time, [&] {
            return Outlook{.coasting = 5, .moving_share = share, .enough_share = 0.001, .energy = std::exp(-time)};
        });
        if (share > 1.0 / 3 || time > end - 10) continue;  // before, the blocks count as well
        EXPECT_GT(clock.wall_remaining(), (end - time) / 20) << time;
        EXPECT_LT(clock.wall_remaining(), (end - time) / 5) << time;
    }
}

class ClockOfARun : public scene::SceneFolder {};

/// Estimate over truth of what is left of a run, from the first tenth to three quarters of it: least and greatest. It
/// is measured in the work of its steps, which falls with the debris that is awake, because other work on the machine
/// changes the pace.
struct Ratio {
    double least = 1e9, greatest = 0, end = 0;
};
Ratio ratio_of(const scene::Scene& scene) {
    const auto run = Run::start(scene);
    EXPECT_TRUE(run);
    if (!run) return {};
    struct Estimate {
        double done, left;
    };
    std::vector<Estimate> estimates;
    RunClock clock(scene.spec.solver);
    double done = 0;
    while ((*run)->advance()) {
        const sim::State& state = (*run)->state();
        done += 1 + static_cast<double>(state.awake) / std::max<double>(state.count, 1);
        clock.tick(done, state.time, [&] {
            Outlook outlook = outlook_of((*run)->simulation(), scene.spec.outputs.deposited_speed);
            for (const terrain::Inflow& inflow : scene.inflows) {
                outlook.wait = std::max(outlook.wait, inflow.hydrograph.back().time - state.time);
            }
            return outlook;
        });
        estimates.push_back({done, clock.wall_remaining()});
    }
    Ratio ratio;
    ratio.end = (*run)->state().time;
    for (const Estimate& e : estimates) {
        if (e.done < done / 10 || e.done > 0.75 * done) continue;
        ratio.least = std::min(ratio.least, e.left / (done - e.done));
        ratio.greatest = std::max(ratio.greatest, e.left / (done - e.done));
    }
    return ratio;
}

TEST_F(ClockOfARun, of_a_valley_is_right_to_a_factor_of_two) {
    write_valley("");
    const scene::Scene scene = loaded({"solver.target_particle_count=400", "solver.end_time_s=200"});
    const Ratio ratio = ratio_of(scene);
    EXPECT_LT(ratio.end, 100) << "the end time would have been a good estimate";
    EXPECT_GT(ratio.least, 0.5);
    EXPECT_LT(ratio.greatest, 2);
}

TEST_F(ClockOfARun, of_a_slope_onto_level_ground_is_right_to_a_factor_of_two) {
    write_terrain("dem.tif", [](double x, double) { return std::max(0.0, 60 - 0.6 * x); });
    write_features("release.geojson", {rectangle(20, 90, 40, 110)});
    write("scene.toml",
          "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"release.geojson\"\nthickness_m = 2\n"
          "[material]\nfriction_coefficient = 0.3\n[solver]\ntarget_particle_count = 400\nend_time_s = 200\n");
    const scene::Scene scene = loaded();
    const Ratio ratio = ratio_of(scene);
    EXPECT_LT(ratio.end, 60);
    EXPECT_GT(ratio.least, 0.5);
    EXPECT_LT(ratio.greatest, 2);
}

TEST_F(ClockOfARun, of_an_inflow_is_right_to_a_factor_of_two) {
    write_valley("");
    write("hydrograph.csv", "time_s,discharge_m3ps,velocity_mps\n0,20,3\n20,20,3\n");
    write("scene.toml",
          "[terrain]\nfile = \"dem.tif\"\n[[inflow]]\nline_m = [[824030, 825095], [824030, 825105]]\n"
          "hydrograph = \"hydrograph.csv\"\n[solver]\ntarget_particle_count = 400\nend_time_s = 200\n");
    const scene::Scene scene = loaded();
    const Ratio ratio = ratio_of(scene);
    EXPECT_LT(ratio.end, 150);
    EXPECT_GT(ratio.least, 0.5);
    EXPECT_LT(ratio.greatest, 2);
}

/// On rough ground few particles go on for long after the others, which nothing foresees early on.
TEST_F(ClockOfARun, of_the_built_in_scene_is_right_to_a_factor_of_four) {
    const auto scene = scene::load_scene(fs::path(TALUS_SOURCE_DIR) / "scenes/sham_tseng/scene.toml",
                                         {"solver.target_particle_count=600", "solver.end_time_s=90"});
    ASSERT_TRUE(scene) << scene.error().message;
    const Ratio ratio = ratio_of(*scene);
    EXPECT_GT(ratio.least, 0.25);
    EXPECT_LT(ratio.greatest, 4);
}

}  // namespace
}  // namespace talus::run
