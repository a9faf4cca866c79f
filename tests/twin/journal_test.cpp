#include "twin/journal.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/hash.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

scene::Scene scene_with_threads(int threads) {
    scene::Scene scene = channel_scene();
    add_building(scene, "house", rectangle(west + 70, south + 27, west + 76, south + 33), 6);
    scene.inputs.push_back({"terrain", "dem.tif", 10, "00000000000000aa"});
    scene.spec.solver.thread_count = threads;
    return scene;
}

/// Everything that people do: live parameter, barrier, drawn release, trigger, undo of each kind, moving a house.
void play(Scenario& scenario) {
    run_until(scenario, 0.4);
    act(scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.3}});
    const std::string release = act(scenario, {{"action", "put_release"},
                                               {"polygon", ring(west + 28, south + 28, west + 33, south + 32)},
                                               {"thickness_m", 0.8}})
                                    .created;
    run_until(scenario, 0.8);
    act(scenario, {{"action", "put_release"}, {"id", release}, {"thickness_m", 1.1}});
    act(scenario, {{"action", "undo"}});
    const std::string barrier = act(scenario, {{"action", "put_barrier"},
                                               {"line", {{west + 45.3, south + 22.1}, {west + 46.7, south + 37.9}}},
                                               {"height_m", 2},
                                               {"thickness_m", 1}})
                                    .created;
    act(scenario, {{"action", "trigger_release"}, {"id", release}});
    run_until(scenario, 2.1);
    act(scenario, {{"action", "put_building"},
                   {"id", "building-1"},
                   {"footprint", ring(west + 52, south + 27, west + 56, south + 33)}});
    act(scenario, {{"action", "remove_barrier"}, {"id", barrier}});
    run_until(scenario, 2.5);
    act(scenario, {{"action", "undo"}});
    run_until(scenario, 3);
    act(scenario, {{"action", "redo"}});
    act(scenario, {{"action", "undo"}});
    act(scenario, {{"action", "set_parameter"}, {"key", "material.viscosity"}, {"value", 0.05}});
    run_until(scenario, 3.5);
}

TEST(Journal, replays_to_the_same_hash_on_any_number_of_threads) {
    const auto scenario = open(scene_with_threads(2));
    play(*scenario);
    const std::string text = journal_json(*scenario).dump();
    const auto journal = read_journal(text);
    ASSERT_TRUE(journal) << journal.error().message;
    EXPECT_EQ(journal->hash, to_hex(hash(*scenario)));
    for (const int threads : {1, 2}) {
        std::uint64_t last = 0;
        const auto again = replay(*journal, std::make_shared<const scene::Scene>(scene_with_threads(threads)),
                                  [&](std::uint64_t step) { return (last = step, true); });
        ASSERT_TRUE(again) << again.error().message;
        EXPECT_EQ(again->hash, journal->hash) << threads;
        EXPECT_EQ(again->steps, scenario->step());
        EXPECT_EQ(last, scenario->step());
    }
    // It does depend on what people did.
    Journal other = *journal;
    other.entries[0].action["value"] = 0.31;
    EXPECT_NE(replay(other, std::make_shared<const scene::Scene>(scene_with_threads(2)))->hash, journal->hash);
}

TEST(Journal, begins_anew_at_restart_with_all_that_was_set_up) {
    const auto scenario = open(scene_with_threads(2));
    play(*scenario);
    act(*scenario, {{"action", "remove_release"}, {"id", "release-1"}});
    act(*scenario, {{"action", "put_release"}, {"id", "release-2"}, {"thickness_m", 1.3}});
    act(*scenario, {{"action", "restart"}});
    run_until(*scenario, 0.2);
    act(*scenario, {{"action", "trigger_release"}, {"id", "release-2"}});
    const std::string created = act(*scenario, {{"action", "put_building"},
                                                {"footprint", ring(west + 40, south + 27, west + 42, south + 29)},
                                                {"height_m", 3}})
                                    .created;
    EXPECT_EQ(created, "building-2");
    run_until(*scenario, 2);
    const auto journal = read_journal(journal_json(*scenario).dump());
    ASSERT_TRUE(journal) << journal.error().message;
    EXPECT_EQ(journal->entries.size(), 2U);
    const auto again = replay(*journal, std::make_shared<const scene::Scene>(scene_with_threads(2)));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, to_hex(hash(*scenario)));
}

TEST(Journal, says_which_inputs_have_changed) {
    const auto scenario = open(scene_with_threads(2));
    const auto journal = read_journal(journal_json(*scenario).dump());
    scene::Scene scene = scene_with_threads(2);
    EXPECT_EQ(changed_inputs(*journal, scene).size(), 0U);
    scene.inputs[0].hash = "00000000000000bb";
    ASSERT_EQ(changed_inputs(*journal, scene).size(), 1U);
    EXPECT_THAT(changed_inputs(*journal, scene)[0], HasSubstr("terrain has changed since the session"));
    scene.inputs.clear();
    EXPECT_THAT(changed_inputs(*journal, scene)[0], HasSubstr("the scene does not any more"));
}

