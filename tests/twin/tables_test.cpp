// Observations, triggers and alarms that people add, change and remove.
#include <algorithm>

#include <gmock/gmock.h>

#include "twin/journal.hpp"
#include "twin/setup_file.hpp"
#include "twin/table_entry.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using testing::HasSubstr;

json put_observed(const char* section, const json& values) {
    return {{"action", "put_observation"}, {"section", section}, {"values", values}};
}

json put_entry(const char* what, const json& values) {
    return {{"action", std::string("put_") + what}, {"values", values}};
}

scene::Scene with_house() {
    scene::Scene scene = channel_scene();
    add_building(scene, "House 38", rectangle(west + 60, south + 27, west + 66, south + 33), 6);
    return scene;
}

const json& first_of(const json& setup, const char* list) {
    return setup[list][0];
}

TEST(Observations, of_every_kind_without_a_file_are_added_changed_removed_and_undone) {
    const auto scenario = open(with_house());
    act(*scenario, put_observed("observation", {{"name", "Bend"}, {"chainage_m", 40}, {"debris_speed_mps", 6}}));
    act(*scenario,
        put_observed("superelevation",
                     {{"chainage_m", 30}, {"bend_radius_m", 40}, {"width_m", 8}, {"level_difference_m", 1}}));
    act(*scenario, put_observed("arrival", {{"chainage_m", 50}, {"time_s", 8}}));
    act(*scenario, put_observed("run_up", {{"x_m", west + 55}, {"y_m", south + 30}, {"height_m", 1.5}}));
    act(*scenario, put_observed("deposit_depth", {{"x_m", west + 70}, {"y_m", south + 30}, {"depth_m", 0.5}}));
    act(*scenario, put_observed("damage", {{"building", "House 38"}}));
    act(*scenario, put_observed("observed_run_out", {{"chainage_m", 80}}));
    json setup = setup_json(*scenario);
    ASSERT_EQ(setup["observations"].size(), 7U);
    EXPECT_EQ(setup["observations"][1]["name"], "observation 2") << "a name of its own";
    EXPECT_EQ(setup["observations"][5]["name"], "House 38");
    EXPECT_EQ(setup["observations"][5]["values"]["damaged"], true) << "as the scene file's default";
    EXPECT_EQ(setup["observations"][3]["values"]["uncertainty_m"], 1);

    act(*scenario, {{"action", "put_observation"},
                    {"id", "observation-1"},
                    {"values", {{"name", "Upper bend"}, {"debris_speed_mps", nullptr}, {"front_velocity_mps", 5}}}});
    setup = setup_json(*scenario);
    EXPECT_EQ(first_of(setup, "observations")["name"], "Upper bend");
    EXPECT_EQ(first_of(setup, "observations")["values"]["front_velocity_mps"], 5);
    EXPECT_TRUE(first_of(setup, "observations")["values"]["debris_speed_mps"].is_null());
    EXPECT_EQ(first_of(setup, "observations")["values"]["chainage_m"], 40) << "what is not given stays";
    act(*scenario, {{"action", "remove_observation"}, {"id", "observation-1"}});
    EXPECT_EQ(setup_json(*scenario)["observations"].size(), 6U);
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*scenario)["observations"], setup["observations"]);
}

TEST(Observations, change_nothing_of_the_run_and_are_what_reports_and_fits_read) {
    const auto plain = open(channel_scene()), marked = open(channel_scene());
    act(*marked, put_observed("observation", {{"name", "Bend"}, {"chainage_m", 40}, {"debris_speed_mps", 6}}));
    run_until(*plain, 1.5);
    run_until(*marked, 1);
    act(*marked, put_observed("run_up", {{"x_m", west + 55}, {"y_m", south + 30}, {"height_m", 1.5}}));
    run_until(*marked, 1.5);
    EXPECT_EQ(hash(*marked), hash(*plain));
    EXPECT_EQ(setup_json(*marked)["changes"], json::array());
    EXPECT_FALSE(setup_json(*marked)["pending_restart"]);
    const auto outcome = outcome_of(*marked);
    ASSERT_EQ(outcome.first.spec.observations.size(), 1U);
    EXPECT_EQ(outcome.first.spec.observations[0].debris_speed, 6);
    EXPECT_EQ(outcome.first.spec.run_ups.size(), 1U);
    const auto copy = marked->copying()({});
    ASSERT_TRUE(copy) << copy.error().message;
    EXPECT_EQ(setup_json(**copy)["observations"], setup_json(*marked)["observations"]);
}

