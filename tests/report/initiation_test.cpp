#include <gmock/gmock.h>

#include "report/results.hpp"
#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"

namespace talus::report {
namespace {

class InitiationTest : public scene::SceneFolder {
  protected:
    /// Of the valley, with water that rises to `ratio` in 4 s, over 6 s.
    [[nodiscard]] run::RunResult run_with(double ratio, const std::string& friction) {
        write("water.csv", fmt::format("time_s,pore_pressure_ratio\n0,0.05\n4,{}\n", ratio));
        write_valley("pore_pressure_hydrograph = \"water.csv\"\n[material]\nfriction_coefficient = " + friction +
                     "\n[solver]\nend_time_s = 6\ntarget_particle_count = 400\n");
        scene_ = loaded();
        return test::value_of(run::run_scene(scene_, {}));
    }
    scene::Scene scene_;
};

TEST_F(InitiationTest, says_when_and_at_which_ratio_a_release_failed) {
    const run::RunResult result = run_with(0.95, "0.6");
    ASSERT_EQ(result.initiations.size(), 1U);
    EXPECT_EQ(result.initiations[0].release, "scarp");
    EXPECT_GT(result.initiations[0].failed_at, 0.1);
    EXPECT_LT(result.initiations[0].failed_at, 6);
    EXPECT_GT(result.initiations[0].ratio, 0.05);
    const auto told = initiation(result);
    EXPECT_EQ(told["list"][0]["failed"], true);
    EXPECT_EQ(told["list"][0]["failed_at_s"], result.initiations[0].failed_at);
    EXPECT_EQ(told["moved_m"], result.particle_spacing);
}

TEST_F(InitiationTest, says_that_a_release_stood) {
    const run::RunResult result = run_with(0.06, "0.9");
    ASSERT_EQ(result.initiations.size(), 1U);
    EXPECT_TRUE(std::isnan(result.initiations[0].failed_at));
    EXPECT_NEAR(result.initiations[0].ratio, 0.06, 1e-6);
    const auto told = initiation(result);
    EXPECT_EQ(told["list"][0]["stood"], true);
    EXPECT_TRUE(told["list"][0]["failed_at_s"].is_null());
}

TEST_F(InitiationTest, is_not_told_of_releases_without_water) {
    EXPECT_TRUE(initiation(run::RunResult{}).is_null());
}

}  // namespace
}  // namespace talus::report
