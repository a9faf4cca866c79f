#include <thread>

#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

class Web : public Serve {};

TEST_F(Web, needs_a_token_and_an_own_page) {
    EXPECT_EQ(WebSocket(port(), "").status(), 401);
    EXPECT_EQ(WebSocket(port(), "token=wrong").status(), 401);
    EXPECT_EQ(WebSocket(port(), std::string("token=") + viewer).status(), 101);
    HttpClient client(port());
    const Headers upgrade = {{"Connection", "Upgrade"},
                             {"Upgrade", "websocket"},
                             {"Sec-WebSocket-Version", "13"},
                             {"Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="},
                             {"Origin", "http://evil.example.org"}};
    EXPECT_EQ(client.ask("GET", std::string("/ws?token=") + controller, "", upgrade).status, 403);
    EXPECT_EQ(client.get(std::string("/ws?token=") + controller).status, 400);
}

TEST_F(Web, who_joins_late_gets_everything_at_once) {
    ASSERT_EQ(act({{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.3}}).status, 200);
    WebSocket ada = join(controller, "Ada%20L");
    const json hello = ada.wait_for("hello");
    EXPECT_EQ(hello["you"]["name"], "Ada L");
    EXPECT_EQ(hello["you"]["role"], "controller");
    EXPECT_EQ(hello["session"]["controller"], hello["you"]["id"]);
    const json setup = ada.wait_for("setup");
    EXPECT_EQ(setup["scenario"], "A");
    EXPECT_EQ(setup["revision"], as_viewer().get("/api/scenarios/A/setup").json()["revision"]);
    EXPECT_EQ(ada.wait_for("state")["status"], "paused");
    EXPECT_EQ(ada.wait_for("people")["people"][0]["name"], "Ada L");
    ada.send(view_message(30));
    const auto header = read_frame_header(ada.wait_for_frame());
    ASSERT_TRUE(header);
    EXPECT_EQ(header->step, 0U);
    EXPECT_EQ(header->flags & 1, 0U);
}

TEST_F(Web, frames_come_at_the_wanted_rate_while_it_runs) {
    WebSocket eye = join(viewer);
    const auto begun = Clock::now();
    eye.send(view_message(20));
    ASSERT_EQ(act({{"action", "run"}}).status, 200);
    eye.wait_for_frame();
    const auto end = Clock::now() + std::chrono::seconds(2);
    int frames = 0, states = 0;
    std::uint64_t last_step = 0;
    while (Clock::now() < end) {
        const auto message = eye.receive(Milliseconds(2000));
        ASSERT_TRUE(message);
        if (message->text) {
            states += json::parse(message->data)["type"] == "state" ? 1 : 0;
            continue;
        }
        const auto header = read_frame_header(message->data);
        ASSERT_TRUE(header);
        EXPECT_GE(header->step, last_step);
        last_step = header->step;
        ++frames;
    }
    // A reader that was held up finds those of the meantime all at once: what counts is the time since it asked.
    const double seconds = std::chrono::duration<double>(Clock::now() - begun).count();
    EXPECT_GE(frames, 30);
    EXPECT_LE(frames, 20 * seconds + 3);
    EXPECT_GE(states, 7);
    EXPECT_LE(states, 5 * seconds + 4);
    ASSERT_EQ(act({{"action", "pause"}}).status, 200);
    // The last frame is of where it stopped, and nothing comes after it.
    const std::uint64_t step = as_viewer().get("/api/scenarios/A/state").json()["step"];
    std::uint64_t shown = 0;
    for (std::string frame; !(frame = eye.wait_for_frame(Milliseconds(400))).empty();) {
        shown = read_frame_header(frame)->step;
    }
    EXPECT_EQ(shown, step);
}

TEST_F(Web, each_gets_frames_of_the_size_and_rate_it_asked_for) {
    WebSocket all = join(viewer), few = join(viewer), none = join(viewer);
    all.send(view_message(30));
    few.send(view_message(5, 1));  // the fewest there are: a thousand
    const auto whole = read_frame_header(all.wait_for_frame());
    const auto thin = read_frame_header(few.wait_for_frame());
    ASSERT_TRUE(whole && thin);
    EXPECT_EQ(whole->stride, 1U);
    EXPECT_LE((thin->ids + thin->stride - 1) / thin->stride, 1000U);
    EXPECT_GT((thin->ids + thin->stride - 1) / thin->stride, std::min(499U, thin->ids - 1));
    act({{"action", "run"}});
    int fast = 0, slow = 0;
    const auto end = Clock::now() + std::chrono::milliseconds(1500);
    while (Clock::now() < end) {
        while (!all.wait_for_frame(Milliseconds(15)).empty()) ++fast;
        while (!few.wait_for_frame(Milliseconds(15)).empty()) ++slow;
    }
    EXPECT_GT(fast, 2 * slow);
    EXPECT_LE(slow, 10);
    EXPECT_TRUE(none.wait_for_frame(Milliseconds(300)).empty());
}

