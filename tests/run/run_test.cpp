#include "run/run.hpp"

#include <atomic>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"
#include "sim/sources/seed.hpp"

namespace talus::run {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

class RunOfAScene : public scene::SceneFolder {
  protected:
    [[nodiscard]] scene::Scene loaded(const std::string& more, std::vector<std::string> overrides = {}) const {
        write_valley(more);
        overrides.insert(overrides.begin(), {"solver.target_particle_count=400", "solver.end_time_s=3"});
        return SceneFolder::loaded(overrides);
    }
};

TEST_F(RunOfAScene, step_by_step_is_the_whole_one) {
    const scene::Scene scene = loaded("");
    auto run = run::Run::start(scene);
    ASSERT_TRUE(run) << run.error().message;
    EXPECT_EQ((*run)->phase(), RunPhase::ready);
    std::uint64_t steps = 0;
    while ((*run)->advance()) ++steps;
    EXPECT_EQ((*run)->phase(), RunPhase::ended);
    EXPECT_EQ((*run)->state().step, steps);
    EXPECT_FALSE((*run)->advance());
    EXPECT_EQ((*run)->state().step, steps) << "a step after the end";
    const auto whole = run_scene(scene, {});
    ASSERT_TRUE(whole);
    const RunResult result = (*run)->result();
    EXPECT_EQ(result.status, RunStatus::complete);
    EXPECT_THAT(result.stop_reason, MatchesRegex("reached solver.end_time_s = 3 with .* m3 still moving .*"));
    EXPECT_EQ(result.stop_reason, whole->stop_reason);
    EXPECT_EQ(result.hash, whole->hash);
    EXPECT_EQ(result.steps, whole->steps);
    EXPECT_EQ(result.observation.timeseries.size(), whole->observation.timeseries.size());
}

TEST_F(RunOfAScene, shows_its_debris_over_time_and_the_same_result) {
    const scene::Scene scene = loaded("[outputs]\nseries_interval_s = 0.25\n");
    std::vector<double> times, volumes;
    RunOptions options;
    options.on_frame = [&](const Frame& frame) {
        EXPECT_EQ(frame.particles->time, frame.time);
        times.push_back(frame.time);
        const Grid<float>& depth = frame.debris.depth;
        double sum = 0;
        for (const float value : depth.values) sum += value;
        volumes.push_back(sum * depth.geometry.cell * depth.geometry.cell);
    };
    const auto result = run_scene(scene, options);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->hash, run_scene(scene, {})->hash);
    EXPECT_EQ(times.size(), 13U);
    EXPECT_EQ(times.front(), 0);
    EXPECT_EQ(times.back(), result->simulated_time);
    for (std::size_t k = 0; k < times.size(); ++k) {
        EXPECT_NEAR(times[k], 0.25 * static_cast<double>(k), 0.02);
        EXPECT_NEAR(volumes[k], result->observation.volume_released, 1e-5 * result->observation.volume_released);
    }
}

TEST_F(RunOfAScene, takes_the_path_of_the_debris_in_place_of_a_traced_one) {
    scene::Scene scene = loaded("", {"solver.end_time_s=12"});
    const std::vector<PlanPoint> traced = scene.flow_path.points();
    const auto result = run_scene(scene, {});
    ASSERT_TRUE(result);
    ASSERT_TRUE(result->observation.followed_path);
    EXPECT_NEAR(result->observation.run_out.front_chainage, result->observation.front.back().chainage, 1e-9);
    take_followed_path(scene, *result);
    EXPECT_EQ(scene.flow_path_origin, scene::PathOrigin::followed);
    EXPECT_NE(scene.flow_path.points().size(), traced.size());
    EXPECT_THAT(scene.notes.back(), HasSubstr("the path that debris followed"));
}

TEST_F(RunOfAScene, keeps_the_traced_path_that_observations_refer_to) {
    const auto result =
        run_scene(loaded("[[observation]]\nchainage_m = 20\nfront_velocity_mps = 5\n", {"solver.end_time_s=12"}), {});
    ASSERT_TRUE(result);
    EXPECT_FALSE(result->observation.followed_path);
}

TEST_F(RunOfAScene, takes_what_the_scene_has) {
    const scene::Scene scene = loaded(
        "[[bed]]\ndepth_m = 0.4\ngrowth_rate_per_m = 0.01\n[[zone]]\nname = \"fan\"\n"
        "polygon = \"824100 825050, 824150 825050, 824150 825100, 824100 825100\"\nfriction_coefficient = 0.9\n");
    const auto run = run::Run::start(scene);
    ASSERT_TRUE(run) << run.error().message;
    EXPECT_FALSE((*run)->ground().bed.empty());
    EXPECT_FALSE((*run)->model().cover.empty());
}

TEST_F(RunOfAScene, counts_the_particles_of_releases_not_those_of_the_bed) {
    const auto result = run_scene(loaded("[[bed]]\ndepth_m = 0.5\ngrowth_rate_per_m = 0.01\n"), {});
    ASSERT_TRUE(result);
    ASSERT_GT(result->observation.timeseries.back().volume_entrained, 0);
    const double particle = std::pow(result->particle_spacing, 3);
    EXPECT_NEAR(result->particles * particle, result->observation.volume_released, particle);
}

