#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/fixtures.hpp"
#include "twin/journal.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

TEST(Fault, is_kept_with_its_journal_and_the_last_good_state) {
    const talus::test::TemporaryFolder folder;
    scene::Scene scene = channel_scene();
    scene.spec.solver.compression_limit = -1;  // which any debris exceeds
    ScenarioOptions options;
    options.fault_folder = folder.path();
    const auto scenario = open(std::move(scene), options);
    act(*scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.2}});
    run_until(*scenario, 5);
    ASSERT_EQ(scenario->phase(), run::RunPhase::fault);
    EXPECT_THAT(scenario->message(), HasSubstr("solver.compression_limit"));
    EXPECT_THAT(scenario->message(),
                HasSubstr("the last action was set_parameter; journal and last good state are in"));
    EXPECT_EQ(state_json(*scenario)["message"], scenario->message());
    const auto kept = folder.path() / "fault_1";
    const json fault = json::parse(talus::test::read_text(kept / "fault.json"));
    EXPECT_EQ(fault["step"], scenario->step());
    EXPECT_EQ(fault["last_action"]["value"], 0.2);
    EXPECT_LE(fault["step"].get<int>() - fault["last_good"]["step"].get<int>(), 16);
    const std::string table = talus::test::read_text(kept / "last_good_state.csv");
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), fault["last_good"]["particles"].get<int>() + 1);
    const auto journal = read_journal(talus::test::read_text(kept / "journal.json"));
    ASSERT_TRUE(journal) << journal.error().message;
    EXPECT_EQ(journal->steps, scenario->step());
    EXPECT_EQ(journal->hash, fmt::format("{:016x}", hash(*scenario)));
}

}  // namespace
}  // namespace talus::twin::test