TEST_F(Web, what_is_not_in_the_protocol_ends_the_connection) {
    const std::string wrong[] = {"x",
                                 "[]",
                                 "{}",
                                 R"({"type": "fly"})",
                                 R"({"type": "view"})",
                                 R"({"type":"view","scenarios":"A","rate_hz":30,"particle_cap":1})",
                                 R"({"type":"view","scenarios":["A"],"rate_hz":"30","particle_cap":1})",
                                 R"({"type": "mark", "at": [1, 2]})",
                                 R"({"type": "mark"})",
                                 R"({"type": "name", "name": 5})",
                                 std::string(70000, ' ')};
    for (const std::string& text : wrong) {
        WebSocket eye = join(viewer);
        ASSERT_FALSE(eye.wait_for("hello").is_null());
        eye.send_frame(1, text);
        EXPECT_TRUE(eye.wait_for("never", Milliseconds(3000)).is_null());
        EXPECT_TRUE(eye.ended()) << text.substr(0, 60);
    }
    WebSocket binary = join(viewer);
    binary.send_frame(2, R"({"type": "mark", "at": null})");
    EXPECT_TRUE(binary.wait_for("never", Milliseconds(3000)).is_null());
    EXPECT_TRUE(binary.ended());
    WebSocket flood = join(viewer);
    for (int i = 0; i < 500; ++i) flood.send({{"type", "mark"}, {"at", {i, 0, 0}}});
    EXPECT_TRUE(flood.wait_for("never", Milliseconds(3000)).is_null());
    EXPECT_TRUE(flood.ended());
    WebSocket good = join(viewer);
    EXPECT_FALSE(good.wait_for("hello").is_null());
}

/// A frame byte by byte: the first two, then the rest.
std::string frame_of(unsigned first, unsigned second, const std::string& rest) {
    return std::string{static_cast<char>(first), static_cast<char>(second)} + rest;
}

TEST_F(Web, frames_that_the_protocol_forbids_end_the_connection_and_no_other) {
    WebSocket other = join(viewer);
    ASSERT_FALSE(other.wait_for("hello").is_null());
    const std::string mask(4, '\0'), big("\0\0\0\0\xff\xff\xff\xff", 8);
    const std::pair<const char*, std::string> wrong[] = {
        {"without a mask", frame_of(0x81, 2, "{}")},
        {"with reserved bits", frame_of(0xf1, 0x82, mask + "{}")},
        {"of an unknown kind", frame_of(0x83, 0x82, mask + "{}")},
        {"that continues nothing", frame_of(0x80, 0x82, mask + "{}")},
        {"of text within a text", frame_of(0x01, 0x81, mask + "{") + frame_of(0x81, 0x81, mask + "}")},
        {"a ping in two pieces", frame_of(0x09, 0x81, mask + "x")},
        {"a ping that is too long", frame_of(0x89, 0xfe, std::string("\0\x80", 2) + mask + std::string(128, 'x'))},
        {"of 4 GiB", frame_of(0x81, 0xff, big + mask)},
        {"of a length below 0", frame_of(0x81, 0xff, std::string(8, '\xff') + mask)},
        {"of a length that is not the shortest", frame_of(0x81, 0xfe, std::string("\0\x02", 2) + mask + "{}")},
        {"that is no UTF-8", frame_of(0x81, 0x82, mask + "\xc3\x28")},
        {"that closes with half a code", frame_of(0x88, 0x81, mask + "\x03")},
    };
    for (const auto& [what, bytes] : wrong) {
        WebSocket eye = join(viewer);
        ASSERT_FALSE(eye.wait_for("hello").is_null());
        eye.socket().send(bytes);
        EXPECT_TRUE(eye.wait_for("never", Milliseconds(3000)).is_null());
        EXPECT_TRUE(eye.ended()) << what;
    }
    // A message in pieces without end is limited as one in one piece is.
    WebSocket eye = join(viewer);
    ASSERT_FALSE(eye.wait_for("hello").is_null());
    const std::string kilobyte = frame_of(0, 0xfe, std::string("\x04\0", 2) + mask + std::string(1024, ' '));
    eye.socket().send(frame_of(0x01, 0x81, mask + " "));
    for (int k = 0; k < 100; ++k) eye.socket().send(kilobyte);
    EXPECT_TRUE(eye.wait_for("never", Milliseconds(3000)).is_null());
    EXPECT_TRUE(eye.ended());
    EXPECT_FALSE(other.ended());
    EXPECT_EQ(as_viewer().get("/api/session").status, 200);
}

