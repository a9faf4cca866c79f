#include "run/forecast.hpp"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "run/run.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

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

TEST(StopTimes, OfABlockOnLevelGroundIsItsSpeedOverTheFriction) {
    const SlidingBlock block{{-150, 0, 0}, {10, 0, 0}, 1};
    const auto stops = stop_times(sliding(0.25), plane(0), {block}, 0.1, 100);
    EXPECT_NEAR(stops.at(0), 10 / (0.25 * 9.80665), 0.15);
}

TEST(StopTimes, EndWhereTheTerrainEndsAndAtTheHorizon) {
    const SlidingBlock block{{-190, 0, 0}, {0, 0, 0}, 1};
    const double angle = std::atan(0.5), pull = 9.80665 * (std::sin(angle) - 0.25 * std::cos(angle));
    const double way = 389 / std::cos(angle);  // from the start to the last column of cell centres
    const auto stops = stop_times(sliding(0.25), plane(0.5), {block}, 0.1, 100);
    EXPECT_NEAR(stops.at(0), std::sqrt(2 * way / pull), 0.4);
    EXPECT_DOUBLE_EQ(stop_times(sliding(0.25), plane(0.5), {block}, 0.1, 3).at(0), 3);
}

TEST(StopTimes, ALateBlockStartsLate) {
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

TEST(TheClock, WhileAllMovesTheEndIsThatOfTheBlocks) {
    RunClock clock(solver());
    clock.tick(1, 10, [] { return Outlook{.coasting = 30, .moving_share = 1, .enough_share = 0.001, .energy = 1}; });
    EXPECT_DOUBLE_EQ(clock.expected_end(), 43);
    EXPECT_NEAR(clock.wall_remaining(), 3.3, 1e-9);  // a tenth of a second of wall time per simulated second
    EXPECT_NEAR(clock.share_done(), 1 / 4.3, 1e-9);
}

TEST(TheClock, NeverPassesTheEndTime) {
    RunClock clock(solver());
    clock.tick(1, 10, [] { return Outlook{.coasting = 290, .moving_share = 1, .enough_share = 0.001, .energy = 1}; });
    EXPECT_DOUBLE_EQ(clock.expected_end(), 300);
}

TEST(TheClock, WaitsForWhatIsStillToCome) {
    RunClock clock(solver());
    clock.tick(1, 10, [] {
        return Outlook{.coasting = 0, .moving_share = 0, .enough_share = 0.001, .energy = 1, .wait = 50};
    });
    EXPECT_DOUBLE_EQ(clock.expected_end(), 63);
}

/// Debris of which ever less moves: half of it after every 10 s, which blocks that slide alone know nothing of.
TEST(TheClock, FollowsTheDecayOfAStragglingTail) {
    RunClock clock(solver());
    const double end = 10 * std::log2(1000) + 3;
    for (double time = 1; time < 90; time += 1) {
        const double share = std::exp2(-time / 10);
        clock.tick(time / 10, time, [&] {
            return Outlook{.coasting = 5, .moving_share = share, .enough_share = 0.001, .energy = std::exp(-time)};
        });
        if (time < end / 10 || time > end - 10) continue;
        EXPECT_GT(clock.wall_remaining(), (end - time) / 20) << time;
        EXPECT_LT(clock.wall_remaining(), (end - time) / 5) << time;
    }
}

class ClockOfARun : public scene::SceneFolder {};

/// From the first tenth of the steps on, the time left is right to a factor of two: in simulated time, because other
/// work on the machine changes the pace.
TEST_F(ClockOfARun, IsRightToAFactorOfTwoFromTheFirstTenthOn) {
    write_valley("");
    const auto scene =
        scene::load_scene(folder / "scene.toml", {"solver.target_particle_count=400", "solver.end_time_s=200"});
    ASSERT_TRUE(scene) << scene.error().message;
    const auto run = Run::start(*scene);
    ASSERT_TRUE(run);
    struct Estimate {
        double time, left;
    };
    std::vector<Estimate> estimates;
    RunClock clock(scene->spec.solver);
    while ((*run)->advance()) {
        const double time = (*run)->state().time;
        // As if it ran in real time: how often it looks must not depend on the machine.
        clock.tick(time, time, [&] { return outlook_of((*run)->simulation(), scene->spec.outputs.deposited_speed); });
        estimates.push_back({time, clock.expected_end() - time});
    }
    EXPECT_EQ((*run)->phase(), RunPhase::at_rest) << (*run)->stop_reason();
    const double end = (*run)->state().time;
    EXPECT_LT(end, 100) << "the end time would have been a good estimate";
    for (const Estimate& e : estimates) {
        if (e.time < end / 10 || e.time > 0.75 * end) continue;
        EXPECT_GT(e.left, (end - e.time) / 2) << e.time << " of " << end;
        EXPECT_LT(e.left, (end - e.time) * 2) << e.time << " of " << end;
    }
}

}  // namespace
}  // namespace talus::run
