#include "run/saved_state.hpp"

#include <cstring>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>

#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

using testing::HasSubstr;

/// Down a slope and out on level ground: a release that entrains its bed, an inflow, a heap at rest on the level, a
/// barrier that fails, one that stands, and a gauge.
class SavedState : public scene::SceneFolder {
  protected:
    void SetUp() override {
        write_terrain("dem.tif", [](double x, double y) {
            return 200 - 0.5 * std::min(x - west, 70.0) + 0.1 * std::abs(y - (south + 100));
        });
        write_features("release.geojson", {rectangle(20, 90, 40, 110)});
        write_features("heap.geojson", {rectangle(150, 90, 170, 110)});
        write("flow.csv", "time_s,discharge_m3ps,velocity_mps\n0,30,4\n7,30,4\n");
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

    [[nodiscard]] scene::Scene loaded(std::vector<std::string> overrides = {}) const {
        overrides.insert(overrides.begin(), {"solver.target_particle_count=600", "solver.end_time_s=8"});
        auto scene = scene::load_scene(folder / "scene.toml", overrides);
        if (!scene) throw std::runtime_error(scene.error().message);
        return std::move(*scene);
    }

    /// The state of the scene at a time; at the end without one.
    static std::string state_at(const scene::Scene& scene, std::optional<double> time) {
        std::string state;
        RunOptions options;
        options.save_time = time;
        options.on_state = [&](const std::string& saved, double) { state = saved; };
        const auto result = run_scene(scene, options);
        if (!result) throw std::runtime_error(result.error().message);
        return state;
    }
    static Result<RunResult> run_from(const scene::Scene& scene, const std::string& state) {
        RunOptions options;
        options.start_from = state;
        options.start_from_file = "run.state";
        return run_scene(scene, options);
    }
    [[nodiscard]] std::string refusal(const std::string& state, const std::vector<std::string>& overrides) const {
        const auto result = run_from(loaded(overrides), state);
        return result ? "(it ran)" : result.error().message;
    }
};

void expect_same_map(const Grid<float>& a, const Grid<float>& b, const char* name) {
    ASSERT_EQ(a.values.size(), b.values.size()) << name;
    EXPECT_EQ(std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)), 0) << name;
}

void expect_same(const RunResult& a, const RunResult& b) {
    EXPECT_EQ(a.hash, b.hash);
    EXPECT_EQ(a.steps, b.steps);
    EXPECT_EQ(a.stop_reason, b.stop_reason);
    EXPECT_EQ(a.smallest_time_step, b.smallest_time_step);
    const observe::Observation &o = a.observation, &p = b.observation;
    expect_same_map(o.maps.peak_depth, p.maps.peak_depth, "peak depth");
    expect_same_map(o.maps.peak_speed, p.maps.peak_speed, "peak speed");
    expect_same_map(o.maps.arrival_time, p.maps.arrival_time, "arrival time");
    expect_same_map(o.maps.deposit_depth, p.maps.deposit_depth, "deposit depth");
    expect_same_map(o.erosion.depth, p.erosion.depth, "erosion");
    ASSERT_EQ(o.timeseries.size(), p.timeseries.size());
    for (std::size_t k = 0; k < o.timeseries.size(); ++k) {
        EXPECT_EQ(o.timeseries[k].time, p.timeseries[k].time);
        EXPECT_EQ(o.timeseries[k].kinetic_energy, p.timeseries[k].kinetic_energy);
        EXPECT_EQ(o.timeseries[k].volume_entrained, p.timeseries[k].volume_entrained);
    }
    ASSERT_EQ(o.front.size(), p.front.size());
    for (std::size_t k = 0; k < o.front.size(); ++k) EXPECT_EQ(o.front[k].arrival_time, p.front[k].arrival_time);
    ASSERT_EQ(o.buildings.size(), p.buildings.size());
    for (std::size_t k = 0; k < o.buildings.size(); ++k) {
        EXPECT_EQ(o.buildings[k].impulse, p.buildings[k].impulse);
        EXPECT_EQ(o.buildings[k].peak_force, p.buildings[k].peak_force);
        EXPECT_EQ(o.buildings[k].overtopped_volume, p.buildings[k].overtopped_volume);
        EXPECT_EQ(o.buildings[k].history.size(), p.buildings[k].history.size());
    }
    ASSERT_EQ(o.gauges.size(), 1U);
    EXPECT_EQ(o.gauges[0].peak_depth, p.gauges[0].peak_depth);
    EXPECT_EQ(o.gauges[0].rows.size(), p.gauges[0].rows.size());
    EXPECT_EQ(o.run_out.along_flow, p.run_out.along_flow);
    EXPECT_EQ(o.energy.gained, p.energy.gained);
    EXPECT_EQ(o.compression.mean_iterations, p.compression.mean_iterations);
}

TEST_F(SavedState, ARunThatStartsFromItIsTheOneThatWasNotInterrupted) {
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

TEST_F(SavedState, HasSleepingDebrisThatSleepsOn) {
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

TEST_F(SavedState, OfTheEndIsContinuedToALaterOne) {
    const auto whole = run_scene(loaded(), {});
    ASSERT_TRUE(whole);
    const auto rest = run_from(loaded(), state_at(loaded({"solver.end_time_s=5"}), {}));
    ASSERT_TRUE(rest) << rest.error().message;
    EXPECT_EQ(rest->hash, whole->hash);
    expect_same_map(rest->observation.maps.peak_depth, whole->observation.maps.peak_depth, "peak depth");
}

TEST_F(SavedState, OfSomethingElseIsRefusedAndSaysWhatIsDifferent) {
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

TEST_F(SavedState, ThereIsNoneOfTheDepthAveragedModel) {
    scene::Scene scene = loaded({});
    scene.spec.solver.model = params::ModelChoice::depth_averaged;
    const Status status = check_state_can_be_saved(scene);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("needs particles"));
}

}  // namespace
}  // namespace talus::run
