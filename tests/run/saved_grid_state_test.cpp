#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "run/saved_runs.hpp"

namespace talus::run {
namespace {

using testing::HasSubstr;

/// The depth-averaged model down a slope and out on level ground: a release that entrains its bed, one that starts
/// later with a pore pressure of its own, an inflow, a barrier, a house, a gauge and a section.
class SavedGridState : public SavedRuns {
  protected:
    void SetUp() override {
        write_inputs();
        write_features("late.geojson", {rectangle(60, 90, 70, 110)});
        write_features("house.geojson", {rectangle(100, 96, 108, 104)});
        write("scene.toml", R"([terrain]
file = "dem.tif"
[[release]]
name = "scarp"
file = "release.geojson"
thickness_m = 2
[[release]]
name = "late"
file = "late.geojson"
thickness_m = 0.8
start_time_s = 5
pore_pressure_ratio = 0.4
[[inflow]]
line_m = [[824045, 825095], [824045, 825105]]
hydrograph = "flow.csv"
[[bed]]
depth_m = 0.5
growth_rate_per_m = 0.01
[buildings]
file = "house.geojson"
default_height_m = 4
[[barrier]]
name = "dam"
line_m = [[824085, 825080], [824085, 825120]]
height_m = 1
[[gauge]]
x_m = 824055
y_m = 825100
[[cross_section]]
line_m = [[824065, 825060], [824065, 825140]]
[material]
friction_coefficient = 0.2
[solver]
model = "depth_averaged"
end_time_s = 8
)");
    }
};

TEST_F(SavedGridState, a_run_that_starts_from_it_is_the_one_that_was_not_interrupted) {
    const scene::Scene scene = loaded();
    const auto whole = run_scene(scene, {});
    ASSERT_TRUE(whole) << whole.error().message;
    const observe::Observation& seen = whole->observation;
    ASSERT_GT(seen.timeseries.back().volume_entrained, 0);
    ASSERT_GT(seen.cross_sections.at(0).passed, 0);
    ASSERT_TRUE(seen.buildings.at(0).hit || seen.buildings.at(1).hit);
    // Before and after the second release, and within the inflow.
    for (const double time : {0.0, 3.0, 6.0}) {
        const std::string state = state_at(scene, time);
        for (const char* threads : {"solver.thread_count=1", "solver.thread_count=3"}) {
            const auto rest = run_from(loaded({threads}), state);
            ASSERT_TRUE(rest) << rest.error().message;
            expect_same(*whole, *rest);
            EXPECT_EQ(rest->cell_updates, whole->cell_updates);
            EXPECT_EQ(rest->observation.volume_released, seen.volume_released);
            EXPECT_EQ(rest->observation.timeseries.size(), seen.timeseries.size());
        }
    }
}

TEST_F(SavedGridState, has_debris_in_the_air_that_flies_on) {
    write_terrain("dem.tif", [](double x, double) { return x - west < 60 ? 200 - 0.3 * (x - west) : 150; });
    const std::vector<std::string> keys = {"solver.flight=true"};
    const auto whole = run_scene(loaded(keys), {});
    ASSERT_TRUE(whole) << whole.error().message;
    const auto on_the_ground = run_scene(loaded(), {});
    ASSERT_NE(whole->observation.maps.peak_speed.values, on_the_ground->observation.maps.peak_speed.values);
    const auto rest = run_from(loaded(keys), state_at(loaded(keys), 4));
    ASSERT_TRUE(rest) << rest.error().message;
    expect_same(*whole, *rest);
}

TEST_F(SavedGridState, of_the_end_is_continued_to_a_later_one_as_if_that_had_been_meant) {
    const auto whole = run_scene(loaded(), {});
    ASSERT_TRUE(whole);
    for (const std::optional<double> time : {std::optional<double>(), std::optional(6.0)}) {
        const auto rest = run_from(loaded(), state_at(loaded({"solver.end_time_s=6"}), time));
        ASSERT_TRUE(rest) << rest.error().message;
        expect_same(*whole, *rest);
    }
}

TEST_F(SavedGridState, of_the_end_of_a_fast_inflow_that_limits_the_step_is_continued_to_the_same_bits) {
    write("flow.csv", "time_s,discharge_m3ps,velocity_mps\n0,30,25\n7,30,25\n");
    const auto whole = run_scene(loaded({"solver.grid_cell_m=2"}), {});
    ASSERT_TRUE(whole);
    for (const char* end : {"solver.end_time_s=6.03", "solver.end_time_s=6.57"}) {
        const std::string state = state_at(loaded({"solver.grid_cell_m=2", end}), {});
        const auto rest = run_from(loaded({"solver.grid_cell_m=2"}), state);
        ASSERT_TRUE(rest) << rest.error().message;
        expect_same(*whole, *rest);
    }
}

TEST_F(SavedGridState, of_a_later_time_than_the_end_has_nothing_left_to_compute) {
    const std::string state = state_at(loaded(), 7);
    const auto rest = run_from(loaded({"solver.end_time_s=6"}), state);
    ASSERT_TRUE(rest) << rest.error().message;
    EXPECT_GE(rest->simulated_time, 7);
    EXPECT_THAT(rest->stop_reason, HasSubstr("solver.end_time_s = 6"));
}

TEST_F(SavedGridState, of_the_end_at_rest_stays_at_rest) {
    const std::vector<std::string> keys = {"solver.end_time_s=400", "material.friction_coefficient=0.6"};
    const auto whole = run_scene(loaded(keys), {});
    ASSERT_TRUE(whole);
    ASSERT_LT(whole->simulated_time, 400);
    const auto rest = run_from(loaded(keys), state_at(loaded(keys), {}));
    ASSERT_TRUE(rest) << rest.error().message;
    expect_same(*whole, *rest);
}

TEST_F(SavedGridState, of_something_else_is_refused_and_says_what_is_different) {
    const std::string state = state_at(loaded(), 0.5);
    EXPECT_EQ(refusal(state, {"material.friction_coefficient=0.5"}),
              "run.state: is of a scene with material.friction_coefficient = 0.2, here it is 0.5");
    EXPECT_THAT(refusal(state, {"solver.grid_cell_m=2.5"}), HasSubstr("solver.grid_cell_m"));
    EXPECT_THAT(refusal(state, {"outputs.impact_filter_window_s=2"}), HasSubstr("outputs.impact_filter_window_s"));
    EXPECT_THAT(refusal(state, {"outputs.impact_patch_edge_m=3"}), HasSubstr("outputs.impact_patch_edge_m"));
    EXPECT_EQ(refusal(state, {"solver.model=particles", "solver.target_particle_count=500"}),
              "run.state: is of a scene with solver.model = \"depth_averaged\", here it is \"particles\"");
    EXPECT_EQ(refusal(state, {"solver.target_particle_count=500"}), "(it ran)") << "it means nothing to this model";
    EXPECT_THAT(refusal(state.substr(0, state.size() - 1), {}), HasSubstr("is no state of a run"));
    EXPECT_THAT(refusal(state + "x", {}), HasSubstr("is no state of a run"));
}

}  // namespace
}  // namespace talus::run