TEST(Observations, are_in_the_journal_and_a_replay_has_the_same_hash_and_the_same_list) {
    scene::Scene scene = channel_scene();
    scene.spec.observations = {{"surveyed", 30, 5, {}, "report"}};
    const auto scenario = open(scene);
    EXPECT_EQ(first_of(setup_json(*scenario), "observations")["from_scene"], true);
    act(*scenario, put_observed("arrival", {{"chainage_m", 50}, {"time_s", 8}}));
    run_until(*scenario, 1);
    act(*scenario, {{"action", "remove_observation"}, {"id", "observation-1"}});
    act(*scenario, {{"action", "undo"}});
    act(*scenario, put_entry("alarm", {{"name", "on its way"}, {"chainage_m", 60}, {"distance_m", 40}}));
    run_until(*scenario, 2);
    const auto journal = read_journal(journal_json(*scenario).dump());
    ASSERT_TRUE(journal) << journal.error().message;
    const auto again = replay(*journal, std::make_shared<const scene::Scene>(scene));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, journal->hash);
    for (const char* list : {"observations", "triggers", "alarms"}) {
        EXPECT_EQ(setup_json(*again->scenario)[list], setup_json(*scenario)[list]) << list;
    }

    // Journals of former programs have those of the scene alone.
    json former = journal_json(*open(scene));
    for (const char* list : {"observations", "triggers", "alarms"}) former["first_setup"].erase(list);
    for (const char* number : {"observation", "trigger", "alarm"}) former["next"].erase(number);
    const auto read = read_journal(former.dump());
    ASSERT_TRUE(read) << read.error().message;
    const auto opened = replay(*read, std::make_shared<const scene::Scene>(scene));
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_EQ(setup_json(*opened->scenario)["observations"].size(), 1U);
    act(*opened->scenario, put_observed("arrival", {{"chainage_m", 50}, {"time_s", 8}}));
    EXPECT_EQ(setup_json(*opened->scenario)["observations"][1]["id"], "observation-2");
}

TEST(Observations, are_refused_as_the_reader_of_a_scene_file_refuses_them) {
    const auto scenario = open(with_house());
    const auto why = [&](const char* section, const json& values) {
        return refusal(*scenario, put_observed(section, values));
    };
    EXPECT_THAT(why("arrival", {{"chainage_m", 50}}), HasSubstr("time_s: missing"));
    EXPECT_THAT(why("arrival", {{"chainage_m", 50}, {"time_s", -1}}), HasSubstr("time_s = -1: must be a number 0.001"));
    EXPECT_THAT(why("arrival", {{"chainage_m", 1000}, {"time_s", 1}}),
                HasSubstr("chainage_m = 1000 lies beyond the flow path, which is 110.0 m long"));
    EXPECT_THAT(why("observation", {{"chainage_m", 1000}, {"debris_speed_mps", 5}}), HasSubstr("beyond the flow path"));
    EXPECT_THAT(why("observation", {{"chainage_m", 10}}), HasSubstr("exactly one of"));
    EXPECT_THAT(why("run_up", {{"x_m", 0}, {"y_m", 0}, {"height_m", 1}}), HasSubstr("not on the terrain"));
    EXPECT_THAT(why("damage", {{"building", "House 83"}}), HasSubstr("nearest name: House 38"));
    EXPECT_THAT(why("arrival", {{"chainage", 50}}), HasSubstr("nearest known key: chainage_m"));
    EXPECT_THAT(why("deposit_outline", {{"file", "/etc/passwd"}}), HasSubstr("section"));
    EXPECT_THAT(refusal(*scenario, {{"action", "put_observation"}, {"values", json::object()}}), HasSubstr("section"));
    EXPECT_THAT(refusal(*scenario, {{"action", "put_observation"}, {"section", "arrival"}, {"values", 3}}),
                HasSubstr("values = 3: must be an object"));
    EXPECT_THAT(refusal(*scenario, {{"action", "remove_observation"}, {"id", "observation-9"}}),
                HasSubstr("no such observation"));
    EXPECT_EQ(setup_json(*scenario)["observations"], json::array());
}

