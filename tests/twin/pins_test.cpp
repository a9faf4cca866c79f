// Notes and gauges that people put at places of the ground.
#include <gmock/gmock.h>

#include "twin/journal.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using testing::HasSubstr;

json note(const char* text, double x = west + 30, double y = south + 30) {
    return {{"action", "put_note"}, {"name", text}, {"x_m", x}, {"y_m", y}};
}

json gauge(const char* name, double x = west + 60, double y = south + 30) {
    return {{"action", "put_gauge"}, {"name", name}, {"x_m", x}, {"y_m", y}};
}

TEST(Notes, are_pinned_changed_removed_and_undone) {
    const auto scenario = open(channel_scene());
    act(*scenario, note("Culvert blocked in 2019"));
    act(*scenario, {{"action", "put_note"}, {"id", "note-1"}, {"name", "Culvert cleared"}});
    act(*scenario, {{"action", "put_note"}, {"id", "note-1"}, {"x_m", west + 40}, {"y_m", south + 30}});
    act(*scenario, note("Kindergarten"));
    EXPECT_EQ(setup_json(*scenario)["notes"],
              json({{{"id", "note-1"}, {"name", "Culvert cleared"}, {"x_m", west + 40}, {"y_m", south + 30}},
                    {{"id", "note-2"}, {"name", "Kindergarten"}, {"x_m", west + 30}, {"y_m", south + 30}}}));
    act(*scenario, {{"action", "remove_note"}, {"id", "note-1"}});
    EXPECT_EQ(setup_json(*scenario)["notes"].size(), 1U);
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*scenario)["notes"][0]["name"], "Culvert cleared");
}

TEST(Notes, change_nothing_of_the_run_and_are_in_its_copy) {
    const auto plain = open(channel_scene()), noted = open(channel_scene());
    run_until(*plain, 2);
    run_until(*noted, 1);
    act(*noted, note("Debris is deep here"));
    run_until(*noted, 2);
    EXPECT_EQ(hash(*noted), hash(*plain));
    act(*noted, {{"action", "undo"}});
    act(*noted, {{"action", "redo"}});
    act(*noted, {{"action", "put_release"}, {"id", "release-1"}, {"name", "the scar"}});
    act(*noted, {{"action", "undo"}});
    act(*noted, gauge("bridge"));
    EXPECT_EQ(setup_json(*noted)["changes"], json::array());
    act(*noted, {{"action", "undo"}});
    EXPECT_FALSE(setup_json(*noted)["pending_restart"]);
    const auto copy = noted->copying()({});
    ASSERT_TRUE(copy) << copy.error().message;
    EXPECT_EQ(setup_json(**copy)["notes"], setup_json(*noted)["notes"]);
}

TEST(Notes, are_in_the_journal_and_come_back_with_undo_in_a_replay) {
    const auto scenario = open(channel_scene());
    act(*scenario, note("one"));
    run_until(*scenario, 0.5);
    act(*scenario, {{"action", "remove_note"}, {"id", "note-1"}});
    act(*scenario, {{"action", "undo"}});
    act(*scenario, note("two"));
    const auto journal = read_journal(journal_json(*scenario).dump());
    ASSERT_TRUE(journal) << journal.error().message;
    const auto again = replay(*journal, std::make_shared<const scene::Scene>(channel_scene()));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, journal->hash);

    // Journals of former programs know no notes.
    json former = journal_json(*scenario);
    former["first_setup"].erase("notes");
    former["next"].erase("note");
    for (json& entry : former["actions"]) {
        if (entry.contains("setup")) entry["setup"].erase("notes");
    }
    EXPECT_TRUE(read_journal(former.dump()));
}

TEST(Notes, without_text_or_place_or_beside_the_terrain_are_refused) {
    const auto scenario = open(channel_scene());
    EXPECT_THAT(refusal(*scenario, {{"action", "put_note"}, {"x_m", west + 30}, {"y_m", south + 30}}),
                HasSubstr("name: missing"));
    EXPECT_THAT(refusal(*scenario, {{"action", "put_note"}, {"name", "x"}, {"x_m", west + 30}}),
                HasSubstr("y_m: missing"));
    EXPECT_THAT(refusal(*scenario, note("x", west - 1000)), HasSubstr("not on the terrain"));
    EXPECT_THAT(refusal(*scenario, note(std::string(5000, 'x').c_str())), HasSubstr("name"));
    EXPECT_THAT(refusal(*scenario, {{"action", "remove_note"}, {"id", "note-7"}}), HasSubstr("no such note"));
    EXPECT_EQ(setup_json(*scenario)["notes"], json::array());
}

