#include <utility>

#include <gmock/gmock.h>

#include "serve/alerts_fixture.hpp"
#include "twin/journal.hpp"

namespace talus::test {
namespace {

using ::testing::HasSubstr;

TEST_F(AlertsTest, its_token_starts_a_run_and_does_nothing_else_and_no_other_token_does) {
    serve_with({});
    const json message = {{"trigger", "slope"}, {"values", {{"volume_m3", 300}}}, {"reason", "tilt meter 2"}};
    EXPECT_EQ(HttpClient(port()).post("/api/trigger", message).status, 401);
    const Answer none = HttpClient(port(), "").post("/api/trigger", message);
    EXPECT_THAT(none.body, HasSubstr("no token is given"));
    const Answer wrong = HttpClient(port(), "trigger-token-of-the-testx").post("/api/trigger", message);
    EXPECT_EQ(wrong.status, 401);
    EXPECT_THAT(wrong.body, HasSubstr("the token is wrong; header"));
    EXPECT_THAT(wrong.body, HasSubstr("--trigger-token-file"));
    EXPECT_EQ(wrong.body.find("links"), std::string::npos) << "which do not have it";
    EXPECT_EQ(as_viewer().post("/api/trigger", message).status, 403);
    EXPECT_EQ(as_controller().post("/api/trigger", message).status, 403);
    for (const char* target : {"/api/session", "/api/scenarios/A/state", "/api/alerts", "/api/terrain"}) {
        const Answer refused = as_trigger().get(target);
        EXPECT_EQ(refused.status, 403) << target;
        EXPECT_THAT(refused.body, HasSubstr("POST /api/trigger alone"));
    }
    EXPECT_EQ(as_trigger().post("/api/scenarios/A/actions", {{"action", "run"}}).status, 403);
    EXPECT_EQ(join(trigger).status(), 403);
    // A person cannot pretend to be a trigger.
    EXPECT_EQ(act({{"action", "trigger"}, {"trigger", "slope"}}).status, 400);
    EXPECT_EQ(act({{"action", "gauge"}, {"trigger", "gauge"}}).status, 400);

    WebSocket ada = join(controller, "Ada"), eve = join(viewer, "Eve");
    const Answer started = as_trigger().post("/api/trigger", message);
    ASSERT_EQ(started.status, 200) << started.body;
    EXPECT_EQ(started.json()["scenario"], "B");
    EXPECT_EQ(started.json()["started"], true);
    for (WebSocket* person : {&ada, &eve}) {
        json run;
        ASSERT_TRUE(eventually([&] {
            const json told = person->wait_for("alerts");
            if (told.is_object() && !told["runs"].empty()) run = told["runs"][0];
            return !run.is_null();
        }));
        EXPECT_EQ(run["trigger"], "slope");
        EXPECT_EQ(run["source"], "HTTP");
        EXPECT_EQ(run["reason"], "tilt meter 2");
        EXPECT_EQ(run["values"]["volume_m3"], 300);
    }
    ASSERT_TRUE(eventually([&] { return state("B")["time_s"] > 0.2; }));
    EXPECT_EQ(state("A")["status"], "paused");
    EXPECT_EQ(as_trigger().post("/api/trigger", message).status, 409);
    EXPECT_THAT(log(), HasSubstr("started by trigger \"slope\", volume 300 m3: tilt meter 2"));
    EXPECT_EQ(log().find(trigger), std::string::npos);
    EXPECT_EQ(as_viewer().get("/api/scenarios/B/journal").body.find(trigger), std::string::npos);
}

TEST_F(AlertsTest, a_bad_message_is_refused_with_one_sentence_and_noted) {
    serve_with({});
    const std::pair<std::string, const char*> bad[] = {
        {"", "not valid JSON"},
        {"[]", "must be a JSON object"},
        {"{\"trigger\": \"slope\", \"trigger\": \"gauge\"}", "twice"},
        {R"({"trigger": "slop"})", "there is no such trigger"},
        {R"({"trigger": 3})", "trigger = 3"},
        {R"({"values": {}})", "trigger: missing"},
        {R"({"trigger": "slope", "scenario": "A"})", "scenario"},
        {R"({"trigger": "slope", "values": {"volume_m3": 2001}})", "volume_m3 = 2001"},
        {R"({"trigger": "slope", "values": {"volume_m3": NaN}})", "not valid JSON"},
        {R"({"trigger": "slope", "values": {"volume_m3": 1e999}})", ""},
        {R"({"trigger": "slope", "values": {"discharge_m3ps": 3}})", "does not take it"},
        {R"({"trigger": "gauge", "values": {"discharge_m3ps": 51}})", "discharge_m3ps = 51"},
        {R"({"trigger": "gauge", "values": {"discharge_m3ps": -1}})", "discharge_m3ps = -1"},
        {R"({"trigger": "slope", "time": "yesterday"})", "UTC"},
        {R"({"trigger": "slope", "time": "2020-01-01T00:00:00Z"})", "300 s old"},
        {R"({"trigger": "slope", "time": "2120-01-01T00:00:00Z"})", "5 s ahead"},
    };
    for (const auto& [body, sentence] : bad) {
        const Answer answer = as_trigger().ask("POST", "/api/trigger", body);
        EXPECT_EQ(answer.status, 400) << body << answer.body;
        EXPECT_THAT(answer.body, HasSubstr(sentence)) << body;
    }
    EXPECT_EQ(as_viewer().get("/api/session").json()["scenarios"], json({"A"}));
    EXPECT_THAT(alerts()["notes"].dump(), HasSubstr("refused"));
    EXPECT_EQ(as_trigger().ask("POST", "/api/trigger", std::string(5000, ' ')).status, 413);
}

TEST(TriggerMessage, of_a_clock_that_is_ahead_does_not_outdate_those_after_it) {
    const serve::WallTime now = std::chrono::system_clock::from_time_t(1'800'000'000);
    const auto at = [&](int seconds) {
        const std::string time = serve::time_text(now + std::chrono::seconds(seconds));
        return serve::read_trigger_message(R"({"trigger": "gauge", "time": ")" + time + "\"}", now);
    };
    for (const int ahead : {0, 1, 5}) {
        ASSERT_TRUE(at(ahead)) << ahead;
        EXPECT_EQ(at(ahead)->time, now) << "a correct value of a second later is later";
    }
    EXPECT_FALSE(at(6));
    EXPECT_FALSE(at(60));
    EXPECT_EQ(at(-300)->time, now - std::chrono::seconds(300));
    EXPECT_FALSE(at(-301));
}

TEST_F(AlertsTest, floods_are_refused_and_nothing_starts_unless_it_is_configured) {
    serve_with({});
    int refused = 0;
    HttpClient client = as_trigger();
    for (int i = 0; i < 200 && refused == 0; ++i) {
        refused += client.post("/api/trigger", {{"trigger", "nothing"}}).status == 429 ? 1 : 0;
    }
    EXPECT_EQ(refused, 1);
    serve_with({}, false);
    EXPECT_EQ(HttpClient(port(), trigger).post("/api/trigger", {{"trigger", "slope"}}).status, 401);
    EXPECT_EQ(HttpClient(port(), "").post("/api/trigger", {{"trigger", "slope"}}).status, 401);
    EXPECT_EQ(alerts()["listening"]["http"], false);
}

TEST_F(AlertsTest, a_gauge_starts_a_run_and_feeds_it_and_the_journal_replays_to_the_same_hash) {
    serve_with({});
    const auto send = [&](double discharge) {
        return as_trigger().post("/api/trigger", {{"trigger", "gauge"}, {"values", {{"discharge_m3ps", discharge}}}});
    };
    EXPECT_EQ(send(1.5).json()["started"], false);  // below start_discharge_m3ps
    const Answer started = send(6);
    ASSERT_EQ(started.status, 200) << started.body;
    ASSERT_EQ(started.json()["scenario"], "B");
    ASSERT_TRUE(eventually([&] { return state("B")["time_s"] > 0.3; }));
    const Answer more = send(12);
    ASSERT_EQ(more.status, 200) << more.body;
    EXPECT_THAT(more.body, HasSubstr("12 m3/s"));
    EXPECT_EQ(more.json()["started"], false);
    const Answer volume = as_trigger().post("/api/trigger", {{"trigger", "gauge"}, {"values", json::object()}});
    EXPECT_EQ(volume.status, 409);
    EXPECT_EQ(alerts()["runs"][0]["reading"]["discharge_m3ps"], 12);
    const double reached = state("B")["time_s"];
    ASSERT_TRUE(eventually([&] { return state("B")["time_s"] > reached + 1; }));
    act_on("B", {{"action", "pause"}});
    const std::string journal = as_viewer().get("/api/scenarios/B/journal").body;
    const auto read = twin::read_journal(journal);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->entries.size(), 2U);
    EXPECT_EQ(read->entries[0].action["action"], "trigger");
    EXPECT_EQ(read->entries[1].action["action"], "gauge");
    EXPECT_EQ(read->entries[1].by, "trigger \"gauge\"");
    auto scene = scene::load_scene(scene_.scene_file(), {"solver.end_time_s=1000"});
    ASSERT_TRUE(scene);
    const auto again = twin::replay(*read, std::make_shared<const scene::Scene>(std::move(*scene)));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, read->hash);
    EXPECT_EQ(again->hash, state("B")["hash"]);
}

TEST_F(AlertsTest, people_cannot_take_the_place_of_a_run_of_a_trigger) {
    serve_with({});
    for (int i = 0; i < 4; ++i) EXPECT_EQ(as_controller().post("/api/scenarios", {{"copy_of", "A"}}).status, 200);
    const Answer full = as_controller().post("/api/scenarios", {{"copy_of", "A"}});
    EXPECT_EQ(full.status, 409);
    EXPECT_THAT(full.body, HasSubstr("beside one that a trigger starts"));
    const Answer started = as_trigger().post("/api/trigger", {{"trigger", "slope"}});
    EXPECT_EQ(started.json()["scenario"], "F") << started.body;
    const Answer none = as_trigger().post("/api/trigger", {{"trigger", "gauge"}, {"values", {{"discharge_m3ps", 5}}}});
    EXPECT_EQ(none.status, 409);
    EXPECT_THAT(none.body, HasSubstr("every place"));
}

}  // namespace
}  // namespace talus::test