TEST_F(Web, marks_and_names_reach_the_others) {
    WebSocket ada = join(controller, "Ada"), bo = join(viewer, "Bo");
    ASSERT_FALSE(ada.wait_for("hello").is_null());
    ASSERT_FALSE(bo.wait_for("hello").is_null());
    bo.send({{"type", "mark"}, {"at", {1.5, -2, 3}}});
    bo.send({{"type", "name"}, {"name", "Bob"}});
    const std::string id = bo.hello["you"]["id"];
    for (int i = 0; i < 20; ++i) {
        const json message = ada.wait_for("people");
        ASSERT_FALSE(message.is_null());
        for (const json& person : message["people"]) {
            if (person["id"] != id || person["name"] != "Bob") continue;
            EXPECT_EQ(person["mark"], (json{1.5, -2.0, 3.0}));
            return;
        }
    }
    FAIL() << "the new name did not arrive";
}

TEST_F(Web, control_goes_from_hand_to_hand) {
    WebSocket ada = join(controller, "Ada"), bo = join(controller, "Bo");
    ASSERT_FALSE(ada.wait_for("hello").is_null());
    ASSERT_FALSE(bo.wait_for("hello").is_null());
    const std::string first = ada.hello["you"]["secret"], second = bo.hello["you"]["secret"];
    EXPECT_EQ(act({{"action", "run"}}, ada.hello["you"]["id"]).status, 409) << "an id shows nothing";
    EXPECT_EQ(as_viewer().get("/api/session").body.find(first), std::string::npos);
    HttpClient hand = as_controller();
    const json change = {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.35}};
    EXPECT_EQ(act(change).status, 409);
    const Answer refused = act(change, second);
    EXPECT_EQ(refused.status, 409);
    EXPECT_NE(refused.json()["error"].get<std::string>().find("Ada has control"), std::string::npos);
    EXPECT_EQ(act(change, first).status, 200);
    const json done = bo.wait_for("done");
    EXPECT_EQ(done["by"], "Ada");
    EXPECT_EQ(done["scenario"], "A");

    EXPECT_EQ(hand.post("/api/control", {{"do", "request"}, {"secret", second}}).status, 200);
    json people;
    while (!(people = ada.wait_for("people")).is_null() && people["request"].is_null()) {
    }
    EXPECT_EQ(people["request"]["name"], "Bo");
    EXPECT_EQ(hand.post("/api/control", {{"do", "grant"}, {"secret", second}}).status, 409);
    EXPECT_EQ(hand.post("/api/control", {{"do", "grant"}, {"secret", first}}).status, 200);
    EXPECT_EQ(act(change, second).status, 200);
    EXPECT_EQ(act(change, first).status, 409);
    EXPECT_EQ(hand.post("/api/control", {{"do", "release"}, {"secret", second}}).status, 200);
    EXPECT_EQ(act(change).status, 200);
    for (const json& bad : {json{{"do", "take"}, {"secret", first}}, json::array(), json{{"secret", first}}}) {
        EXPECT_EQ(hand.post("/api/control", bad).status, 400);
    }
    EXPECT_EQ(hand.post("/api/control", {{"do", "request"}, {"secret", "p77"}}).status, 409);
}

TEST_F(Web, a_broken_connection_comes_back_as_the_same_person_in_the_running_session) {
    WebSocket ada = join(controller, "Ada");
    ASSERT_FALSE(ada.wait_for("hello").is_null());
    const std::string id = ada.hello["you"]["id"], secret = ada.hello["you"]["secret"];
    ASSERT_EQ(act({{"action", "run"}}, secret).status, 200);
    ada.send(view_message(30));
    const auto before = read_frame_header(ada.wait_for_frame());
    ada.socket().kill();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    WebSocket again(port(), fmt::format("token={}&name=Ada&person={}", controller, secret));
    EXPECT_EQ(again.wait_for("hello")["you"]["id"], id);
    EXPECT_EQ(again.hello["session"]["controller"], id);
    EXPECT_EQ(again.wait_for("state")["status"], "running");
    again.send(view_message(30));
    const auto after = read_frame_header(again.wait_for_frame());
    ASSERT_TRUE(before && after);
    EXPECT_GT(after->step, before->step);
    EXPECT_EQ(act({{"action", "pause"}}, secret).status, 409) << "of the connection that broke";
    EXPECT_EQ(act({{"action", "pause"}}, again.hello["you"]["secret"]).status, 200);
}