TEST(Journal, refuses_what_is_none_naming_key_and_value) {
    const auto scenario = open(scene_with_threads(2));
    act(*scenario, {{"action", "put_barrier"},
                    {"line", {{west + 45, south + 22}, {west + 46, south + 37}}},
                    {"height_m", 2},
                    {"thickness_m", 1}});
    act(*scenario, {{"action", "undo"}});
    const json good = journal_json(*scenario);
    const auto error_of = [&](const std::string& pointer, const json& value) {
        json bad = good;
        bad[json::json_pointer(pointer)] = value;
        const auto journal = read_journal(bad.dump());
        if (!journal) return journal.error().message;
        const auto again = replay(*journal, std::make_shared<const scene::Scene>(scene_with_threads(2)));
        return again ? "" : again.error().message;
    };
    EXPECT_EQ(error_of("/last/step", 0), "");
    EXPECT_THAT(read_journal("{nonsense").error().message, HasSubstr("is not valid JSON, at byte 3"));
    EXPECT_THAT(read_journal("[1]").error().message, HasSubstr("talus_journal: missing"));
    EXPECT_THAT(error_of("/talus_journal", 7), HasSubstr("talus_journal = 7"));
    EXPECT_THAT(error_of("/scene/file", 3), HasSubstr("file = 3: must be a text"));
    EXPECT_THAT(error_of("/actions/0/step", -1), HasSubstr("step = -1: must be a whole number"));
    EXPECT_THAT(error_of("/actions/0/step", 9), HasSubstr("comes after step 9"));
    EXPECT_THAT(error_of("/actions/0/action", {{"action", "dance"}}), HasSubstr("actions[0]: action = \"dance\""));
    EXPECT_THAT(error_of("/first_setup/releases", 1), HasSubstr("setup.releases = 1: must be a list"));
    EXPECT_THAT(error_of("/first_setup/releases/0/scene", 5), HasSubstr("scene = 5: must be from 0 to 0"));
    EXPECT_THAT(error_of("/first_setup/releases/0", 1), HasSubstr("setup.releases[0]: id = 1"));
    EXPECT_THAT(error_of("/first_setup/buildings/0", {{"id", "x"}}), HasSubstr("setup.buildings[0]: height_m"));
    EXPECT_THAT(error_of("/first_setup/material/viscosity", 2),
                HasSubstr("viscosity = 2: must be a number 0 to below 1"));
    EXPECT_THAT(error_of("/actions/1/setup/barriers", {{{"id", "b"}, {"name", "n"}, {"line", 3}}}),
                HasSubstr("line = 3"));
}

TEST(Journal, refuses_unknown_keys_and_names_the_nearest) {
    const auto scenario = open(scene_with_threads(2));
    act(*scenario, {{"action", "put_release"}, {"id", "release-1"}, {"thickness_m", 1.3}});
    act(*scenario, {{"action", "put_barrier"},
                    {"line", {{west + 45, south + 22}, {west + 46, south + 37}}},
                    {"height_m", 2},
                    {"thickness_m", 1}});
    act(*scenario, {{"action", "undo"}});
    const json good = journal_json(*scenario);
    const auto shared = std::make_shared<const scene::Scene>(scene_with_threads(2));
    const auto error_of = [&](const std::string& pointer, const char* key) {
        json bad = good;
        bad[json::json_pointer(pointer)][key] = 1;
        const auto journal = read_journal(bad.dump());
        if (!journal) return journal.error().message;
        const auto again = replay(*journal, shared);
        return again ? "" : again.error().message;
    };
    const auto names = [](const char* key, const char* nearest) {
        return HasSubstr(fmt::format("\"{}\" = 1: no such key here; nearest known key: {}; allowed: ", key, nearest));
    };
    EXPECT_THAT(error_of("", "action"), names("action", "actions"));
    EXPECT_THAT(error_of("/scene", "override"), names("override", "overrides"));
    EXPECT_THAT(error_of("/scene/inputs/0", "hash"), names("hash", "path"));
    EXPECT_THAT(error_of("/next", "beds"), names("beds", "bed"));
    EXPECT_THAT(error_of("/actions/0", "steps"), names("steps", "step"));
    EXPECT_THAT(error_of("/actions/2/setup", "barrier"), names("barrier", "barriers"));
    EXPECT_THAT(error_of("/last", "time"), names("time", "time_s"));
    EXPECT_THAT(error_of("/first_setup", "zone"), names("zone", "zones"));
    EXPECT_THAT(error_of("/first_setup/releases/0", "trigger"), names("trigger", "triggered"));
    EXPECT_THAT(error_of("/first_setup/buildings/0", "heigth_m"), names("heigth_m", "height_m"));
    EXPECT_THAT(error_of("/actions/2/setup/releases/0", "thicknes_m"), names("thicknes_m", "thickness_m"));
    EXPECT_THAT(error_of("/first_setup/material", "viscosty"),
                HasSubstr("material.viscosty: no such key; nearest known key: viscosity"));
}

}  // namespace
}  // namespace talus::twin::test
