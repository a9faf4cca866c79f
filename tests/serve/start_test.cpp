#include <chrono>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>

#include "serve/session_file.hpp"
#include "serve/start_fixture.hpp"

namespace talus::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST_F(StartPage, opens_a_recent_scene_and_nothing_before) {
    EXPECT_EQ(hand().get("/api/scene").status, 409);
    EXPECT_EQ(WebSocket(server_->port(), std::string("token=") + viewer).status(), 409);
    const json before = page();
    EXPECT_TRUE(before["open"].is_null());
    EXPECT_EQ(before["scenes"][0]["title"], "Plane");
    EXPECT_EQ(before["scenes"].back()["kind"], "builtin");
    const json after = open({{"scene", id()}});
    EXPECT_TRUE(after["error"].is_null()) << after["error"];
    EXPECT_EQ(after["open"]["title"], "Plane");
    EXPECT_EQ(hand().get("/api/scene").json()["title"], "Plane");
}

TEST_F(StartPage, viewers_see_no_files_and_change_nothing) {
    HttpClient eye(server_->port(), viewer);
    const json seen = eye.get("/api/start").json();
    EXPECT_FALSE(seen.contains("scenes") || seen.contains("sessions") || seen.contains("folder"));
    EXPECT_EQ(eye.post("/api/open", {{"scene", "sham_tseng"}}).status, 403);
    EXPECT_EQ(eye.post("/api/sessions", {{"name", "mine"}}).status, 403);
    EXPECT_EQ(eye.ask("DELETE", "/api/recent/" + id()).status, 403);
    EXPECT_EQ(eye.ask("POST", "/api/quit").status, 403);
    EXPECT_FALSE(quit_);
}

TEST_F(StartPage, triggers_work_on_every_scene_that_has_them) {
    alerts_.http = true;
    start();
    const auto told = [&] { return HttpClient(server_->port(), trigger).post("/api/trigger", {{"trigger", "slope"}}); };
    EXPECT_EQ(told().status, 409) << "no scene is open";
    open({{"scene", id()}});
    EXPECT_THAT(told().body, HasSubstr("the scene has no [[trigger]]"));
    EXPECT_EQ(hand().get("/api/alerts").json()["listening"]["http"], false);
    // No place is kept free for runs of triggers.
    for (int i = 0; i < 5; ++i) EXPECT_EQ(hand().post("/api/scenarios", {{"copy_of", "A"}}).status, 200);

    std::ofstream(scene_.scene_file(), std::ios::app) << "\n[[trigger]]\nname = \"slope\"\n";
    open({{"scene", id()}, {"replace", true}});
    const Answer started = told();
    EXPECT_EQ(started.status, 200) << started.body;
    EXPECT_EQ(started.json()["scenario"], "B");
    EXPECT_EQ(hand().get("/api/alerts").json()["runs"][0]["trigger"], "slope");
}

TEST_F(StartPage, opens_no_path_of_a_request) {
    for (const std::string& name :
         {std::string(scene_.scene_file()), std::string("../slope.toml"), std::string("slope")}) {
        EXPECT_EQ(hand().post("/api/open", {{"scene", name}}).status, 404) << name;
        EXPECT_EQ(hand().post("/api/open", {{"session", name}}).status, 404) << name;
    }
    EXPECT_EQ(hand().post("/api/open", {{"file", std::string(scene_.scene_file())}}).status, 400);
    EXPECT_EQ(hand().post("/api/open", json::object()).status, 400);
}

TEST_F(StartPage, a_session_is_replaced_only_after_asking_and_its_viewers_are_told) {
    open({{"scene", id()}});
    EXPECT_EQ(hand().post("/api/open", {{"scene", id()}}).status, 409);
    WebSocket ada(server_->port(), std::string("token=") + controller + "&name=Ada");
    ASSERT_FALSE(ada.wait_for("hello").is_null());
    const Answer held = hand().post("/api/open", {{"scene", id()}, {"replace", true}});
    EXPECT_EQ(held.status, 409);
    EXPECT_THAT(held.body, HasSubstr("Ada"));
    WebSocket eve(server_->port(), std::string("token=") + viewer + "&name=Eve");
    ASSERT_FALSE(eve.wait_for("hello").is_null());
    ada.socket().kill();
    // Ada keeps control for a while after her connection broke.
    const json wanted = {{"scene", id()}, {"replace", true}};
    int status = 0;
    for (int i = 0; i < 200 && status != 202; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        status = hand().post("/api/open", wanted).status;
    }
    EXPECT_EQ(status, 202);
    EXPECT_EQ(opened()["count"], 2);
    EXPECT_FALSE(eve.wait_for("ended").is_null());
    EXPECT_EQ(act({{"action", "step"}}).status, 200);
}

TEST_F(StartPage, a_scene_that_cannot_be_opened_leaves_the_open_one) {
    open({{"scene", id()}});
    std::ofstream(scene_.input("broken.toml"))
        << "[terrain]\nfile = \"none.tif\"\n[[release]]\nfile = \"none.geojson\"\nthickness_m = 1\n";
    ASSERT_TRUE(serve::Library(folder()).remember(scene_.input("broken.toml"), "Broken"));
    const json after = open({{"scene", id()}, {"replace", true}});
    EXPECT_THAT(after["error"].dump(), HasSubstr("none.tif"));
    EXPECT_EQ(after["open"]["title"], "Plane");
    EXPECT_EQ(act({{"action", "step"}}).status, 200);
}

