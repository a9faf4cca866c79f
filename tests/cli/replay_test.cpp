#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"
#include "twin/answers.hpp"
#include "twin/scenario.hpp"

namespace talus::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A session on the small scene: its journal.
json play(const SmallScene& inputs) {
    const std::vector<std::string> overrides{"material.friction_coefficient=0.2"};
    auto scene = scene::load_scene(inputs.scene_file(), overrides);
    EXPECT_TRUE(scene) << scene.error().message;
    auto scenario =
        twin::Scenario::open(std::make_shared<const scene::Scene>(*std::move(scene)), {.overrides = overrides});
    EXPECT_TRUE(scenario) << scenario.error().message;
    for (int k = 0; k < 10; ++k) (*scenario)->advance();
    const auto done = (*scenario)->apply({{"action", "put_barrier"},
                                          {"line", {{824195, 825080}, {824195, 825120}}},
                                          {"height_m", 2},
                                          {"thickness_m", 1}},
                                         "Ann");
    EXPECT_TRUE(done) << done.error().message;
    EXPECT_TRUE((*scenario)->apply(
        {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.3}}, "Ann"));
    for (int k = 0; k < 20; ++k) (*scenario)->advance();
    return journal_json(**scenario);
}

TEST(Replay, finds_the_same_result_again) {
    const SmallScene inputs;
    write_text(inputs.input("session.json"), play(inputs).dump());
    const auto replayed = run_program({"replay", "session.json"}, {.folder = inputs.folder()});
    EXPECT_EQ(replayed.exit_code, 0) << replayed.error;
    EXPECT_EQ(replayed.error, "");
    EXPECT_THAT(replayed.out, HasSubstr("the same result: 2 actions, step 30"));
    const auto quiet =
        run_program({"replay", "session.json", "--quiet", "--threads", "1"}, {.folder = inputs.folder()});
    EXPECT_EQ(quiet.exit_code, 0) << quiet.error;
    EXPECT_EQ(quiet.out, "");
}

TEST(Replay, takes_the_scene_from_a_bundle) {
    const SmallScene inputs;
    json journal = play(inputs);
    const auto packed = run_program({"bundle", "slope.toml", "-o", "slope.zip"}, {.folder = inputs.folder()});
    ASSERT_EQ(packed.exit_code, 0) << packed.error;
    for (const char* name : {"slope.toml", "terrain.tif", "release.geojson", "buildings.geojson"}) {
        std::filesystem::remove(inputs.input(name));
    }
    write_text(inputs.input("session.json"), journal.dump());
    const auto lost = run_program({"replay", "session.json"}, {.folder = inputs.folder()});
    EXPECT_EQ(lost.exit_code, 2);
    const auto named = run_program({"replay", "session.json", "--scene", "slope.zip"}, {.folder = inputs.folder()});
    EXPECT_EQ(named.exit_code, 0) << named.error;
    EXPECT_EQ(named.error, "") << "other paths in the scene file are no change";
    EXPECT_THAT(named.out, HasSubstr("the same result: 2 actions, step 30"));
    // A session that began from the bundle names it.
    journal["scene"]["file"] = inputs.input("slope.zip");
    write_text(inputs.input("session.json"), journal.dump());
    const auto own = run_program({"replay", "session.json"}, {.folder = inputs.folder()});
    EXPECT_EQ(own.exit_code, 0) << own.error;
}

TEST(Replay, says_when_the_result_is_another) {
    const SmallScene inputs;
    json journal = play(inputs);
    journal["actions"][1]["step"] = 11;
    write_text(inputs.input("session.json"), journal.dump());
    const auto replayed = run_program({"replay", "session.json"}, {.folder = inputs.folder()});
    EXPECT_EQ(replayed.exit_code, 3);
    EXPECT_THAT(replayed.error, HasSubstr("the result differs"));
    EXPECT_EQ(lines_of(replayed.error).size(), 1U);
}

TEST(Replay, says_which_input_has_changed) {
    const SmallScene inputs;
    const json journal = play(inputs);
    write_text(inputs.input("session.json"), journal.dump());
    inputs.replace("title = \"Plane\"", "title = \"Another\"");
    const auto replayed = run_program({"replay", "session.json"}, {.folder = inputs.folder()});
    EXPECT_EQ(replayed.exit_code, 0) << "a title changes no result";
    EXPECT_THAT(replayed.error, HasSubstr("scene has changed since the session"));
}

TEST(Replay, refuses_what_it_cannot_read) {
    const SmallScene inputs;
    const auto error_of = [&](const json& journal) {
        write_text(inputs.input("session.json"), journal.dump());
        const auto outcome = run_program({"replay", "session.json"}, {.folder = inputs.folder()});
        EXPECT_EQ(outcome.exit_code, 2) << outcome.error;
        EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
        return outcome.error;
    };
    json journal = play(inputs);
    journal["last"]["step"] = "many";
    EXPECT_THAT(error_of(journal), HasSubstr("session.json: step = \"many\": must be a whole number"));
    journal["last"]["step"] = 30;
    journal["scene"]["file"] = "nowhere.toml";
    EXPECT_THAT(error_of(journal), HasSubstr("give its present path with --scene"));
    const auto moved =
        run_program({"replay", "session.json", "--scene", inputs.scene_file()}, {.folder = inputs.folder()});
    EXPECT_EQ(moved.exit_code, 0) << moved.error;
    const auto missing = run_program({"replay", "none.json"}, {.folder = inputs.folder()});
    EXPECT_EQ(missing.exit_code, 2);
    EXPECT_THAT(missing.error, HasSubstr("none.json: cannot be opened"));
}

}  // namespace
}  // namespace talus::test
