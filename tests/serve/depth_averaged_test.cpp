#include "serve/depth_averaged.hpp"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/hash.hpp"
#include "run/run_scene.hpp"
#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class DepthAveragedTest : public Serve {
  protected:
    void SetUp() override { start({"solver.end_time_s=3"}); }

    json status(const std::string& scenario = "A") {
        return as_viewer().get("/api/scenarios/" + scenario + "/depth_averaged").json();
    }
    /// Once it neither waits nor runs.
    json settled(const std::string& scenario = "A") {
        json now;
        for (int i = 0; i < 1200; ++i) {
            now = status(scenario);
            if (now["state"] != "waiting" && now["state"] != "running") break;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return now;
    }
    Answer turn(const json& body) { return as_controller().post("/api/depth_averaged", body); }

    /// The hash of `talus run --model depth_averaged` of the scene file with these values.
    std::string hash_of(std::vector<std::string> overrides) {
        overrides.emplace_back("solver.end_time_s=3");
        overrides.emplace_back("solver.model=depth_averaged");
        const auto scene = scene::load_scene(scene_.scene_file(), overrides);
        EXPECT_TRUE(scene) << scene.error().message;
        const auto result = run::run_scene(*scene, {});
        EXPECT_TRUE(result) << result.error().message;
        return to_hex(result->hash);
    }
};

TEST_F(DepthAveragedTest, is_off_at_first_and_computes_the_present_setup_once_it_is_on) {
    EXPECT_EQ(status()["state"], "off");
    EXPECT_EQ(as_viewer().get("/api/scenarios/A/depth_averaged/layers/peak_depth").status, 404);
    EXPECT_EQ(as_viewer().post("/api/depth_averaged", {{"on", true}}).status, 403);
    EXPECT_EQ(turn({{"on", 1}}).status, 400);
    EXPECT_EQ(turn({{"on", true}, {"off", 1}}).status, 400);
    EXPECT_EQ(status()["state"], "off");

    ASSERT_EQ(turn({{"on", true}}).status, 200);
    const json first = settled();
    ASSERT_EQ(first["state"], "done") << first;
    EXPECT_EQ(first["result"]["hash"], hash_of({}));
    EXPECT_EQ(first["result"]["complete"], true);
    EXPECT_EQ(as_viewer().get("/api/scenarios/A/depth_averaged/layers/peak_depth").body.substr(0, 4), "TLSG");
    const Answer wrong = as_viewer().get("/api/scenarios/A/depth_averaged/layers/erosion_depth");
    EXPECT_EQ(wrong.status, 404);
    EXPECT_THAT(wrong.body, HasSubstr("must be one of"));
    EXPECT_EQ(as_viewer().get("/api/scenarios/A/depth_averaged/comparison").json()["over"], false);

    EXPECT_EQ(turn({{"on", false}}).status, 200);
    EXPECT_EQ(status()["state"], "off");
    EXPECT_EQ(status()["result"], nullptr);
}

TEST_F(DepthAveragedTest, a_change_discards_the_result_and_computes_anew) {
    WebSocket eye = join(viewer);
    ASSERT_EQ(turn({{"on", true}}).status, 200);
    ASSERT_EQ(settled()["state"], "done");
    const std::string before = settled()["result"]["hash"];
    for (json told; told["state"] != "done"; told = eye.wait_for("depth_averaged")) ASSERT_FALSE(eye.ended());
    const json friction = {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.1}};
    ASSERT_EQ(act(friction).status, 200);
    const json told = eye.wait_for("depth_averaged");
    EXPECT_NE(told["state"], "done");
    EXPECT_EQ(told["result"], nullptr) << "the former result is said to be that of the new setup";
    const json after = settled();
    ASSERT_EQ(after["state"], "done");
    EXPECT_NE(after["result"]["hash"], before);
    EXPECT_EQ(after["result"]["hash"], hash_of({"material.friction_coefficient=0.1"}));
    // Back again, and a restart, which changes no setup, leaves the result as it is.
    ASSERT_EQ(act({{"action", "undo"}}).status, 200);
    EXPECT_EQ(settled()["result"]["hash"], before);
    ASSERT_EQ(act({{"action", "restart"}}).status, 200);
    EXPECT_EQ(status()["state"], "done");
}

TEST_F(DepthAveragedTest, a_run_under_way_ends_when_its_setup_changes) {
    start({"solver.end_time_s=1e5", "material.friction_coefficient=0.05", "solver.grid_cell_m=1"});
    ASSERT_EQ(turn({{"on", true}}).status, 200);
    for (int i = 0; i < 500 && status()["state"] != "running"; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    // Debris that stays where it is: soon over, after what would take far longer.
    const json friction = {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 2}};
    const json end = {{"action", "set_parameter"}, {"key", "material.viscosity"}, {"value", 0.02}};
    ASSERT_EQ(act(friction).status, 200);
    ASSERT_EQ(act(end).status, 200);
    EXPECT_NE(status()["state"], "done");
    ASSERT_EQ(turn({{"on", false}}).status, 200);
    EXPECT_EQ(status()["state"], "off");
    // Ends with the server, too.
    ASSERT_EQ(turn({{"on", true}}).status, 200);
}

TEST_F(DepthAveragedTest, every_scenario_has_its_own_and_what_the_model_lacks_is_said) {
    ASSERT_EQ(turn({{"on", true}}).status, 200);
    const std::string hash = settled()["result"]["hash"];
    const json net = {{"action", "put_barrier"}, {"name", "Net"},    {"line", {{824185, 825080}, {824185, 825120}}},
                      {"height_m", 2},           {"thickness_m", 1}, {"passing_share", 0.5}};
    ASSERT_EQ(as_controller().post("/api/scenarios", {{"copy_of", "A"}, {"action", net}}).status, 200);
    json of_b = status("B");
    for (int i = 0; i < 500 && of_b["state"] != "refused"; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        of_b = status("B");
    }
    EXPECT_EQ(of_b["state"], "refused");
    EXPECT_EQ(of_b["message"], "The depth-averaged model has no nets, and \"Net\" is one.");
    EXPECT_THAT(as_viewer().get("/api/scenarios/B/depth_averaged/layers/peak_depth").body, HasSubstr("has no nets"));
    EXPECT_EQ(status()["result"]["hash"], hash) << "that of A is as it was";
    EXPECT_EQ(as_controller().ask("DELETE", "/api/scenarios/B").status, 200);
    EXPECT_EQ(as_viewer().get("/api/scenarios/B/depth_averaged").status, 404);
}

}  // namespace
}  // namespace talus::test
