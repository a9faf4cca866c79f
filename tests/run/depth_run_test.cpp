#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gmock/gmock.h>

#include "run/depth_grid.hpp"
#include "run/grid_stages.hpp"
#include "run/run.hpp"
#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class DepthAveragedRun : public scene::SceneFolder {
  protected:
    [[nodiscard]] scene::Scene loaded(const std::string& more, std::vector<std::string> overrides = {}) const {
        write_valley(more);
        overrides.insert(overrides.begin(), {"solver.model=depth_averaged", "solver.end_time_s=12"});
        return SceneFolder::loaded(overrides);
    }
    [[nodiscard]] static std::string dam(const std::string& more) {
        return fmt::format("[[barrier]]\nname = \"dam\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nthickness_m = 1\n{3}\n",
                           west + 150, south + 10, south + 190, more);
    }
};

TEST_F(DepthAveragedRun, has_the_results_of_a_run) {
    const scene::Scene scene = loaded("[[observation]]\nchainage_m = 60\nfront_velocity_mps = 5\n");
    const auto result = run_scene(scene, {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->status, RunStatus::complete);
    EXPECT_TRUE(result->depth_averaged());
    EXPECT_EQ(result->grid_cell, 2.5);
    EXPECT_GT(result->step_time(), result->wall_time) << "measurements are stages too";
    EXPECT_GT(result->seed_time, 0);
    for (const Phase& stage : result->grid_stages) {
        const bool always = stage.name == "advance_cells" || stage.name == "observe";
        EXPECT_GE(stage.seconds, always ? 1e-9 : 0) << stage.name;
    }
    EXPECT_EQ(result->grid_stages.size(), grid_stage_names.size());
    EXPECT_EQ(result->particles, 0U);
    const observe::Observation& o = result->observation;
    EXPECT_NEAR(o.volume_released, scene.releases[0].volume, 1e-4 * o.volume_released);
    const observe::TimeSample& end = o.timeseries.back();
    EXPECT_NEAR(end.volume_moving + end.volume_deposited + end.volume_left, o.volume_released,
                1e-5 * o.volume_released);
    EXPECT_GT(o.run_out.along_flow, 60);
    EXPECT_GT(o.run_out.drop, 25);
    EXPECT_LT(o.run_out.runout_angle, std::atan(0.55));
    // On a slope of 0.5 with friction 0.4, from 2 m of debris that spreads while it slides.
    const double velocity = front_at(o, 60).front_velocity;
    EXPECT_GT(velocity, 6);
    EXPECT_LT(velocity, 16);
}

TEST_F(DepthAveragedRun, says_on_its_way_how_far_its_front_has_come) {
    const scene::Scene scene = loaded("");
    std::vector<double> fronts;
    RunOptions options;
    options.on_progress = [&](const Progress& now) {
        if (!std::isnan(now.front_chainage)) fronts.push_back(now.front_chainage);
    };
    const auto result = run_scene(scene, options);
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_GT(fronts.size(), 10U);
    EXPECT_TRUE(std::is_sorted(fronts.begin(), fronts.end()));
    EXPECT_LT(fronts.front(), 60);
    EXPECT_NEAR(fronts.back(), result->observation.front.back().chainage, 5) << "two cells";
}

TEST_F(DepthAveragedRun, differs_little_from_the_particles_where_both_see_a_slab_slide) {
    const std::string observed = "[[observation]]\nchainage_m = 60\nfront_velocity_mps = 5\n";
    const auto flat = run_scene(loaded(observed), {});
    ASSERT_TRUE(flat);
    const auto particles =
        run_scene(loaded(observed, {"solver.model=particles", "solver.target_particle_count=1500"}), {});
    ASSERT_TRUE(particles);
    EXPECT_NEAR(front_at(flat->observation, 60).front_velocity, front_at(particles->observation, 60).front_velocity, 2);
}

TEST_F(DepthAveragedRun, has_a_front_velocity_at_every_chainage_where_a_viscous_front_slides) {
    const auto result = run_scene(loaded("[[observation]]\nchainage_m = 60\nfront_velocity_mps = 5\n",
                                         {"material.friction_coefficient=0.2", "material.kinematic_viscosity_m2ps=0.05",
                                          "material.viscosity_on_ground=true", "solver.end_time_s=15"}),
                                  {});
    ASSERT_TRUE(result) << result.error().message;
    const std::vector<observe::FrontSample>& front = result->observation.front;
    ASSERT_GT(front.size(), 60U);
    double before = front.front().front_velocity;
    for (const observe::FrontSample& s : front) {
        if (s.chainage > 40) {  // clear of the release, whose rear still stands
            EXPECT_NEAR(s.front_velocity, s.particle_speed, 0.5 * s.particle_speed) << s.chainage;
        }
        EXPECT_NEAR(s.front_velocity / before, 1, 0.2) << s.chainage;
        before = s.front_velocity;
    }
}

TEST_F(DepthAveragedRun, stops_at_a_barrier_and_measures_it) {
    const auto open = run_scene(loaded(""), {});
    const auto closed = run_scene(loaded(dam("height_m = 25")), {});
    ASSERT_TRUE(open && closed);
    // From one side of the valley to the other, twice as high as 16 m/s of kinetic energy reach.
    EXPECT_LT(closed->observation.run_out.straight, 140);
    EXPECT_GT(open->observation.run_out.straight, 150);
    ASSERT_EQ(closed->observation.buildings.size(), 1U);
    const observe::BuildingImpact& impact = closed->observation.buildings[0];
    EXPECT_TRUE(impact.is_barrier);
    EXPECT_TRUE(impact.hit);
    EXPECT_GT(impact.peak_depth, 0.5);
    EXPECT_GT(impact.peak_force, 0);
    EXPECT_GT(impact.first_hit_time, 1);
}

TEST_F(DepthAveragedRun, tells_what_went_over_a_dam_and_what_it_retains) {
    const double line = west + 150;
    const auto beyond = [&](const RunResult& result) {
        const Grid<float>& deposit = result.observation.maps.deposit_depth;
        double sum = 0;
        for (int row = 0; row < deposit.geometry.rows; ++row) {
            for (int column = 0; column < deposit.geometry.columns; ++column) {
                const float depth = deposit.at(column, row);
                if (depth > 0 && deposit.geometry.centre(column, row).x > line) sum += depth;
            }
        }
        return sum * deposit.geometry.cell * deposit.geometry.cell + result.observation.timeseries.back().volume_left;
    };
    const auto low = run_scene(loaded(dam("height_m = 1.5"), {"solver.end_time_s=40"}), {});
    ASSERT_TRUE(low);
    double deposit = 0;
    for (const float depth : low->observation.maps.deposit_depth.values) deposit += depth > 0 ? depth : 0;
    const observe::TimeSample& end = low->observation.timeseries.back();
    EXPECT_NEAR(deposit * low->map_cell * low->map_cell, end.volume_deposited + end.volume_moving,
                1e-4 * end.volume_released)
        << "the map has all debris that is there, however thin";
    const observe::BuildingImpact& overtopped = low->observation.buildings[0];
    EXPECT_GT(overtopped.overtopped_volume, 300);
    EXPECT_NEAR(overtopped.overtopped_volume, beyond(*low), 0.02 * overtopped.overtopped_volume);
    std::optional<double> retained;
    for (const double height : {25.0, 50.0}) {
        const auto high = run_scene(loaded(dam(fmt::format("height_m = {}", height)), {"solver.end_time_s=40"}), {});
        ASSERT_TRUE(high);
        const observe::BuildingImpact& dammed = high->observation.buildings[0];
        EXPECT_EQ(dammed.overtopped_volume, 0);
        EXPECT_TRUE(std::isnan(dammed.first_overtopping_time));
        EXPECT_GT(dammed.retained_volume, 300);
        EXPECT_LE(dammed.retained_volume, high->observation.volume_released);
        EXPECT_EQ(dammed.retained_volume, retained.value_or(dammed.retained_volume)) << "whatever its height";
        retained = dammed.retained_volume;
    }
}

TEST_F(DepthAveragedRun, holds_all_debris_until_the_first_step) {
    for (const char* start : {"release.start_time_s=0", "release.start_time_s=0.2"}) {
        for (const char* model : {"solver.model=depth_averaged", "solver.model=particles"}) {
            const auto result =
                run_scene(loaded("", {model, start, "solver.end_time_s=0.3", "solver.target_particle_count=300"}), {});
            ASSERT_TRUE(result) << result.error().message;
            const observe::TimeSample& first = result->observation.timeseries.front();
            EXPECT_GT(first.volume_held, 100) << start << model;
            EXPECT_NEAR(first.volume_released, first.volume_held, 1e-5 * first.volume_held) << start << model;
            EXPECT_EQ(first.volume_deposited, 0);
            EXPECT_EQ(first.volume_moving, 0);
        }
    }
}

TEST_F(DepthAveragedRun, holds_a_release_until_its_start) {
    const auto result = run_scene(loaded("", {"release.start_time_s=5", "solver.end_time_s=8"}), {});
    ASSERT_TRUE(result) << result.error().message;
    const auto& series = result->observation.timeseries;
    EXPECT_GT(series[20].volume_held, 100);
    EXPECT_EQ(series[20].volume_moving, 0);
    EXPECT_EQ(series.back().volume_held, 0);
    EXPECT_GT(series.back().volume_moving, 0);
}

TEST_F(DepthAveragedRun, drains_debris_from_the_start_of_its_release) {
    const std::string observed = "[[observation]]\nchainage_m = 60\nfront_velocity_mps = 5\n";
    const auto velocity = [&](const std::string& model, const char* start) {
        const auto result =
            run_scene(loaded(observed, {model, "solver.target_particle_count=600", "solver.end_time_s=30",
                                        "material.friction_coefficient=0.45", "material.pore_pressure_ratio=0.6",
                                        "material.pore_pressure_decay_time_s=10", start}),
                      {});
        EXPECT_TRUE(result);
        return front_at(result->observation, 60).front_velocity;
    };
    for (const std::string model : {"solver.model=depth_averaged", "solver.model=particles"}) {
        const double early = velocity(model, "release.start_time_s=0");
        const double late = velocity(model, "release.start_time_s=20");
        EXPECT_GT(early, 4);
        EXPECT_NEAR(late, early, 0.05 * early) << model;
    }
}

TEST_F(DepthAveragedRun, gives_every_release_the_pore_pressure_of_its_own) {
    const auto dry = run_scene(loaded(""), {}), wet = run_scene(loaded("", {"release.pore_pressure_ratio=0.5"}), {});
    const auto all_wet = run_scene(loaded("", {"material.pore_pressure_ratio=0.5"}), {});
    ASSERT_TRUE(dry && wet && all_wet);
    EXPECT_GT(wet->observation.run_out.along_flow, 1.2 * dry->observation.run_out.along_flow);
    EXPECT_NEAR(wet->observation.run_out.along_flow, all_wet->observation.run_out.along_flow, 2.5);
}

TEST_F(DepthAveragedRun, ends_once_nothing_is_left_or_as_it_is_asked_to) {
    const auto reason = [&](const std::vector<std::string>& overrides) {
        const auto result = run_scene(loaded("", overrides), {});
        return result ? result->stop_reason : result.error().message;
    };
    scene::Scene untriggered = loaded("");
    untriggered.releases[0].spec.start_time = std::numeric_limits<double>::infinity();
    const auto nothing = run_scene(untriggered, {});
    ASSERT_TRUE(nothing);
    EXPECT_EQ(nothing->stop_reason, "there is no debris");
    EXPECT_LT(nothing->simulated_time, 1);
    // Without friction all of it leaves the valley at its end.
    const std::string left = reason({"material.friction_coefficient=0", "solver.end_time_s=4000"});
    EXPECT_THAT(left, testing::AnyOf(testing::StartsWith("debris came to rest"),
                                     testing::StrEq("all debris has left the terrain")));
    EXPECT_THAT(reason({"solver.end_time_s=400", "solver.stop_energy_share=0.2", "solver.stop_duration_s=1"}),
                testing::MatchesRegex("kinetic energy fell below 20 % of its peak \\(for 1 s\\) with .* m3 still "
                                      "moving .*"));
    EXPECT_THAT(reason({"solver.end_time_s=5"}), HasSubstr("still moving"));
}

TEST_F(DepthAveragedRun, gives_the_same_bits_on_any_number_of_threads) {
    const auto one = run_scene(loaded("", {"solver.thread_count=1"}), {});
    const auto four = run_scene(loaded("", {"solver.thread_count=4"}), {});
    ASSERT_TRUE(one && four);
    EXPECT_EQ(one->hash, four->hash);
    EXPECT_EQ(one->observation.run_out.along_flow, four->observation.run_out.along_flow);
}

TEST_F(DepthAveragedRun, takes_the_volume_of_an_inflow_while_it_runs) {
    write("flow.csv", "time_s,discharge_m3ps,velocity_mps\n0,0,3\n2,60,6\n6,0,3\n");
    const std::string inflow =
        fmt::format("[[inflow]]\nname = \"channel\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nhydrograph = \"flow.csv\"\n",
                    west + 60, south + 80, south + 120);
    for (const char* threads : {"solver.thread_count=1", "solver.thread_count=3"}) {
        const scene::Scene scene = loaded(inflow, {threads, "release.thickness_m=0.01"});
        const auto result = run_scene(scene, {});
        ASSERT_TRUE(result) << result.error().message;
        const observe::Observation& o = result->observation;
        const observe::TimeSample &early = o.timeseries[10], &end = o.timeseries.back();
        EXPECT_NEAR(scene.inflows[0].volume(), 180, 1e-9);
        const double all = scene.releases[0].volume + 180;
        EXPECT_NEAR(end.volume_released, all, 1e-4 * all);
        EXPECT_NEAR(end.volume_moving + end.volume_deposited + end.volume_left, end.volume_released, 1e-5 * all);
        EXPECT_NEAR(early.volume_released, scene.releases[0].volume + 15, 0.2) << "after one second";
        EXPECT_GT(o.run_out.straight, 40);
    }
}

TEST_F(DepthAveragedRun, entrains_its_bed_down_to_its_depth) {
    const std::string bed = "[[bed]]\ndepth_m = 0.4\ngrowth_rate_per_m = 0.02\n";
    const auto bare = run_scene(loaded(""), {}), with_bed = run_scene(loaded(bed), {}),
               threaded = run_scene(loaded(bed, {"solver.thread_count=3"}), {});
    ASSERT_TRUE(bare && with_bed && threaded);
    const observe::Observation& o = with_bed->observation;
    const observe::TimeSample& end = o.timeseries.back();
    EXPECT_GT(end.volume_entrained, 0.5 * end.volume_released);
    EXPECT_NEAR(end.volume_released + end.volume_entrained, end.volume_moving + end.volume_deposited + end.volume_left,
                1e-5 * end.volume_released);
    EXPECT_NEAR(o.erosion.volume, end.volume_entrained, 1e-4 * end.volume_entrained);
    for (const float depth : o.erosion.depth.values) EXPECT_FALSE(depth > 0.4001F);
    EXPECT_EQ(bare->observation.timeseries.back().volume_entrained, 0);
    EXPECT_EQ(with_bed->hash, threaded->hash);
}

TEST_F(DepthAveragedRun, refuses_what_it_does_not_have_with_file_and_key) {
    const auto error = [&](const std::string& more) {
        write_valley(more);
        return load_error({"solver.model=depth_averaged"});
    };
    EXPECT_THAT(error(dam("height_m = 4\npassing_share = 0.3")),
                AllOf(HasSubstr("scene.toml"), HasSubstr("dam"), HasSubstr("no nets")));
    EXPECT_THAT(error("[solver]\ngrid_cell_m = 0.001\n"), AllOf(HasSubstr("grid_cell_m"), HasSubstr("at least")));
}

TEST_F(DepthAveragedRun, shows_its_debris_over_time) {
    const scene::Scene scene = loaded("[outputs]\nseries = [\"netcdf\"]\nseries_interval_s = 0.7\n");
    std::vector<double> times, volumes;
    RunOptions options;
    options.on_frame = [&](const Frame& frame) {
        EXPECT_EQ(frame.particles, nullptr);
        times.push_back(frame.time);
        const Grid<float>& depth = frame.debris.depth;
        double sum = 0;
        for (const float value : depth.values) sum += value;
        volumes.push_back(sum * depth.geometry.cell * depth.geometry.cell);
    };
    const auto result = run_scene(scene, options);
    ASSERT_TRUE(result);
    EXPECT_EQ(times.front(), 0);
    EXPECT_EQ(times.back(), result->simulated_time) << "the end is a frame";
    ASSERT_GE(times.size(), static_cast<std::size_t>(result->simulated_time / 0.7));
    for (std::size_t k = 0; k + 1 < times.size(); ++k) EXPECT_LT(times[k], times[k + 1]);
    EXPECT_NEAR(times[1], 0.7, 0.1);
    EXPECT_NEAR(volumes[2], result->observation.volume_released, 1e-4 * result->observation.volume_released);
}

TEST_F(DepthAveragedRun, notes_keys_that_mean_nothing_to_it) {
    const scene::Scene scene = loaded("[material]\nviscosity = 0.2\n");
    EXPECT_THAT(scene.notes, testing::Contains(HasSubstr("does not use material.viscosity")));
}

TEST_F(DepthAveragedRun, is_refused_where_particles_are_needed) {
    const auto run = Run::start(loaded(""));
    ASSERT_FALSE(run);
    EXPECT_THAT(run.error().message, HasSubstr("needs particles"));
}

TEST_F(DepthAveragedRun, leaves_no_gap_in_an_oblique_barrier) {
    const scene::Scene scene = loaded(
        fmt::format("[[barrier]]\nname = \"dam\"\nline_m = [[{}, {}], [{}, {}]]\nthickness_m = 0.5\nheight_m = 5\n",
                    west + 120, south + 60, west + 180, south + 131));
    const GridGround ground = grid_ground(scene);
    const GridGeometry& g = ground.bed.geometry;
    std::vector<int> first(static_cast<std::size_t>(g.rows), -1), last(first);
    for (const std::size_t raised : ground.structures[0].cells) {
        const auto row = raised / static_cast<std::size_t>(g.columns);
        const int column = static_cast<int>(raised % static_cast<std::size_t>(g.columns));
        first[row] = first[row] < 0 ? column : std::min(first[row], column);
        last[row] = std::max(last[row], column);
    }
    int pairs = 0;
    for (std::size_t row = 1; row < first.size(); ++row) {
        if (first[row] < 0 || first[row - 1] < 0) continue;
        EXPECT_LE(first[row], last[row - 1]) << "rows share a side";
        ++pairs;
    }
    EXPECT_GT(pairs, 25);
}

}  // namespace
}  // namespace talus::run