std::vector<std::string> names_of_readings(const Scenario& scenario) {
    const json answer = gauges_json(scenario);
    std::vector<std::string> names;
    for (const json& reading : answer["gauges"]) names.push_back(reading["name"]);
    return names;
}

TEST(PlacedGauges, record_from_time_0_and_later_ones_from_the_next_restart) {
    const auto scenario = open(channel_scene());
    act(*scenario, gauge("bridge"));
    act(*scenario, {{"action", "put_gauge"}, {"id", "gauge-1"}, {"name", "footbridge"}});
    act(*scenario, {{"action", "put_gauge"}, {"id", "gauge-1"}, {"name", "bridge"}});
    EXPECT_EQ(setup_json(*scenario)["gauges"][0]["in_force"], true);
    EXPECT_EQ(names_of_readings(*scenario), std::vector<std::string>{"bridge"}) << "also a name is that of time 0";
    run_until(*scenario, 0.5);
    act(*scenario, gauge("ford", west + 70));
    EXPECT_EQ(setup_json(*scenario)["gauges"][1]["in_force"], false);
    EXPECT_TRUE(setup_json(*scenario)["pending_restart"]);
    EXPECT_EQ(names_of_readings(*scenario), std::vector<std::string>{"bridge"});
    act(*scenario, {{"action", "restart"}});
    EXPECT_FALSE(setup_json(*scenario)["pending_restart"]);
    EXPECT_EQ(names_of_readings(*scenario), (std::vector<std::string>{"bridge", "ford"}));
    run_until(*scenario, 8);
    const json read = gauges_json(*scenario);
    EXPECT_GT(read["gauges"][0]["peak_depth_m"], 0.1);
    EXPECT_LT(read["gauges"][0]["arrival_s"], read["gauges"][1]["arrival_s"]);
}

TEST(PlacedGauges, change_nothing_of_the_motion) {
    const auto plain = open(channel_scene()), gauged = open(channel_scene());
    act(*gauged, gauge("bridge"));
    run_until(*plain, 2);
    run_until(*gauged, 2);
    EXPECT_EQ(hash(*gauged), hash(*plain));
}

TEST(PlacedGauges, of_the_scene_are_renamed_moved_and_removed_and_come_back_with_the_journal) {
    scene::Scene scene = channel_scene();
    scene.gauges = {{"upper", {west + 40, south + 30}}, {"lower", {west + 80, south + 30}}};
    const auto scenario = open(scene);
    act(*scenario, {{"action", "put_gauge"}, {"id", "gauge-1"}, {"name", "weir"}});
    act(*scenario, {{"action", "remove_gauge"}, {"id", "gauge-2"}});
    act(*scenario, gauge("bridge"));
    EXPECT_EQ(setup_json(*scenario)["gauges"][1]["id"], "gauge-3");
    run_until(*scenario, 1);
    act(*scenario, {{"action", "undo"}});
    act(*scenario, {{"action", "redo"}});
    const auto journal = read_journal(journal_json(*scenario).dump());
    ASSERT_TRUE(journal) << journal.error().message;
    const auto again = replay(*journal, std::make_shared<const scene::Scene>(scene));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, journal->hash);

    // Journals of former programs have the gauges of the scene alone.
    json former = journal_json(*open(scene));
    former["first_setup"].erase("gauges");
    former["next"].erase("gauge");
    const auto read = read_journal(former.dump());
    ASSERT_TRUE(read) << read.error().message;
    const auto opened = replay(*read, std::make_shared<const scene::Scene>(scene));
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_EQ(setup_json(*opened->scenario)["gauges"].size(), 2U);
    act(*opened->scenario, gauge("bridge"));
    EXPECT_EQ(setup_json(*opened->scenario)["gauges"][2]["id"], "gauge-3");
}

TEST(PlacedGauges, beside_terrain_or_path_or_of_a_name_that_is_there_are_refused) {
    const auto scenario = open(channel_scene());
    act(*scenario, gauge("bridge"));
    EXPECT_THAT(refusal(*scenario, gauge("bridge")), HasSubstr("another gauge has this name"));
    EXPECT_THAT(refusal(*scenario, gauge("sea", west - 1000)), HasSubstr("not on the terrain"));
    EXPECT_THAT(refusal(*scenario, {{"action", "put_gauge"}, {"name", "x"}}), HasSubstr("x_m: missing"));
    EXPECT_THAT(refusal(*scenario, {{"action", "put_gauge"}, {"name", "x"}, {"chainage_m", 1e6}}),
                HasSubstr("chainage_m"));
    EXPECT_EQ(setup_json(*scenario)["gauges"].size(), 1U);
}

}  // namespace
}  // namespace talus::twin::test
