#include <filesystem>
#include <fstream>
#include <iterator>
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
using testing::Not;
namespace fs = std::filesystem;

std::string read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The last line of --json.
json last_event(const std::string& out) {
    const std::size_t end = out.find_last_not_of('\n'), begin = out.rfind('\n', end);
    return json::parse(out.substr(begin == std::string::npos ? 0 : begin + 1, end - begin));
}

TEST(Publish, a_scene_becomes_one_page_with_the_hash_of_its_run) {
    const SmallScene inputs;
    const auto ran = run_program({"run", "slope.toml", "-o", "result", "--quiet"}, {.folder = inputs.folder()});
    ASSERT_EQ(ran.exit_code, 0) << ran.error;
    const auto published = run_program({"publish", "slope.toml", "-o", "twin.html", "--without-engine", "--json"},
                                       {.folder = inputs.folder()});
    ASSERT_EQ(published.exit_code, 0) << published.error;
    const json event = last_event(published.out);
    EXPECT_EQ(event["hash"], json::parse(read(inputs.folder() / "result/manifest.json"))["result_hash"]);
    const std::string html = read(inputs.folder() / "twin.html");
    EXPECT_EQ(event["bytes"], html.size());
    EXPECT_THAT(html, HasSubstr("connect-src 'none'"));
    // A result is computed again.
    const auto again =
        run_program({"publish", "result", "-o", "again.html", "--without-engine"}, {.folder = inputs.folder()});
    EXPECT_EQ(again.exit_code, 0) << again.error;
    EXPECT_THAT(again.out, HasSubstr("data of: the scene names no sources"));
}

TEST(Publish, a_result_of_other_values_is_refused) {
    const SmallScene inputs;
    const std::string friction = "material.friction_coefficient=0.3";
    ASSERT_EQ(
        run_program({"run", "slope.toml", "-o", "result", "--quiet", "--set", friction}, {.folder = inputs.folder()})
            .exit_code,
        0);
    const auto refused =
        run_program({"publish", "result", "-o", "twin.html", "--without-engine"}, {.folder = inputs.folder()});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.error, HasSubstr("give them with --set"));
    EXPECT_FALSE(fs::exists(inputs.folder() / "twin.html"));
    const auto given = run_program({"publish", "result", "-o", "twin.html", "--without-engine", "--set", friction},
                                   {.folder = inputs.folder()});
    EXPECT_EQ(given.exit_code, 0) << given.error;
}

TEST(Publish, a_saved_session_keeps_its_runs_as_far_as_they_went) {
    const SmallScene inputs;
    auto scene = scene::load_scene(inputs.scene_file());
    ASSERT_TRUE(scene) << scene.error().message;
    auto scenario = twin::Scenario::open(std::make_shared<const scene::Scene>(*std::move(scene)));
    ASSERT_TRUE(scenario) << scenario.error().message;
    for (int k = 0; k < 20; ++k) (*scenario)->advance();
    const json journal = journal_json(**scenario);
    const json session = {{"talus_session", 1},
                          {"name", "two"},
                          {"title", "slope"},
                          {"saved_at", "2026-11-27T00:00:00Z"},
                          {"scenarios", json::array({{{"name", "A"}, {"title", ""}, {"journal", journal}},
                                                     {{"name", "B"}, {"title", "the same"}, {"journal", journal}}})},
                          {"overlays", json::array()}};
    std::ofstream(inputs.folder() / "session.json") << session.dump();
    const auto published =
        run_program({"publish", "session.json", "-o", "twin.html", "--without-engine"}, {.folder = inputs.folder()});
    ASSERT_EQ(published.exit_code, 0) << published.error;
    EXPECT_THAT(published.out, HasSubstr("run A: to"));
    EXPECT_THAT(published.out, HasSubstr("run B: to"));
}

TEST(Publish, what_cannot_be_written_is_refused_in_one_sentence_before_the_run) {
    const SmallScene inputs;
    const auto refused = [&](std::vector<std::string> options, const std::string& sentence) {
        options.insert(options.begin(), {"publish", "slope.toml"});
        const auto outcome = run_program(options, {.folder = inputs.folder()});
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.error, HasSubstr(sentence));
        EXPECT_THAT(outcome.out, Not(HasSubstr("wrote")));
    };
    refused({"-o", "twin.txt", "--without-engine"}, "ends in .html");
    refused({"-o", "none/twin.html", "--without-engine"}, "there is no folder");
    std::ofstream(inputs.folder() / "mine.html") << "mine";
    refused({"-o", "mine.html", "--without-engine"}, "already exists");
    EXPECT_EQ(read(inputs.folder() / "mine.html"), "mine");
    refused({"-o", "twin.html", "--without-engine", "--interval", "0"}, "--interval");
    refused({"--without-engine"}, "--output is required");
}

TEST(Publish, a_folder_for_a_web_server_is_replaced_with_force_alone) {
    const SmallScene inputs;
    const std::vector<std::string> options{"publish",  "slope.toml",       "-o",        "site",
                                           "--folder", "--without-engine", "--no-files"};
    ASSERT_EQ(run_program(options, {.folder = inputs.folder()}).exit_code, 0);
    EXPECT_TRUE(fs::exists(inputs.folder() / "site/index.html"));
    EXPECT_EQ(run_program(options, {.folder = inputs.folder()}).exit_code, 2);
    auto forced = options;
    forced.emplace_back("--force");
    EXPECT_EQ(run_program(forced, {.folder = inputs.folder()}).exit_code, 0);
}

}  // namespace
}  // namespace talus::test
