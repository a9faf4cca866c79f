// Manual pages, tab completion and --version.

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"
#include "support/fixtures.hpp"

namespace talus::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// What bash offers after these words; the last one is begun, or empty.
std::vector<std::string> offered_by_bash(const std::vector<std::string>& words) {
    const TemporaryFolder folder;
    std::string line = "COMP_WORDS=(";
    for (const std::string& word : words) line += "'" + word + "' ";
    std::ofstream(folder.path() / "try.sh")
        << run_program({"completion", "bash"}).out << line << ")\nCOMP_CWORD=" << words.size() - 1
        << "\n_talus\nprintf '%s\\n' \"${COMPREPLY[@]}\" > answer\n";
    const std::string command = "cd '" + folder.path().string() + "' && bash try.sh";
    EXPECT_EQ(std::system(command.c_str()), 0);
    std::vector<std::string> answer = lines_of(read_text(folder.path() / "answer"));
    std::erase(answer, "");
    return answer;
}

TEST(Completion, offers_commands_of_commands_and_their_options) {
    EXPECT_THAT(offered_by_bash({"talus", "val"}), ElementsAre("validate"));
    EXPECT_THAT(offered_by_bash({"talus", "scene", "ch"}), ElementsAre("check"));
    EXPECT_THAT(offered_by_bash({"talus", "run", "my.toml", "--conv"}), ElementsAre("--convergence"));
    EXPECT_THAT(offered_by_bash({"talus", "scene", "check", "--conv"}), IsEmpty()) << "an option of run";
}

TEST(Completion, offers_files_where_there_is_no_option) {
    EXPECT_THAT(offered_by_bash({"talus", "run", "try"}), ElementsAre("try.sh"));
}

TEST(Completion, offers_keys_of_the_scene_after_set_and_vary) {
    EXPECT_THAT(offered_by_bash({"talus", "run", "--set", "material.friction_c"}),
                ElementsAre("material.friction_coefficient="));
    EXPECT_THAT(offered_by_bash({"talus", "ensemble", "my.toml", "--vary", "release.vol"}),
                ElementsAre("release.volume_m3="));
    EXPECT_THAT(offered_by_bash({"talus", "run", "--set", "=", "release.vol"}), ElementsAre("release.volume_m3="))
        << "--set=release.vol, as bash splits it";
    EXPECT_THAT(offered_by_bash({"talus", "run", "--output", "release.vol"}), IsEmpty());
}

TEST(Completion, offers_the_values_of_a_key_that_has_a_list_of_them) {
    EXPECT_THAT(offered_by_bash({"talus", "run", "--set", "solver.model", "=", "depth"}),
                ElementsAre("depth_averaged"));
    EXPECT_THAT(offered_by_bash({"talus", "run", "--set", "scene.reconstruction", "="}), ElementsAre("true", "false"));
    EXPECT_THAT(offered_by_bash({"talus", "run", "--set", "solver.model=depth"}),
                ElementsAre("solver.model=depth_averaged"))
        << "where bash is told not to split at =";
    EXPECT_THAT(offered_by_bash({"talus", "run", "--set", "material.viscosity", "=", "0"}), IsEmpty());
}

TEST(Completion, refuses_other_shells) {
    const auto outcome = run_program({"completion", "fish"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.error, HasSubstr("bash,zsh"));
}

TEST(Manual, has_a_page_for_every_command_with_its_options) {
    const TemporaryFolder folder;
    ASSERT_EQ(run_program({"manual", "--folder", folder.path().string()}).exit_code, 0);
    for (const char* name : {"talus", "talus-run", "talus-scene", "talus-scene-check", "talus-serve", "talus-manual"}) {
        EXPECT_TRUE(std::filesystem::exists(folder.path() / (std::string(name) + ".1"))) << name;
    }
    const std::string page = read_text(folder.path() / "talus-run.1");
    EXPECT_EQ(page, run_program({"manual", "run"}).out);
    EXPECT_THAT(page, AllOf(HasSubstr(".TH TALUS\\-RUN 1"), HasSubstr("talus\\-run \\- run a scene"),
                            HasSubstr("\\fB\\-\\-convergence\\fR"), HasSubstr("\\fISECTION.KEY=VALUE\\fR")));
    EXPECT_THAT(page, Not(HasSubstr("\n...")));  // would be a request of roff
}

TEST(Manual, refuses_an_unknown_command_and_names_the_nearest) {
    const auto outcome = run_program({"manual", "scene", "chek"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.error, AllOf(HasSubstr("chek"), HasSubstr("check")));
}

TEST(Version, names_commit_instruction_set_and_backends) {
    for (const char* flag : {"--version", "-V"}) {
        const auto outcome = run_program({flag}, {.environment = {"TALUS_SIMD=SSE4"}});
        EXPECT_EQ(outcome.exit_code, 0);
        EXPECT_THAT(outcome.out, AllOf(ContainsRegex("^talus [0-9]+\\.[0-9]+\\.[0-9]+\n"), HasSubstr("\ncommit "),
                                       HasSubstr("\ninstruction set SSE4, of "),
                                       ContainsRegex("\nbackends cpu, (cuda \\(|host; no cuda: )")));
    }
}

}  // namespace
}  // namespace talus::test
