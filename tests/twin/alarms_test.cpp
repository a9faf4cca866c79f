#include "twin/alarms.hpp"

#include <optional>

#include <gmock/gmock.h>

#include "core/hash.hpp"
#include "twin/journal.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

scene::Scene watched_scene() {
    scene::Scene scene = channel_scene();
    add_building(scene, "House 38", rectangle(west + 60, south + 27, west + 66, south + 33), 6);
    const auto add = [&](const char* name, const auto& set) {
        params::AlarmSpec alarm;
        alarm.name = name;
        set(alarm);
        scene.spec.alarms.push_back(alarm);
    };
    const auto at_house = [&](const char* name, std::optional<double> params::AlarmSpec::*condition, double value) {
        add(name, [&](params::AlarmSpec& alarm) {
            alarm.structure = "House 38";
            alarm.*condition = value;
        });
    };
    at_house("near", &params::AlarmSpec::distance, 25);
    scene.spec.alarms.back().message = "Leave the house.";
    at_house("soon", &params::AlarmSpec::lead_time, 3);
    add("there", [](params::AlarmSpec& alarm) {
        alarm.chainage = 54;
        alarm.distance = 0;
    });
    at_house("load", &params::AlarmSpec::impact_pressure, 1000);
    at_house("crush", &params::AlarmSpec::impact_pressure, 1e9);
    add("wet", [](params::AlarmSpec& alarm) {
        alarm.x = west + 40;
        alarm.y = south + 30;
        alarm.depth = 0.2;
    });
    return scene;
}

const RaisedAlarm* find(const Scenario& scenario, const std::string& name) {
    const RaisedAlarm* found = nullptr;
    for (const RaisedAlarm& alarm : scenario.run().alarms()) {
        if (alarm.name != name) continue;
        EXPECT_EQ(found, nullptr) << name << " twice";
        found = &alarm;
    }
    return found;
}

TEST(Alarms, are_raised_once_with_the_time_at_which_the_front_is_expected) {
    const auto scenario = open(watched_scene());
    EXPECT_TRUE(scenario->run().alarms().empty());
    run_until(*scenario, 15);
    const RaisedAlarm *near = find(*scenario, "near"), *soon = find(*scenario, "soon"),
                      *there = find(*scenario, "there"), *load = find(*scenario, "load"), *wet = find(*scenario, "wet");
    ASSERT_TRUE(near && soon && there && load && wet);
    EXPECT_EQ(find(*scenario, "crush"), nullptr);
    // The house begins at x = 60 m, 55 m down the path.
    EXPECT_THAT(near->sentence, HasSubstr("before House 38"));
    EXPECT_EQ(near->message, "Leave the house.");
    const double hit = impacts_json(*scenario)["buildings"][0]["first_hit_s"];
    ASSERT_TRUE(near->expected && soon->expected && there->expected);
    EXPECT_LT(near->time, hit);
    EXPECT_NEAR(*near->expected, hit, 0.5 * (hit - near->time));
    EXPECT_NEAR(*soon->expected, hit, 1.5);
    EXPECT_LE(*soon->expected - soon->time, 3);
    EXPECT_EQ(*there->expected, there->time);
    EXPECT_NEAR(there->time, hit, 1);
    EXPECT_GE(load->time, hit);
    EXPECT_LT(wet->time, there->time);
    EXPECT_GT(near->step, 0U);
}

TEST(Alarms, are_the_same_in_a_replay_and_name_the_state_that_raised_them) {
    const auto scenario = open(watched_scene());
    run_until(*scenario, 1);
    act(*scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.2}});
    run_until(*scenario, 8);
    const auto journal = read_journal(journal_json(*scenario).dump());
    ASSERT_TRUE(journal);
    const auto again = replay(*journal, std::make_shared<const scene::Scene>(watched_scene()));
    ASSERT_TRUE(again);
    ASSERT_FALSE(scenario->run().alarms().empty());
    ASSERT_EQ(again->scenario->run().alarms().size(), scenario->run().alarms().size());
    for (std::size_t k = 0; k < scenario->run().alarms().size(); ++k) {
        const RaisedAlarm &a = scenario->run().alarms()[k], &b = again->scenario->run().alarms()[k];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.step, b.step);
        EXPECT_EQ(a.hash, b.hash);
        EXPECT_EQ(a.sentence, b.sentence);
    }
    // A journal cut at that step ends with that hash.
    Journal cut = *journal;
    const RaisedAlarm& last = scenario->run().alarms().back();
    cut.steps = last.step;
    EXPECT_EQ(replay(cut, std::make_shared<const scene::Scene>(watched_scene()))->hash, to_hex(last.hash));
}

TEST(Alarms, begin_anew_with_a_restart_and_forget_a_house_that_was_removed) {
    const auto scenario = open(watched_scene());
    run_until(*scenario, 8);
    ASSERT_FALSE(scenario->run().alarms().empty());
    act(*scenario, {{"action", "restart"}});
    EXPECT_TRUE(scenario->run().alarms().empty());
    act(*scenario, {{"action", "remove_building"}, {"id", "building-1"}});
    run_until(*scenario, 8);
    EXPECT_EQ(find(*scenario, "near"), nullptr);
    EXPECT_NE(find(*scenario, "there"), nullptr);
}

}  // namespace
}  // namespace talus::twin::test
