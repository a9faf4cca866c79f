#include "serve/calibrations.hpp"

#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

const json two_parameters = {{"parameters",
                              {{{"key", "material.friction_coefficient"}, {"low", 0.1}, {"high", 0.6}},
                               {{"key", "material.viscosity"}, {"low", 0.01}, {"high", 0.4}}}},
                             {"runs", 8}};

class CalibrationsTest : public Serve {
  protected:
    json status() { return as_viewer().get("/api/calibration").json(); }
    json status_after(const std::vector<std::string>& states) {
        json now;
        for (int i = 0; i < 1200; ++i) {
            now = status();
            for (const std::string& state : states) {
                if (now["state"] == state) return now;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        return now;
    }
};

TEST_F(CalibrationsTest, finds_values_that_one_action_takes_over) {
    start({"solver.end_time_s=1"});
    EXPECT_EQ(status()["state"], "idle");
    EXPECT_EQ(status()["why_not"], nullptr);
    EXPECT_EQ(status()["observations"][0]["observed"], 3);
    WebSocket eye = join(viewer);
    EXPECT_EQ(eye.wait_for("calibration")["state"], "idle");

    HttpClient hand = as_controller();
    const Answer begun = hand.post("/api/calibration", two_parameters);
    ASSERT_EQ(begun.status, 200) << begun.body;
    EXPECT_EQ(begun.json()["done"], "calibration of friction coefficient, viscosity with at most 8 runs");
    EXPECT_EQ(hand.post("/api/calibration", two_parameters).status, 409);
    const json told = eye.wait_for("calibration");
    EXPECT_EQ(told["state"], "running");
    EXPECT_EQ(told["parameters"][1]["key"], "material.viscosity");

    const json end = status_after({"done", "failed"});
    ASSERT_EQ(end["state"], "done") << end["message"];
    EXPECT_EQ(end["runs"].size(), 6U);  // a round of the search takes four, for which eight leave no room
    EXPECT_EQ(end["runs"][0]["phase"], "design");
    EXPECT_EQ(end["map"]["misfit"].size(),
              end["map"]["columns"].get<std::size_t>() * end["map"]["rows"].get<std::size_t>());
    const json& best = end["best"];
    for (const json& run : end["runs"]) EXPECT_LE(best["misfit"], run["misfit"]);
    EXPECT_EQ(end["runs"][best["run"].get<std::size_t>()]["values"], best["values"]);
    EXPECT_DOUBLE_EQ(end["result"]["parameters"][0]["best"], best["values"][0]);
    EXPECT_FALSE(fs::exists(scene_.folder() / "calibration")) << "the runs are left";

    const json before = hand.get("/api/scenarios/A/setup").json()["parameters"];
    const json values = {{"material.friction_coefficient", best["values"][0]},
                         {"material.viscosity", best["values"][1]}};
    const Answer used = act({{"action", "set_parameters"}, {"values", values}});
    ASSERT_EQ(used.status, 200) << used.body;
    EXPECT_THAT(used.json()["done"].get<std::string>(), HasSubstr(", viscosity "));
    const json after = hand.get("/api/scenarios/A/setup").json()["parameters"];
    EXPECT_EQ(after["material.friction_coefficient"], best["values"][0]);
    EXPECT_EQ(after["material.viscosity"], best["values"][1]);
    EXPECT_EQ(act({{"action", "undo"}}).status, 200);
    EXPECT_EQ(hand.get("/api/scenarios/A/setup").json()["parameters"], before);
}

TEST_F(CalibrationsTest, goes_on_beside_the_live_run_and_can_be_cancelled) {
    ASSERT_EQ(as_controller().post("/api/calibration", two_parameters).status, 200);
    act({{"action", "run"}});
    const auto step = [&] { return as_viewer().get("/api/scenarios/A/state").json()["step"].get<int>(); };
    for (int i = 0; i < 200 && step() < 20; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_GE(step(), 20);
    EXPECT_EQ(status()["state"], "running");
    EXPECT_EQ(as_viewer().ask("DELETE", "/api/calibration").status, 403);
    EXPECT_EQ(as_controller().ask("DELETE", "/api/calibration").status, 200);
    EXPECT_EQ(status_after({"cancelled"})["state"], "cancelled");
    EXPECT_EQ(as_controller().ask("DELETE", "/api/calibration").status, 409);
    // Ends with the server, too.
    EXPECT_EQ(as_controller().post("/api/calibration", two_parameters).status, 200);
}

TEST_F(CalibrationsTest, searches_with_the_depth_averaged_model) {
    start({"solver.end_time_s=1"});
    json two_models = two_parameters;
    two_models["search_with"] = "depth_averaged";
    two_models["runs"] = 3;
    const Answer begun = as_controller().post("/api/calibration", two_models);
    ASSERT_EQ(begun.status, 200) << begun.body;
    EXPECT_EQ(begun.json()["done"],
              "calibration of friction coefficient, viscosity with at most 3 runs and 100 of the depth-averaged model");
    json now = status();
    for (int i = 0; i < 1200 && now["fast_runs"].size() < 2; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        now = status();
    }
    EXPECT_GE(now["fast_runs"].size(), 2U);
    EXPECT_EQ(now["fast_runs"][0]["phase"], "design");
    EXPECT_EQ(now["fast_runs"][0]["values"].size(), 2U) << "a dot on the map";
    EXPECT_EQ(now["fast_runs_at_most"], 100);
    EXPECT_EQ(now["runs"].size(), 0U) << "particles wait for the fast model's design";
    EXPECT_EQ(as_controller().ask("DELETE", "/api/calibration").status, 200);
    EXPECT_EQ(status_after({"cancelled"})["state"], "cancelled");
    two_models["search_with"] = "particles";
    EXPECT_THAT(as_controller().post("/api/calibration", two_models).body, HasSubstr("depth_averaged or null"));
}

TEST_F(CalibrationsTest, what_cannot_be_is_refused_in_a_sentence) {
    const auto refusal = [&](const json& body, int status = 400) {
        const Answer answer = as_controller().post("/api/calibration", body);
        EXPECT_EQ(answer.status, status) << answer.body;
        return answer.body;
    };
    const auto one = [](const json& key, const json& low, const json& high) {
        return json{{"parameters", {{{"key", key}, {"low", low}, {"high", high}}}}};
    };
    EXPECT_THAT(refusal(json::object()), HasSubstr("parameters"));
    EXPECT_THAT(refusal({{"parameters", json::array()}}), HasSubstr("1 to 6"));
    EXPECT_THAT(refusal({{"parameters", {1}}}), HasSubstr("object"));
    EXPECT_THAT(refusal(one("solver.end_time_s", 1, 2)), HasSubstr("solver.end_time_s"));
    EXPECT_THAT(refusal(one(3, 1, 2)), HasSubstr("key = 3"));
    EXPECT_THAT(refusal(one("material.viscosity", 0.3, 0.3)), HasSubstr("low below high"));
    EXPECT_THAT(refusal(one("material.viscosity", nullptr, 0.3)), HasSubstr("must be numbers"));
    EXPECT_THAT(refusal(one("material.friction_coefficient", -5, -4)), HasSubstr("friction_coefficient"));
    json few = two_parameters;
    few["runs"] = 4;
    EXPECT_THAT(refusal(few), HasSubstr("runs = 4"));
    few["runs"] = -1;
    EXPECT_THAT(refusal(few), HasSubstr("runs = -1"));
    EXPECT_EQ(status()["state"], "idle");
    EXPECT_EQ(as_viewer().post("/api/calibration", two_parameters).status, 403);
}

TEST_F(CalibrationsTest, a_scene_without_observations_says_why) {
    scene_.replace("[[observation]]\nchainage_m = 5\nfront_velocity_mps = 3\n", "");
    start();
    EXPECT_THAT(status()["why_not"].get<std::string>(), HasSubstr("no field observations"));
    EXPECT_EQ(as_controller().post("/api/calibration", two_parameters).status, 409);
}

TEST_F(CalibrationsTest, is_kept_where_wanted) {
    keep_ = true;
    start({"solver.end_time_s=0.5"});
    ASSERT_EQ(as_controller().post("/api/calibration", two_parameters).status, 200);
    const json end = status_after({"done", "failed"});
    ASSERT_EQ(end["state"], "done") << end["message"];
    EXPECT_EQ(end["message"], "");
    EXPECT_TRUE(fs::exists(scene_.folder() / "calibration_1" / "report.html"));
}

}  // namespace
}  // namespace talus::test
