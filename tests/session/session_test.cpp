#include "session/session.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "support/value_of.hpp"
#include "twin/journal.hpp"
#include "twin/twin_fixtures.hpp"

namespace talus::session {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using ::testing::HasSubstr;

json content(const Reply& reply) {
    return json::parse(*reply.body);
}

/// A session that nothing but the test drives, by a clock of its own: no server, no thread, no waiting.
class SessionTest : public ::testing::Test {
  protected:
    std::string join(const char* name, Role role = Role::controller) {
        const std::string id = session_->join(role, name, time_);
        EXPECT_TRUE(session_->receive(
            id, R"({"type": "view", "scenarios": ["A", "B"], "rate_hz": 30, "particle_cap": 1000})", time_));
        return id;
    }
    /// Every reading of the clock is a millisecond later.
    std::optional<Clock::time_point> advance(milliseconds budget = milliseconds(20)) {
        return session_->advance([this] { return time_ += milliseconds(1); }, budget);
    }
    /// The answer to an action, which comes once it has been prepared.
    json act(const std::string& id, const json& action, Outcome outcome = Outcome::done) {
        std::optional<Reply> answer;
        session_->act(id, "A", action, [&](Reply reply) { answer = std::move(reply); });
        for (int i = 0; i < 100 && !answer; ++i) advance();
        EXPECT_TRUE(answer) << action;
        if (!answer) return {};
        EXPECT_EQ(answer->outcome, outcome) << *answer->body;
        return content(*answer);
    }
    void run_until(double time) {
        while (state()["time_s"] < time) {
            advance();
            ASSERT_EQ(state()["status"], "running");
        }
    }
    json state(const char* scenario = "A") { return content(session_->ask(scenario, "state")); }
    /// The newest message of a type that a person has been sent since the last call; null: none.
    json newest(const std::string& id, const char* type) {
        json found;
        for (const Bytes& text : session_->events(id)) {
            json message = json::parse(*text);
            if (message["type"] == type) found = std::move(message);
        }
        return found;
    }

    std::shared_ptr<const scene::Scene> scene_ = std::make_shared<const scene::Scene>(twin::test::channel_scene());
    Clock::time_point time_{std::chrono::seconds(1000)};
    std::unique_ptr<Session> session_ = talus::test::value_of(Session::open({scene_, {}, "test"}));
};

const json barrier = {
    {"action", "put_barrier"},
    {"line",
     {{twin::test::west + 45.3, twin::test::south + 22.1}, {twin::test::west + 46.7, twin::test::south + 37.9}}},
    {"height_m", 2},
    {"thickness_m", 1}};

TEST_F(SessionTest, two_people_share_a_run_and_its_journal_repeats_it) {
    const std::string ann = join("Ann"), bo = join("Bo");
    EXPECT_EQ(newest(bo, "hello")["you"]["name"], "Bo");
    EXPECT_THAT(act(bo, barrier, Outcome::not_now)["error"], "Ann has control; ask for it");
    ASSERT_TRUE(session_->control("request", bo, time_));
    ASSERT_TRUE(session_->control("grant", ann, time_));
    act(bo, {{"action", "set_speed"}, {"factor", nullptr}});
    act(bo, {{"action", "run"}});
    run_until(0.5);
    EXPECT_EQ(act(bo, barrier)["created"], "barrier-1");
    run_until(1);
    for (const std::string& id : {ann, bo}) {
        EXPECT_EQ(session_->frames(id).size(), 1U) << "the newest one of A";
        EXPECT_EQ(session_->frames(id).size(), 0U) << "which was taken";
    }
    EXPECT_EQ(newest(ann, "setup")["barriers"].size(), 1U);
    EXPECT_THAT(act(bo, {{"action", "undo"}})["done"].get<std::string>(), HasSubstr("barrier"));
    EXPECT_EQ(newest(ann, "setup")["barriers"].size(), 0U);
    run_until(1.5);
    act(bo, {{"action", "pause"}});

    const auto journal = twin::read_journal(*session_->ask("A", "journal").body);
    ASSERT_TRUE(journal) << journal.error().message;
    const auto again = twin::replay(*journal, scene_);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, state()["hash"]);
    EXPECT_EQ(again->steps, state()["step"]);
}

TEST_F(SessionTest, a_change_is_prepared_when_time_is_given) {
    const std::string ann = join("Ann");
    bool answered = false;
    session_->act(ann, "A", barrier, [&](const Reply&) { answered = true; });
    EXPECT_FALSE(answered);
    EXPECT_EQ(state()["preparing"]["what"], "put barrier");
    advance();
    EXPECT_TRUE(answered);
    EXPECT_TRUE(state()["preparing"].is_null());
}

TEST_F(SessionTest, says_when_to_go_on) {
    const std::string ann = join("Ann");
    advance();
    advance(milliseconds(1000));  // the list of people has been sent
    EXPECT_FALSE(advance()) << "paused: nothing is due";
    act(ann, {{"action", "run"}});
    const auto next = advance();
    ASSERT_TRUE(next);
    EXPECT_LT(*next - time_, std::chrono::seconds(1));
    ASSERT_TRUE(session_->control("release", ann, time_));
    session_->leave(ann, time_);
    EXPECT_TRUE(advance()) << "whoever left may come back for a while";
}

TEST_F(SessionTest, scenarios_are_copied_and_ended) {
    const std::string ann = join("Ann");
    std::optional<Reply> copied;
    session_->copy(ann, {{"copy_of", "A"}}, [&](Reply reply) { copied = std::move(reply); });
    advance();
    ASSERT_TRUE(copied);
    EXPECT_EQ(content(*copied)["created"], "B");
    EXPECT_EQ(state("B")["time_s"], 0);
    EXPECT_EQ(session_->end(ann, "B").outcome, Outcome::done);
    EXPECT_EQ(session_->end(ann, "A").outcome, Outcome::not_now);
    EXPECT_EQ(session_->ask("B", "state").outcome, Outcome::unknown);
    EXPECT_EQ(newest(ann, "scenarios")["scenarios"], json({"A"}));
}

TEST_F(SessionTest, every_question_is_answered) {
    EXPECT_EQ(content(session_->scene())["title"], "Channel");
    for (const Question& question : questions()) {
        Arguments arguments;
        if (question.name == "layers/{name}") arguments["name"] = "depth";
        if (question.name == "probe") arguments = {{"x_m", "20"}, {"y_m", "30"}};
        const Reply reply = session_->ask("A", question.name, arguments);
        EXPECT_EQ(reply.outcome, Outcome::done) << question.name << ": " << *reply.body;
    }
    EXPECT_EQ(session_->ask("A", "frame", {{"time_s", "soon"}}).outcome, Outcome::wrong);
    EXPECT_EQ(session_->ask("A", "layers/{name}", {{"name", "colour"}}).outcome, Outcome::unknown);
    EXPECT_EQ(session_->ask("A", "weather").outcome, Outcome::unknown);
}

}  // namespace
}  // namespace talus::session
