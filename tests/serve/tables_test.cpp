// Observations, triggers and alarms that are added over the API: who may, what they do, and where they are kept.
#include <fstream>
#include <utility>

#include <gmock/gmock.h>

#include "scene/bundle.hpp"
#include "scene/scene.hpp"
#include "serve/alerts_fixture.hpp"
#include "support/foreign.hpp"

namespace talus::test {
namespace {

using ::testing::HasSubstr;

const json arrival = {{"action", "put_observation"},
                      {"section", "arrival"},
                      {"values", {{"name", "Bridge"}, {"chainage_m", 40}, {"time_s", 3}}}};
const json alarm = {{"action", "put_alarm"},
                    {"values", {{"name", "coming"}, {"chainage_m", 30}, {"distance_m", 25}, {"message", "Go."}}}};

class TablesTest : public Serve {
  protected:
    [[nodiscard]] json setup() const { return as_viewer().get("/api/scenarios/A/setup").json(); }
};

TEST_F(TablesTest, only_who_may_change_the_scenario_adds_to_them) {
    for (const json& action : {arrival, alarm}) {
        EXPECT_EQ(as_viewer().post("/api/scenarios/A/actions", action).status, 403);
        EXPECT_EQ(HttpClient(port(), "").post("/api/scenarios/A/actions", action).status, 401);
        EXPECT_EQ(act(action).status, 200);
    }
    EXPECT_EQ(setup()["observations"].back()["name"], "Bridge");
    EXPECT_EQ(setup()["alarms"].back()["name"], "coming");
    const Answer refused = act({{"action", "put_alarm"}, {"values", {{"chainage_m", 3}, {"webhook", "http://x"}}}});
    EXPECT_EQ(refused.status, 400);
    EXPECT_THAT(refused.body, HasSubstr("no such key here"));
}

TEST_F(TablesTest, observations_stand_beside_what_the_run_computes) {
    const std::size_t before = as_viewer().get("/api/scenarios/A/observed").json()["rows"].size();
    ASSERT_EQ(act(arrival).status, 200);
    ASSERT_EQ(act({{"action", "set_speed"}, {"factor", nullptr}}).status, 200);
    ASSERT_EQ(act({{"action", "run"}}).status, 200);
    json row;
    ASSERT_TRUE(eventually([&] {
        const json rows = as_viewer().get("/api/scenarios/A/observed").json()["rows"];
        EXPECT_EQ(rows.size(), before + 1);
        for (const json& each : rows) {
            if (each["name"] == "Arrival at 40 m") row = each;
        }
        return row.is_object() && row["computed"].is_number();
    }));
    EXPECT_EQ(row["observed"], 3);
    EXPECT_DOUBLE_EQ(row["uncertainty"], 0.6);
    EXPECT_EQ(row["id"], setup()["observations"].back()["id"]);
    EXPECT_NEAR(row["deviation"], (row["computed"].get<double>() - 3) / 0.6, 1e-9);
}

TEST_F(TablesTest, the_archive_of_the_scene_has_them_and_loads) {
    ASSERT_EQ(act(arrival).status, 200);
    ASSERT_EQ(act(alarm).status, 200);
    ASSERT_EQ(act({{"action", "put_gauge"}, {"name", "ford"}, {"chainage_m", 10}}).status, 200);
    const Answer answer = as_viewer().get("/api/scenarios/A/exports/scene.zip");
    ASSERT_EQ(answer.status, 200) << answer.body;
    const auto archive = scene_.folder() / "again.zip";
    std::ofstream(archive, std::ios::binary) << answer.body;
    const auto unpacked = scene::unpack_bundle(archive, scene_.folder() / "again", {}, foreign_reader());
    ASSERT_TRUE(unpacked) << unpacked.error().message;
    const auto again = scene::load_scene(unpacked->scene);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->spec.arrivals.back().time, 3);
    EXPECT_EQ(again->spec.alarms.back().message, "Go.");
    EXPECT_EQ(again->gauges.back().name, "ford");
    EXPECT_EQ(again->spec.solver.end_time, 1000) << "with what the command line gave";
}

TEST_F(TablesTest, a_calibration_fits_those_of_scenario_A) {
    const json before = as_viewer().get("/api/calibration").json()["observations"];
    ASSERT_EQ(act(arrival).status, 200);
    json now;
    ASSERT_TRUE(eventually([&] {
        now = as_viewer().get("/api/calibration").json()["observations"];
        return now.size() == before.size() + 1;
    }));
    EXPECT_EQ(now.back()["name"], "Arrival at 40 m");
    EXPECT_EQ(now.back()["observed"], 3);
}

TEST_F(AlertsTest, a_trigger_that_is_added_starts_a_run_and_one_that_is_removed_does_not) {
    serve_with({});
    act_on("A", {{"action", "put_trigger"},
                 {"values", {{"name", "tilt"}, {"release", release_name()}, {"volume_limit_m3", 500}}}});
    act_on("A", alarm);
    act_on("A", {{"action", "remove_trigger"}, {"id", "trigger-1"}});
    ASSERT_TRUE(eventually([&] { return alerts()["triggers"].back()["name"] == "tilt"; }));
    EXPECT_EQ(alerts()["triggers"].back()["limits"], json({{"volume_m3", 500}}));
    EXPECT_THAT(as_trigger().post("/api/trigger", {{"trigger", "slope"}}).body, HasSubstr("no such trigger"));
    EXPECT_THAT(as_trigger().post("/api/trigger", {{"trigger", "tilt"}, {"values", {{"volume_m3", 501}}}}).body,
                HasSubstr("volume_m3 = 501"));
    const Answer started = as_trigger().post("/api/trigger", {{"trigger", "tilt"}, {"values", {{"volume_m3", 300}}}});
    ASSERT_EQ(started.status, 200) << started.body;
    EXPECT_EQ(started.json()["scenario"], "B");
    ASSERT_TRUE(eventually([&] {
        const json now = alerts();
        for (const json& raised : now["alarms"]) {
            if (raised["alarm"] == "coming" && raised["scenario"] == "B") return true;
        }
        return false;
    })) << "its run is watched for the alarms of scenario A";
    EXPECT_EQ(alerts().dump().find(trigger), std::string::npos);
}

}  // namespace
}  // namespace talus::test