TEST_F(RunOfAScene, debris_that_meets_nodata_has_left_and_the_balance_holds) {
    write_valley();
    write_terrain("dem.tif", [](double x, double y) {
        const bool hole = std::abs(x - west - 62) < 8 && std::abs(y - south - 100) < 12;
        return hole ? std::numeric_limits<double>::quiet_NaN() : valley(x, y);
    });
    for (const char* method : {"pair", "stress"}) {
        const auto scene = scene::load_scene(
            folder / "scene.toml", {"solver.target_particle_count=400", "solver.end_time_s=8",
                                    "release.start_time_s=0.5", fmt::format("solver.internal_friction={}", method)});
        ASSERT_TRUE(scene) << scene.error().message;
        const auto result = run_scene(*scene, {});
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_EQ(result->status, RunStatus::complete) << result->stop_reason;
        const observe::Observation& seen = result->observation;
        for (const observe::TimeSample& now : seen.timeseries) {
            EXPECT_NEAR(now.volume_held + now.volume_moving + now.volume_deposited + now.volume_left,
                        now.volume_released, 1e-9 * seen.volume_released);
        }
        EXPECT_GT(seen.timeseries.back().volume_left, 0.5 * seen.volume_released);
    }
}

TEST_F(RunOfAScene, stops_when_asked) {
    std::atomic<bool> stop{false};
    RunOptions options;
    options.stop_requested = &stop;
    options.on_progress = [&](const Progress& now) { stop = now.step == 3; };
    const auto result = run_scene(loaded(""), options);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->status, RunStatus::interrupted);
    EXPECT_EQ(result->steps, 3U);
    EXPECT_THAT(result->stop_reason, StartsWith("stopped by the user at t = 0.1 s"));
}

TEST_F(RunOfAScene, a_change_brings_it_back_from_rest) {
    auto started = run::Run::start(
        loaded("", {"material.friction_coefficient=3", "solver.stop_duration_s=0.2", "solver.end_time_s=60"}));
    ASSERT_TRUE(started);
    auto& run = **started;
    while (run.advance()) continue;
    ASSERT_EQ(run.phase(), RunPhase::at_rest) << run.stop_reason();
    EXPECT_THAT(run.stop_reason(), StartsWith("debris came to rest (less than "));
    run.change([](sim::Model&, sim::Ground&, sim::State& state) { return state.seeded; });
    EXPECT_EQ(run.phase(), RunPhase::ready);
    EXPECT_EQ(run.stop_reason(), "");
    EXPECT_EQ(run.result().status, RunStatus::interrupted);
    EXPECT_TRUE(run.advance());
}

TEST_F(RunOfAScene, too_many_particles_are_refused) {
    scene::Scene scene = loaded("");
    scene.spec.solver.particle_limit = 100;
    const auto result = run_scene(scene, {});
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().message, HasSubstr("scene.toml: "));
    EXPECT_THAT(result.error().message, HasSubstr("solver.particle_limit = 100"));
}

TEST_F(RunOfAScene, a_fault_names_the_first_bad_particle_its_cell_and_its_neighbours) {
    const auto run = run::Run::start(loaded(""));
    ASSERT_TRUE(run);
    const sim::State good = (*run)->state();
    sim::State bad = good;
    const std::size_t worst = good.count / 2;
    bad.position.x[worst] = std::numeric_limits<float>::quiet_NaN();
    bad.velocity.z[worst + 1] = std::numeric_limits<float>::infinity();
    const FaultRecord record = record_fault((*run)->model(), (*run)->ground(), good, bad, "not finite");
    EXPECT_EQ(record.content["particles_not_finite"], 2);
    const auto& particle = record.content["particle"];
    EXPECT_EQ(particle["id"], good.id[worst]);
    const terrain::Terrain& terrain = (*run)->ground().terrain;
    EXPECT_NEAR(particle["x_m"].get<double>(), terrain.frame().origin.x + good.position.x[worst], 1e-3);
    const GridGeometry& grid = terrain.elevation().geometry;
    EXPECT_EQ(particle["terrain_column"], static_cast<int>((particle["x_m"].get<double>() - grid.x_min) / grid.cell));
    EXPECT_EQ(particle["terrain_row"], static_cast<int>((particle["y_m"].get<double>() - grid.y_min) / grid.cell));
    EXPECT_GT(particle["neighbours"].size(), 3U);
    EXPECT_THAT(record.sentence, HasSubstr(fmt::format("; particle {}, the first of 2,", good.id[worst])));
    EXPECT_THAT(record.sentence, HasSubstr(fmt::format("with {} neighbours", particle["neighbours"].size())));
}

TEST(EndlessRun, goes_on_beyond_its_end_and_after_a_fault) {
    params::SolverSpec solver;
    solver.end_time = 0.01;
    const Grid<float> level(GridGeometry{0, 0, 1, 20, 20}, 0.0F);
    RunStart start{sim::make_model({}, solver, 0.5), sim::Ground(terrain::Terrain(level)), sim::State{}};
    start.state.resize(1);
    start.state.count = start.state.seeded = 1;
    start.state.position.set(0, start.ground.terrain.frame().to_local({10, 10, 3}));
    run::Run ends(start);
    for (int step = 0; step < 20; ++step) (void)ends.advance();
    EXPECT_EQ(ends.phase(), RunPhase::ended);
    EXPECT_LT(ends.state().step, 20U);

    start.endless = true;
    run::Run goes_on(start);
    for (int step = 0; step < 20; ++step) EXPECT_TRUE(goes_on.advance());
    EXPECT_EQ(goes_on.phase(), RunPhase::ready);

    start.model.solver.compression_limit = -1;
    run::Run faulty(start);
    for (const std::uint64_t step : {1U, 2U}) {
        EXPECT_FALSE(faulty.advance());
        EXPECT_EQ(faulty.phase(), RunPhase::fault);
        EXPECT_THAT(faulty.stop_reason(), HasSubstr("t = "));
        EXPECT_EQ(faulty.state().step, step);
        ASSERT_TRUE(faulty.fault());
        EXPECT_EQ(faulty.fault()->content["step"], 1) << "the first fault is the cause of the others";
    }
}

}  // namespace
}  // namespace talus::run
