#include "session/scenarios.hpp"

#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "twin/twin_fixtures.hpp"

namespace talus::session {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct Nobody : Watcher {
    void frames(FrameSet) override {}
    void state(int, json) override {}
    void setup(int, json, const twin::Setup&) override {}
    void done(int, const std::string&, const std::string&) override {}
    void scenarios(std::vector<std::string>) override {}
    void alerts(int, RunAlerts) override {}
};

/// Changes are prepared when the test says so.
class WaitingChanges : public testing::Test {
  protected:
    void restart(int scenario) {
        scenarios_.act(scenario, {{"action", "restart"}}, "Ann", [this](const Result<twin::Done>& done) {
            answers_.push_back(done ? "" : done.error().message);
        });
    }
    void prepare() {
        const auto [work, then] = std::exchange(prepared_, {}).front();
        work(stop_);
        then();
    }

    std::atomic<bool> stop_ = false;
    Nobody nobody_;
    std::vector<std::pair<Work, std::function<void()>>> prepared_;
    Scenarios scenarios_{
        twin::test::open(twin::test::channel_scene()), nobody_,
        [this](Work work, std::function<void()> then) { prepared_.emplace_back(std::move(work), std::move(then)); }};
    std::vector<std::string> answers_;
};

TEST_F(WaitingChanges, beyond_the_most_there_can_be_are_refused) {
    restart(0);
    for (std::size_t k = 0; k < Scenarios::max_waiting; ++k) restart(0);
    EXPECT_EQ(answers_.size(), 0U);
    restart(0);
    ASSERT_EQ(answers_.size(), 1U);
    EXPECT_EQ(answers_[0], "restart: 32 changes of scenario A wait already, the most there can be; repeat it later");
    prepare();  // the next one begins, which leaves room
    restart(0);
    EXPECT_THAT(answers_, testing::ElementsAre(answers_[0], ""));
}

TEST_F(WaitingChanges, of_a_scenario_that_ends_are_refused) {
    scenarios_.copy(0, nullptr, "Ann", [](const Result<Copied>& made) { EXPECT_TRUE(made); });
    prepare();
    restart(1);
    restart(1);
    EXPECT_TRUE(scenarios_.remove(1));
    EXPECT_THAT(answers_, testing::ElementsAre("the scenario has ended"));
    prepare();
    EXPECT_THAT(answers_, testing::ElementsAre("the scenario has ended", "the scenario has ended"));
}

using ActionKeys = WaitingChanges;

TEST_F(ActionKeys, that_are_not_known_are_refused) {
    const auto answer_to = [this](const json& action) {
        std::string text;
        scenarios_.act(0, action, "Ann",
                       [&](const Result<twin::Done>& done) { text = done ? "" : done.error().message; });
        return text;
    };
    for (const char* name : {"run", "pause", "step", "cancel", "name_scenario", "set_speed"}) {
        EXPECT_THAT(answer_to({{"action", name}, {"factr", 2}}), HasSubstr("\"factr\" = 2: no such key here")) << name;
    }
    EXPECT_THAT(answer_to({{"action", "set_speed"}, {"factr", 2}}), HasSubstr("nearest known key: factor"));
    EXPECT_EQ(answer_to({{"action", "set_speed"}, {"factor", 2}}), "");
    EXPECT_EQ(answer_to({{"action", "run"}, {"scenarios", {"A"}}}), "");
}

}  // namespace
}  // namespace talus::session