TEST_F(StartPage, a_saved_session_opens_bit_for_bit) {
    open({{"scene", id()}});
    for (int i = 0; i < 30; ++i) act({{"action", "step"}});
    act({{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.2}});
    act({{"action", "name_scenario"}, {"name", "slippery"}});
    EXPECT_EQ(hand().post("/api/scenarios", {{"copy_of", "A"}}).status, 200);
    EXPECT_EQ(hand().ask("DELETE", "/api/scenarios/B").status, 200);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(hand().post("/api/scenarios", {{"copy_of", "A"}}).status, 200);
    EXPECT_EQ(hand().ask("DELETE", "/api/scenarios/B").status, 200);
    for (int i = 0; i < 30; ++i) act({{"action", "step"}, {"scenarios", {"A", "C"}}});
    const json before = hand().get("/api/session/file").json();
    EXPECT_EQ(before["scenarios"].size(), 2U);
    EXPECT_EQ(hand().post("/api/sessions", {{"name", "Two runs!"}}).json()["created"], "two-runs");

    const json after = open({{"session", "two-runs"}, {"replace", true}});
    EXPECT_TRUE(after["error"].is_null()) << after["error"];
    EXPECT_EQ(after["notes"], json::array());
    const json again = hand().get("/api/session/file").json();
    EXPECT_EQ(again["scenarios"], before["scenarios"]);
    EXPECT_EQ(again["scenarios"][1]["name"], "C");
    EXPECT_EQ(again["scenarios"][0]["title"], "slippery");
    EXPECT_GT(hand().get("/api/scenarios/A/recording").json()["times_s"].size(), 5U);

    // A hash that is not that of the replay is said.
    json other = before;
    other["scenarios"][0]["journal"]["last"]["hash"] = "0000000000000000";
    EXPECT_EQ(hand().post("/api/sessions", {{"name", "other"}, {"file", other}}).status, 200);
    EXPECT_THAT(open({{"session", "other"}, {"replace", true}})["notes"].dump(),
                HasSubstr("Scenario A: the result differs"));
}

TEST_F(StartPage, a_session_file_from_a_browser_opens_only_a_known_scene) {
    open({{"scene", id()}});
    json file = hand().get("/api/session/file").json();
    file["scenarios"][0]["journal"]["scene"]["file"] = "/etc/passwd";
    EXPECT_EQ(hand().post("/api/sessions", {{"name", "foreign"}, {"file", file}}).status, 200);
    const json after = open({{"session", "foreign"}, {"replace", true}});
    EXPECT_THAT(after["error"].dump(), HasSubstr("is not known here"));
    file["more"] = 1;
    EXPECT_EQ(hand().post("/api/sessions", {{"name", "foreign"}, {"file", file}}).status, 400);
    EXPECT_EQ(hand().post("/api/sessions", {{"name", "../.."}}).status, 400);
}

TEST_F(StartPage, a_file_of_the_command_line_opens_at_once_and_who_ends_the_program_has_the_answer_first) {
    std::atomic<bool> answered = false;
    on_quit_ = [&] {
        for (int i = 0; i < 200 && !answered; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(25));
        quit_ = answered.load();
        answered = true;
    };
    start(scene_.scene_file());
    json now = page();
    for (int i = 0; i < 400 && now["open"].is_null(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(25));
        now = page();
    }
    EXPECT_EQ(now["open"]["title"], "Plane");
    EXPECT_EQ(hand().ask("DELETE", "/api/recent/" + id()).status, 200);
    EXPECT_EQ(page()["scenes"][0]["kind"], "builtin");
    EXPECT_EQ(hand().ask("POST", "/api/quit").status, 200);
    answered = true;
    for (int i = 0; i < 200 && !quit_; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(25));
    EXPECT_TRUE(quit_);
    server_.reset();  // which on_quit refers to
}

TEST(Library, names_of_files_have_no_path) {
    EXPECT_EQ(serve::file_name_of("../../etc/Passwd"), "etc-passwd");
    EXPECT_EQ(serve::file_name_of("  A b  "), "a-b");
    EXPECT_EQ(serve::file_name_of("..."), "");
    EXPECT_EQ(serve::file_name_of(std::string(300, 'x')).size(), 60U);
}

TEST(SessionFile, says_what_is_wrong) {
    const auto error = [](const std::string& text) {
        const auto read = serve::read_session(text);
        return read ? std::string() : read.error().message;
    };
    EXPECT_THAT(error("{"), HasSubstr("JSON"));
    EXPECT_THAT(error("{}"), HasSubstr("no saved session"));
    EXPECT_THAT(error(R"({"talus_session": 2})"), HasSubstr("talus_session = 2"));
    EXPECT_THAT(error(R"({"talus_session": 1, "name": "", "title": "", "scenarios": []})"), HasSubstr("1 to 6"));
    EXPECT_THAT(error(R"({"talus_session": 1, "name": "", "title": "", "scenarios": [{"name": "Z", "title": ""}]})"),
                HasSubstr("scenarios[0]: name = \"Z\""));
}

}  // namespace
}  // namespace talus::test
