#include "run/saved_state.hpp"

#include <utility>

#include <gmock/gmock.h>

#include "run/run_scene.hpp"
#include "run/saved_runs.hpp"

namespace talus::run {
namespace {

using testing::HasSubstr;

/// Down a slope and out on level ground: a release that entrains its bed, an inflow, a heap at rest on the level, a
/// barrier that fails, one that stands, and a gauge.
class SavedState : public SavedRuns {
  protected:
    SavedState() : SavedRuns({"solver.target_particle_count=600", "solver.end_time_s=8"}) {}
    void SetUp() override {
        write_inputs();
        write_features("heap.geojson", {rectangle(150, 90, 170, 110)});
        write("scene.toml", R"([terrain]
file = "dem.tif"
[[release]]
name = "scarp"
file = "release.geojson"
thickness_m = 2
[[release]]
name = "heap"
file = "heap.geojson"
thickness_m = 0.8
[[inflow]]
line_m = [[824045, 825095], [824045, 825105]]
hydrograph = "flow.csv"
[[bed]]
depth_m = 0.5
growth_rate_per_m = 0.01
[[barrier]]
name = "weak"
line_m = [[824060, 825080], [824060, 825120]]
height_m = 2
resistance_Npm = 100
[[barrier]]
name = "strong"
line_m = [[824085, 825080], [824085, 825120]]
height_m = 1.5
[[gauge]]
x_m = 824055
y_m = 825100
[material]
friction_coefficient = 0.25
)");
    }
};

TEST_F(SavedState, a_run_that_starts_from_it_is_the_one_that_was_not_interrupted) {
    const scene::Scene scene = loaded();
    const auto whole = run_scene(scene, {});
    ASSERT_TRUE(whole) << whole.error().message;
    const observe::BuildingImpact &weak = whole->observation.buildings[0], &strong = whole->observation.buildings[1];
    ASSERT_GT(whole->observation.timeseries.back().volume_entrained, 0);
    ASSERT_LT(weak.failure_time, 5) << "it has to have failed when the state is saved";
    ASSERT_TRUE(strong.hit);
    for (const double time : {0.0, 5.0}) {
        const std::string state = state_at(scene, time);
        for (const char* threads : {"solver.thread_count=1", "solver.thread_count=3"}) {
            const auto rest = run_from(loaded({threads}), state);
            ASSERT_TRUE(rest) << rest.error().message;
            expect_same(*whole, *rest);
        }
    }
}

TEST_F(SavedState, has_sleeping_debris_that_sleeps_on) {
    const scene::Scene scene = loaded();
    auto run = Run::start(scene);
    ASSERT_TRUE(run) << run.error().message;
    while ((*run)->summary().time < 5) ASSERT_TRUE((*run)->advance());
    ASSERT_LT((*run)->summary().awake, (*run)->summary().count);
    const auto state = save_state(scene, **run);
    ASSERT_TRUE(state) << state.error().message;
    auto other = Run::start(scene);
    ASSERT_TRUE(other);
    const Status restored = restore_state(scene, **other, *state);
    ASSERT_TRUE(restored) << restored.error().message;
    EXPECT_EQ((*other)->summary().awake, (*run)->summary().awake);
    EXPECT_EQ(*save_state(scene, **other), *state) << "the state of the restored run is another one";
}

TEST_F(SavedState, of_the_end_is_continued_to_a_later_one) {
    const auto whole = run_scene(loaded(), {});
    ASSERT_TRUE(whole);
    const auto rest = run_from(loaded(), state_at(loaded({"solver.end_time_s=5"}), {}));
    ASSERT_TRUE(rest) << rest.error().message;
    EXPECT_EQ(rest->hash, whole->hash);
    expect_same_map(rest->observation.maps.peak_depth, whole->observation.maps.peak_depth, "peak depth");
}

TEST_F(SavedState, of_something_else_is_refused_and_says_what_is_different) {
    const std::string state = state_at(loaded(), 0.5);
    EXPECT_EQ(refusal(state, {"material.friction_coefficient=0.5"}),
              "run.state: is of a scene with material.friction_coefficient = 0.25, here it is 0.5");
    EXPECT_THAT(refusal(state, {"solver.target_particle_count=500"}), HasSubstr("target_particle_count = 600, here"));
    EXPECT_THAT(refusal(state, {"solver.backend=host"}), HasSubstr("solver.backend = \"cpu\" only"));
    EXPECT_THAT(refusal("nothing", {}), HasSubstr("is no state of a run"));
    EXPECT_THAT(refusal(state.substr(0, state.size() - 1), {}), HasSubstr("is no state of a run"));
    EXPECT_THAT(refusal(state + "x", {}), HasSubstr("is no state of a run"));
    std::string older = state;
    older.replace(older.find("\"version\":\"") + 11, 1, "x");
    EXPECT_THAT(refusal(older, {}), HasSubstr("was written by talus x"));
    write("flow.csv", "time_s,discharge_m3ps,velocity_mps\n0,31,4\n7,30,4\n");
    EXPECT_THAT(refusal(state, {}), HasSubstr("another input file for \"inflow"));
    SetUp();
    write_terrain("dem.tif", [](double x, double y) {
        return 201 - 0.5 * std::min(x - west, 70.0) + 0.1 * std::abs(y - (south + 100));
    });
    EXPECT_EQ(refusal(state, {}), "run.state: is of another terrain");
}

TEST_F(SavedState, of_a_zoom_there_is_none) {
    scene::Scene scene = loaded({});
    scene.zoom.emplace();
    const Status status = check_state_can_be_saved(scene);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("a zoom is two runs"));
    EXPECT_THAT(run_from(scene, "nothing").error().message, HasSubstr("a zoom is two runs"));
}

}  // namespace
}  // namespace talus::run