TEST(PlacedAlarms, are_raised_from_when_they_are_added_once_and_again_after_a_change) {
    const auto scenario = open(with_house());
    act(*scenario, put_entry("alarm", {{"name", "wet"}, {"x_m", west + 20}, {"y_m", south + 30}, {"depth_m", 0.1}}));
    run_until(*scenario, 2.5);
    ASSERT_EQ(scenario->run().alarms().size(), 1U);
    EXPECT_EQ(scenario->run().alarms()[0].name, "wet");
    act(*scenario,
        put_entry("alarm", {{"name", "near"}, {"structure", "House 38"}, {"distance_m", 1000}, {"message", "Go."}}));
    act(*scenario,
        {{"action", "put_observation"}, {"section", "arrival"}, {"values", {{"chainage_m", 50}, {"time_s", 8}}}});
    run_until(*scenario, 3);
    ASSERT_EQ(scenario->run().alarms().size(), 2U) << "the first one is not raised again by another change";
    EXPECT_EQ(scenario->run().alarms()[1].message, "Go.");
    EXPECT_GE(scenario->run().alarms()[1].time, 2.5);
    act(*scenario, {{"action", "put_alarm"}, {"id", "alarm-1"}, {"values", {{"depth_m", 0.05}}}});
    run_until(*scenario, 3.5);
    EXPECT_EQ(scenario->run().alarms().size(), 3U);
    act(*scenario, {{"action", "remove_alarm"}, {"id", "alarm-2"}});
    EXPECT_EQ(scenario->run().alarms().size(), 3U) << "what was raised stays";
}

TEST(PlacedAlarms, know_what_was_drawn_in_the_page_and_are_refused_without_a_place_or_condition) {
    const auto scenario = open(channel_scene());
    act(*scenario, {{"action", "put_building"},
                    {"name", "Shelter"},
                    {"height_m", 5},
                    {"polygon", ring(west + 60, south + 27, west + 66, south + 33)}});
    act(*scenario, put_entry("alarm", {{"name", "load"}, {"structure", "Shelter"}, {"impact_pressure_Pa", 1000}}));
    run_until(*scenario, 12);
    ASSERT_EQ(scenario->run().alarms().size(), 1U);
    EXPECT_THAT(scenario->run().alarms()[0].sentence, HasSubstr("Shelter"));
    EXPECT_THAT(refusal(*scenario, put_entry("alarm", {{"structure", "Shed"}, {"depth_m", 1}})),
                HasSubstr("structure = \"Shed\""));
    EXPECT_THAT(refusal(*scenario, put_entry("alarm", {{"chainage_m", 5}})), HasSubstr("exactly one of distance_m"));
    EXPECT_THAT(refusal(*scenario, put_entry("alarm", {{"chainage_m", 5}, {"depth_m", 1}})),
                HasSubstr("depth_m: needs structure"));
    EXPECT_THAT(refusal(*scenario, put_entry("alarm", {{"name", "load"}, {"chainage_m", 5}, {"distance_m", 1}})),
                HasSubstr("name = \"load\" is refused"));
    EXPECT_THAT(refusal(*scenario, put_entry("alarm", {{"webhook", "https://example.org"}})),
                HasSubstr("no such key here"));
}

