#include "session/depth_averaged.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <gmock/gmock.h>

#include "core/hash.hpp"
#include "run/run_scene.hpp"
#include "session/page_fixture.hpp"

namespace talus::session {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using ::testing::HasSubstr;

class DepthAveragedInAPage : public PageOfASession {
  protected:
    json turn(bool on) { return json::parse(*ask("POST", "/api/depth_averaged", json{{"on", on}}.dump()).body); }
    void act(const json& action) {
        const PageAnswer done = ask("POST", "/api/scenarios/A/actions", action.dump());
        ASSERT_EQ(done.status, 200) << *done.body;
    }
    json status(const std::string& scenario = "A") {
        return json::parse(*ask("GET", "/api/scenarios/" + scenario + "/depth_averaged").body);
    }
    json state() { return json::parse(*ask("GET", "/api/scenarios/A/state").body); }
    void advance() { session_->advance(now_, milliseconds(20)); }
    /// Once it neither waits nor runs.
    json settled(const std::string& scenario = "A") {
        const auto goes_on = [](const json& now) { return now["state"] == "waiting" || now["state"] == "running"; };
        for (int i = 0; i < 100'000 && goes_on(status(scenario)); ++i) advance();
        return status(scenario);
    }
    static std::string hash_of(scene::Scene scene) {
        scene.spec.solver.model = params::ModelChoice::depth_averaged;
        const auto result = run::run_scene(scene, {});
        EXPECT_TRUE(result) << result.error().message;
        return to_hex(result->hash);
    }
};

TEST_F(DepthAveragedInAPage, is_off_at_first_and_computes_the_present_setup_once_it_is_on) {
    EXPECT_EQ(status()["state"], "off");
    EXPECT_EQ(ask("GET", "/api/scenarios/A/depth_averaged/layers/peak_depth").status, 404);
    EXPECT_EQ(ask("GET", "/api/scenarios/B/depth_averaged").status, 404);
    EXPECT_EQ(ask("POST", "/api/depth_averaged", R"({"on": 1})").status, 400);
    EXPECT_EQ(ask("POST", "/api/depth_averaged", R"({"on": true, "off": 1})").status, 400);
    EXPECT_EQ(turn(true)["done"], "depth-averaged model on");
    const json done = settled();
    ASSERT_EQ(done["state"], "done") << done;
    EXPECT_EQ(done["result"]["hash"], hash_of(*scene_));
    EXPECT_EQ(ask("GET", "/api/scenarios/A/depth_averaged/layers/peak_depth?time_s=2").body->substr(0, 4), "TLSG");
    EXPECT_THAT(*ask("GET", "/api/scenarios/A/depth_averaged/layers/nothing").body, HasSubstr("must be one of"));
    EXPECT_EQ(ask("GET", "/api/scenarios/A/depth_averaged/else").status, 404);
    EXPECT_FALSE(json::parse(*ask("GET", "/api/scenarios/A/depth_averaged/comparison").body)["rows"].empty());
    EXPECT_EQ(turn(false)["done"], "depth-averaged model off");
    EXPECT_EQ(status()["state"], "off");
    EXPECT_TRUE(status()["result"].is_null());
}

TEST_F(DepthAveragedInAPage, takes_turns_with_a_live_run_and_changes_nothing_of_it) {
    act({{"action", "set_speed"}, {"factor", nullptr}});
    act({{"action", "run"}});
    turn(true);
    double before = 0;
    bool both = false;
    for (int i = 0; i < 100'000 && status()["state"] != "done"; ++i) {
        advance();
        const double now = state()["time_s"];
        both = both || (status()["state"] == "running" && before > 0 && now > before);
        before = now;
    }
    EXPECT_TRUE(both) << "the live run goes on meanwhile";
    for (int i = 0; i < 100'000 && state()["status"] == "running"; ++i) advance();
    const auto alone = run::run_scene(*scene_, {});
    ASSERT_TRUE(alone);
    EXPECT_EQ(state()["hash"], to_hex(alone->hash));
}

TEST_F(DepthAveragedInAPage, computes_a_changed_setup_again_and_a_new_scenario_as_well) {
    turn(true);
    advance();
    EXPECT_EQ(status()["state"], "running");
    act({{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.4}});
    scene::Scene changed = *scene_;
    changed.spec.material.friction_coefficient = 0.4;
    EXPECT_EQ(settled()["result"]["hash"], hash_of(changed));
    EXPECT_EQ(ask("POST", "/api/scenarios", R"({"copy_of": "A", "action": null})").status, 200);
    EXPECT_EQ(settled("B")["result"]["hash"], status()["result"]["hash"]);
    const auto told = [&](const Bytes& text) { return text->find("\"depth_averaged\"") != std::string::npos; };
    const auto events = session_->events(ann_);
    EXPECT_GE(std::count_if(events.begin(), events.end(), told), 4) << "that it runs, and how it ended, of each";
}

TEST_F(DepthAveragedInAPage, ends_a_run_that_nobody_wants_any_more) {
    turn(true);
    advance();
    ASSERT_EQ(status()["state"], "running");
    turn(false);
    advance();  // tells everybody
    const auto before = time_;
    advance();
    EXPECT_LT(time_ - before, milliseconds(10)) << "there is nothing left to compute";
}

TEST(DepthAveragedResults, takes_no_result_that_nobody_asked_for) {
    DepthAveragedResults results;
    EXPECT_FALSE(results.begin()) << "it is off";
    DepthAveragedResults::Task task{0, 7, [] { return Result<scene::Scene>(Error{"lacks this"}); }};
    EXPECT_FALSE(results.wants(task));
    results.finish(task, {.refused = "lacks this"});
    EXPECT_EQ(results.describe(0).state, "off") << "nobody asked";
    EXPECT_THAT(results.why_none(0), HasSubstr("it is off"));
}

}  // namespace
}  // namespace talus::session