TEST_F(Web, a_viewer_killed_in_mid_frame_harms_nobody) {
    act({{"action", "run"}});
    for (int i = 0; i < 20; ++i) {
        WebSocket gone = join(viewer, "Gone", 4096);
        gone.send(view_message(60));
        (void)gone.socket().receive(Milliseconds(20 * (i % 5)));
        gone.socket().kill();
    }
    WebSocket eye = join(viewer);
    eye.send(view_message(60));
    EXPECT_FALSE(eye.wait_for_frame().empty());
    for (int i = 0; i < 50; ++i) {
        if (as_viewer().get("/api/session").json()["people"].size() == 1) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    FAIL() << "those who have gone are still listed";
}

TEST_F(Web, two_scenarios_keep_abreast) {
    WebSocket ada = join(controller, "Ada");
    ASSERT_FALSE(ada.wait_for("hello").is_null());
    const std::string id = ada.hello["you"]["secret"];
    HttpClient hand = as_controller();
    act({{"action", "set_speed"}, {"factor", nullptr}}, id);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(act({{"action", "step"}}, id).status, 200);
    const Answer made = hand.post("/api/scenarios", {{"copy_of", "A"}}, id);
    EXPECT_EQ(made.status, 200);
    EXPECT_EQ(made.json()["created"], "B");
    EXPECT_EQ(ada.wait_for("scenarios")["scenarios"], (json{"A", "B"}));
    EXPECT_EQ(hand.post("/api/scenarios", {{"copy_of", "C"}}, id).status, 404);
    EXPECT_EQ(hand.post("/api/scenarios", {{"copy", "A"}}, id).status, 400);
    ada.send(view_message(60, 1000000, {"A", "B"}));
    act({{"action", "run"}}, id);
    std::uint64_t steps[2] = {0, 0};
    const auto end = Clock::now() + std::chrono::seconds(10);
    while (Clock::now() < end && (steps[0] < 20 || steps[1] < 20)) {
        const auto header = read_frame_header(ada.wait_for_frame());
        ASSERT_TRUE(header);
        steps[header->scenario] = header->step;
    }
    EXPECT_GE(steps[1], 20U);
    act({{"action", "pause"}}, id);
    const json a = hand.get("/api/scenarios/A/state").json(), b = hand.get("/api/scenarios/B/state").json();
    EXPECT_EQ(b["scenario"], "B");
    EXPECT_NEAR(a["time_s"].get<double>(), b["time_s"].get<double>(), 0.1);
    EXPECT_EQ(hand.ask("DELETE", "/api/scenarios/A", "", {{"Talus-Person", id}}).status, 409);
    EXPECT_EQ(hand.ask("DELETE", "/api/scenarios/B", "", {{"Talus-Person", id}}).status, 200);
    EXPECT_EQ(ada.wait_for("scenarios")["scenarios"], (json{"A"}));
    EXPECT_EQ(hand.get("/api/scenarios/B/state").status, 404);
    act({{"action", "run"}}, id);
    EXPECT_FALSE(ada.wait_for_frame().empty());
}

TEST_F(Web, scenarios_are_runs_from_time_0_which_run_pause_and_restart_by_name) {
    HttpClient hand = as_controller();
    const auto state = [&](const char* name) {
        return as_viewer().get(std::string("/api/scenarios/") + name + "/state").json();
    };
    const auto setup = [&](const char* name) {
        return as_viewer().get(std::string("/api/scenarios/") + name + "/setup").json();
    };
    const json friction = {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.2}};
    for (int i = 0; i < 3; ++i) EXPECT_EQ(act({{"action", "step"}}).status, 200);
    const Answer refused = hand.post(
        "/api/scenarios",
        {{"copy_of", "A"}, {"action", {{"action", "set_parameter"}, {"key", "material.viscosity"}, {"value", -1}}}});
    EXPECT_EQ(refused.status, 409);
    EXPECT_EQ(hand.get("/api/session").json()["scenarios"], (json{"A"})) << "nothing is made of a refused action";

    const Answer made = hand.post("/api/scenarios", {{"copy_of", "A"}, {"action", friction}});
    EXPECT_EQ(made.json()["created"], "B");
    EXPECT_EQ(state("B")["step"], 0);
    EXPECT_EQ(setup("B")["parameters"]["material.friction_coefficient"], 0.2);
    EXPECT_EQ(setup("B")["changes"], json::array());
    EXPECT_EQ(setup("B")["undo"], "friction coefficient 0.4 -> 0.2");
    EXPECT_NE(setup("A")["parameters"]["material.friction_coefficient"], 0.2);

    EXPECT_EQ(act(friction).status, 200);
    ASSERT_EQ(setup("A")["changes"].size(), 1U);
    EXPECT_EQ(setup("A")["changes"][0]["sentence"], "friction coefficient 0.4 -> 0.2");
    EXPECT_EQ(setup("A")["changes"][0]["time_s"], state("A")["time_s"]);
    EXPECT_EQ(act({{"action", "undo"}}).status, 200);
    EXPECT_EQ(setup("A")["changes"], json::array()) << "nothing has moved between";
    EXPECT_EQ(act({{"action", "redo"}}).status, 200);

    const json b_alone = {"B"}, both = {"A", "B"};
    EXPECT_EQ(act({{"action", "run"}, {"scenarios", b_alone}}).status, 200);
    EXPECT_EQ(state("A")["status"], "paused");
    EXPECT_EQ(state("B")["status"], "running");
    EXPECT_EQ(act({{"action", "pause"}, {"scenarios", both}}).status, 200);
    EXPECT_EQ(act({{"action", "restart"}, {"scenarios", both}}).status, 200);
    EXPECT_EQ(state("A")["step"], 0);
    EXPECT_EQ(state("B")["step"], 0);
    EXPECT_EQ(setup("A")["changes"], json::array());
    EXPECT_EQ(act({{"action", "run"}, {"scenarios", {"A", "E"}}}).status, 400);
    EXPECT_EQ(act({{"action", "run"}, {"scenarios", json::array()}}).status, 400);
    EXPECT_EQ(act({{"action", "name_scenario"}, {"name", " Wet year\n"}}).status, 200);
    EXPECT_EQ(setup("A")["name"], "Wet year");

    for (const char* name : {"C", "D", "E", "F"}) {
        EXPECT_EQ(hand.post("/api/scenarios", {{"copy_of", "B"}}).json()["created"], name);
    }
    EXPECT_EQ(hand.post("/api/scenarios", {{"copy_of", "B"}}).status, 409);
    EXPECT_EQ(hand.ask("DELETE", "/api/scenarios/C").status, 200);
    EXPECT_EQ(hand.get("/api/session").json()["scenarios"], (json{"A", "B", "D", "E", "F"}));
    EXPECT_EQ(hand.post("/api/scenarios", {{"copy_of", "A"}}).json()["created"], "C");
}