TEST(SavedTables, that_break_the_rules_of_their_section_are_refused_when_a_setup_is_read) {
    scene::Scene scene = with_house();
    params::AlarmSpec near;
    near.name = "near";
    near.structure = "House 38";
    near.distance = 20;
    scene.spec.alarms = {near};
    const json good = json::parse(journal_json(*open(scene))["first_setup"].dump());
    ASSERT_EQ(good["alarms"].size(), 1U);
    const auto why = [&](const json& changes) {
        json setup = good;
        setup["alarms"][0].merge_patch(changes);
        const auto read = read_setup(setup, scene);
        return read ? "" : read.error().message;
    };
    EXPECT_EQ(why(json::object()), "");
    EXPECT_EQ(why({{"from_scene", "yes"}}), "") << "what is not true is false";
    EXPECT_THAT(why({{"id", ""}}), HasSubstr("setup.alarms[0]: id = \"\""));
    EXPECT_THAT(why({{"values", {{"name", nullptr}}}}), HasSubstr("setup.alarms[0]: name: missing"));
    EXPECT_THAT(why({{"values", {{"structure", nullptr}}}}), HasSubstr("setup.alarms[0]: structure: exactly one of"));
    EXPECT_THAT(why({{"values", {{"distance_m", nullptr}}}}), HasSubstr("exactly one of"));
    EXPECT_THAT(why({{"values", {{"structure", nullptr}, {"x_m", west + 20}}}}),
                HasSubstr("y_m: x_m and y_m go together"));
    EXPECT_THAT(why({{"values", {{"distance_m", nullptr}, {"structure", nullptr}, {"chainage_m", 5}, {"depth_m", 1}}}}),
                HasSubstr("depth_m: needs structure"));
}

TEST(PlacedAlarms, two_of_one_id_in_a_saved_setup_are_both_watched) {
    scene::Scene scene = with_house();
    for (const char* name : {"near", "nearer"}) {
        params::AlarmSpec& alarm = scene.spec.alarms.emplace_back();
        alarm.name = name;
        alarm.structure = "House 38";
        alarm.distance = 1000;
    }
    json written = journal_json(*open(scene));
    written["first_setup"]["alarms"][1]["id"] = written["first_setup"]["alarms"][0]["id"];
    const auto journal = read_journal(written.dump());
    ASSERT_TRUE(journal) << journal.error().message;
    const auto opened = replay(*journal, std::make_shared<const scene::Scene>(scene));
    ASSERT_TRUE(opened) << opened.error().message;
    act(*opened->scenario, put_entry("trigger", {{"name", "slope"}, {"release", "scar"}}));  // rules are taken again
    run_until(*opened->scenario, 3);
    EXPECT_EQ(opened->scenario->run().alarms().size(), 2U);
}

TEST(PlacedTriggers, start_a_run_of_the_scene_with_their_limits) {
    const auto scenario = open(channel_scene());
    EXPECT_THAT(refusal(*scenario, put_entry("trigger", {{"name", "slope"}, {"release", "scarp"}})),
                HasSubstr("nearest name: scar"));
    EXPECT_THAT(refusal(*scenario, put_entry("trigger", {{"name", "slope"}, {"volume_limit_m3", 50}})),
                HasSubstr("volume_limit_m3: needs release"));
    act(*scenario, put_entry("trigger", {{"name", "slope"}, {"release", "scar"}, {"volume_limit_m3", 50}}));
    ASSERT_EQ(triggers_of(scenario->run().setup()).size(), 1U);
    const auto started = scenario->opening()({});
    ASSERT_TRUE(started) << started.error().message;
    const json start = {{"action", "trigger"}, {"trigger", "slope"}, {"values", {{"volume_m3", 40}}}};
    EXPECT_THAT(refusal(**started, {{"action", "trigger"}, {"trigger", "slope"}, {"values", {{"volume_m3", 60}}}}),
                HasSubstr("volume_m3 = 60"));
    EXPECT_THAT(act(**started, start).sentence, HasSubstr("started by trigger \"slope\""));
    EXPECT_NEAR(setup_json(**started)["releases"][0]["volume_m3"], 40, 1e-6);
    act(*scenario, {{"action", "remove_trigger"}, {"id", "trigger-1"}});
    EXPECT_TRUE(triggers_of(scenario->run().setup()).empty());
}

TEST(TableSections, say_what_a_form_needs_and_name_no_file_and_no_address) {
    const json sections = table_sections();
    ASSERT_EQ(sections.size(), 9U);
    for (const json& section : sections) {
        for (const json& key : section["keys"]) {
            EXPECT_FALSE(key["help"].get<std::string>().empty()) << key;
            EXPECT_NE(key["key"], "file");
        }
    }
    EXPECT_EQ(sections[0]["one_of"], json::array({json::array({"front_velocity_mps", "debris_speed_mps"})}));
}

}  // namespace
}  // namespace talus::twin::test
