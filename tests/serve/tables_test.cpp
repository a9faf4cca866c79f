// Observations, triggers and alarms that are added over the API: who may, what they do, and where they are kept.
#include <fstream>
#include <utility>

#include <gmock/gmock.h>

#include "core/hash.hpp"
#include "run/run_scene.hpp"
#include "scene/bundle.hpp"
#include "scene/scene.hpp"
#include "serve/alerts_fixture.hpp"
#include "support/foreign.hpp"
#include "support/value_of.hpp"

namespace talus::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const json arrival = {{"action", "put_observation"},
                      {"section", "arrival"},
                      {"values", {{"name", "Bridge"}, {"chainage_m", 40}, {"time_s", 3}}}};
const json alarm = {{"action", "put_alarm"},
                    {"values", {{"name", "coming"}, {"chainage_m", 30}, {"distance_m", 25}, {"message", "Go."}}}};

class TablesTest : public Serve {
  protected:
    [[nodiscard]] json setup() const { return as_viewer().get("/api/scenarios/A/setup").json(); }
    /// Of the state that the run ends in.
    [[nodiscard]] std::string hash_at_end() {
        EXPECT_EQ(act({{"action", "set_speed"}, {"factor", nullptr}}).status, 200);
        EXPECT_EQ(act({{"action", "run"}}).status, 200);
        json state;
        EXPECT_TRUE(eventually([&] {
            state = as_viewer().get("/api/scenarios/A/state").json();
            return state["status"] == "ended";
        }));
        return state.value("hash", "");
    }
    [[nodiscard]] std::string hash_after_restart() {
        EXPECT_EQ(act({{"action", "restart"}}).status, 200);
        return hash_at_end();
    }
    /// As the scene's archive has it.
    [[nodiscard]] scene::Scene scene_of_archive(const std::string& name) {
        const Answer answer = as_viewer().get("/api/scenarios/A/exports/scene.zip");
        EXPECT_EQ(answer.status, 200) << answer.body;
        const auto archive = scene_.folder() / (name + ".zip");
        std::ofstream(archive, std::ios::binary) << answer.body;
        const auto unpacked = value_of(scene::unpack_bundle(archive, scene_.folder() / name, {}, foreign_reader()));
        scene_text_ = read_text(unpacked.scene);
        return value_of(scene::load_scene(unpacked.scene));
    }
    std::string scene_text_;  ///< of the archive that was read last
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
    const scene::Scene again = scene_of_archive("again");
    EXPECT_EQ(again.spec.arrivals.back().time, 3);
    EXPECT_EQ(again.spec.alarms.back().message, "Go.");
    EXPECT_EQ(again.gauges.back().name, "ford");
    EXPECT_EQ(again.spec.solver.end_time, 1000) << "with what the command line gave";
}

TEST_F(TablesTest, the_archive_of_the_scene_runs_to_the_state_of_the_restarted_scenario) {
    start({"solver.end_time_s=1.5"});
    const std::string plain = hash_after_restart();
    const json changes[] = {
        {{"action", "put_barrier"},
         {"name", "Dam"},
         {"line", {{824195.3, 825080}, {824194.7, 825120}}},
         {"height_m", 2},
         {"thickness_m", 1},
         {"openings", {{{"position_m", 20}, {"width_m", 4}, {"sill_height_m", 0.5}}}}},
        {{"action", "put_barrier"}, {"name", "Dam"}, {"line", {{824140, 825080}, {824140, 825120}}}, {"height_m", 3}},
        {{"action", "put_building"},
         {"name", "Barn"},
         {"polygon", {{824197, 825101}, {824199.1, 825101}, {824199.1, 825104.3}, {824197, 825104.3}}},
         {"height_m", 4}},
        {{"action", "put_zone"},
         {"name", "Forest"},
         {"polygon", {{824180, 825080}, {824210, 825080}, {824210, 825120}, {824180, 825120}}},
         {"friction_coefficient", 0.35}},
        {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.17}},
        {{"action", "put_alarm"},
         {"values", {{"name", "hit"}, {"structure", "Barn"}, {"distance_m", 9}, {"message", "Out."}}}},
    };
    for (const json& change : changes) {
        const Answer answer = act(change);
        ASSERT_EQ(answer.status, 200) << answer.body;
    }
    const std::string wanted = hash_after_restart();
    EXPECT_NE(wanted, plain) << "the changes must matter";

    const scene::Scene again = scene_of_archive("drawn");
    EXPECT_EQ(again.buildings.size(), 4U) << "that of the scene, the barn and two barriers";
    EXPECT_EQ(again.spec.alarms.back().structure, "Barn");
    const auto result = run::run_scene(again, {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(to_hex(result->hash), wanted);
}

TEST_F(TablesTest, the_archive_of_the_scene_has_what_moves_and_is_picked_up) {
    start({"solver.end_time_s=2"});
    json first = {{"time_s", 0}, {"discharge_m3ps", 5}, {"velocity_mps", 4}, {"density_kgpm3", 1900}};
    json last = first;
    last["time_s"] = 1;
    const json changes[] = {
        {{"action", "put_bed"},
         {"name", "Loose"},
         {"polygon", {{824195, 825085}, {824260, 825085}, {824260, 825115}, {824195, 825115}}},
         {"depth_m", 0.4},
         {"growth_rate_per_m", 0.03}},
        {{"action", "put_inflow"},
         {"name", "Gully"},
         {"line", {{824215, 825106}, {824215, 825114}}},
         {"hydrograph", {first, last}}},
        {{"action", "restart"}},
        {{"action", "put_release"},
         {"name", "Second"},
         {"polygon", {{824230, 825090}, {824240, 825090}, {824240, 825100}}},
         {"thickness_m", 0.5}},
    };
    for (const json& change : changes) {
        const Answer answer = act(change);
        ASSERT_EQ(answer.status, 200) << answer.body;
    }
    ASSERT_EQ(act({{"action", "trigger_release"}, {"id", setup()["releases"].back()["id"]}}).status, 200);
    const std::string wanted = hash_at_end();

    const scene::Scene again = scene_of_archive("moving");
    ASSERT_EQ(again.releases.size(), 2U);
    EXPECT_EQ(again.releases.back().name, "Second");
    EXPECT_EQ(again.inflows.at(0).hydrograph.at(1).density, 1900);
    EXPECT_EQ(again.bed_layers.at(0).parts.at(0).depth, 0.4);
    EXPECT_THAT(scene_text_, Not(HasSubstr("Left out")));
    const auto result = run::run_scene(again, {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(to_hex(result->hash), wanted);
}

TEST_F(TablesTest, the_archive_of_the_scene_has_no_structure_that_was_removed_and_says_what_it_lacks) {
    ASSERT_EQ(act({{"action", "remove_building"}, {"id", "building-1"}}).status, 200);
    ASSERT_EQ(act({{"action", "put_release"},
                   {"name", "Second"},
                   {"polygon", {{824230, 825090}, {824240, 825090}, {824240, 825100}}},
                   {"thickness_m", 0.5}})
                  .status,
              200);
    const scene::Scene again = scene_of_archive("removed");
    EXPECT_TRUE(again.buildings.empty());
    EXPECT_EQ(again.releases.size(), 1U);
    EXPECT_THAT(scene_text_, HasSubstr("Left out: release \"Second\", which was not triggered."));
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