TEST_F(Web, run_pause_step_and_speed) {
    const auto state = [this] { return as_viewer().get("/api/scenarios/A/state").json(); };
    EXPECT_EQ(state()["status"], "paused");
    EXPECT_TRUE(state().contains("hash"));
    EXPECT_EQ(state()["speed_factor"], 1.0);
    EXPECT_EQ(act({{"action", "step"}}).status, 200);
    EXPECT_EQ(state()["step"], 1);
    EXPECT_EQ(act({{"action", "set_speed"}, {"factor", 0.5}}).status, 200);
    EXPECT_EQ(act({{"action", "run"}}).status, 200);
    EXPECT_EQ(act({{"action", "step"}}).status, 400);
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    const json running = state();
    EXPECT_EQ(running["status"], "running");
    EXPECT_FALSE(running.contains("hash"));
    EXPECT_GT(running["steps_per_second"].get<double>(), 1);
    EXPECT_NEAR(running["real_time_factor"].get<double>(), 0.5, 0.1);
    EXPECT_EQ(act({{"action", "pause"}}).status, 200);
    EXPECT_EQ(state()["real_time_factor"], 0);
    const std::uint64_t step = state()["step"];
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_EQ(state()["step"], step);
    EXPECT_EQ(act({{"action", "restart"}}).status, 200);
    EXPECT_EQ(state()["time_s"], 0);
}

}  // namespace
}  // namespace talus::test
