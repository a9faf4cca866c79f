// `talus validate` as its users run it.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program.hpp"
#include "support/fixtures.hpp"

namespace talus::test {
namespace {

using testing::HasSubstr;

constexpr int case_failed = 4;

/// A folder with a case that is computed in a moment and holds, or does not.
class Validate : public testing::Test {
  protected:
    void write_case(const std::string& name, double expected, const std::string& more = "") {
        std::filesystem::create_directory(folder_.path() / name);
        std::ofstream(folder_.path() / name / "case.toml")
            << "[case]\ntitle = \"A small slab\"\nkind = \"sliding_slab\"\ndescription = \"For tests.\"\n"
            << "[parameters]\nparticle_spacing_m = 0.6\nlength_m = 6\nlayers = 2\nend_s = 0.4\n"
            << "[[expect]]\nquantity = \"clearance\"\ntolerance = 0.5\nsource = \"by construction\"\n"
            << "expected = " << expected << "\n"
            << more;
    }
    [[nodiscard]] ProgramOutcome run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "validate");
        return run_program(arguments, {.folder = folder_.path()});
    }

    TemporaryFolder folder_;
};

TEST_F(Validate, prints_a_table_and_succeeds) {
    write_case("slab", 0);
    const ProgramOutcome outcome =
        run({"slab", "--json-file", "v.json", "--results", "r.json", "--html", "v.html", "--markdown", "v.md"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr("case"));
    EXPECT_THAT(outcome.out, HasSubstr("pass"));
    const auto list = nlohmann::json::parse(read_text(folder_.path() / "v.json"));
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0]["case"], "slab");
    EXPECT_EQ(list[0]["pass"], true);
    EXPECT_EQ(nlohmann::json::parse(read_text(folder_.path() / "r.json"))["format"], "talus validation");
    EXPECT_THAT(read_text(folder_.path() / "v.html"), HasSubstr("<svg"));
    EXPECT_THAT(read_text(folder_.path() / "v.md"), HasSubstr("# Validation"));
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "v" / "slab_acceleration.svg"));
}

TEST_F(Validate, a_failing_case_is_shown_and_fails) {
    write_case("good", 0);
    write_case("bad", 10);
    const ProgramOutcome outcome = run({"good", "bad", "--json-file", "v.json"});
    EXPECT_EQ(outcome.exit_code, case_failed);
    EXPECT_THAT(outcome.out, HasSubstr("FAIL"));
    const auto list = nlohmann::json::parse(read_text(folder_.path() / "v.json"));
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0]["pass"], true);
    EXPECT_EQ(list[1]["pass"], false);
}

TEST_F(Validate, an_announced_failure_fails_unless_known_ones_are_allowed) {
    write_case("bad", 10, "known_failure = \"a slab lies on the ground\"\n");
    const ProgramOutcome strict = run({"bad"});
    EXPECT_EQ(strict.exit_code, case_failed);
    EXPECT_THAT(strict.out, HasSubstr("FAIL (known)"));
    EXPECT_THAT(strict.out, HasSubstr("a slab lies on the ground"));
    EXPECT_EQ(run({"bad", "--known"}).exit_code, 0);
}

TEST_F(Validate, lists_the_cases_of_the_program) {
    const ProgramOutcome outcome = run({"--list"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, HasSubstr("sliding_slab"));
    EXPECT_THAT(outcome.out, HasSubstr("standing_heap"));
    const ProgramOutcome quick = run({"--list", "--quick"});
    EXPECT_LT(quick.out.size(), outcome.out.size());
    EXPECT_EQ(quick.out.find("sham_tseng_real"), std::string::npos);
}

TEST_F(Validate, bad_input_is_refused_in_one_line_before_anything_runs) {
    write_case("slab", 0);
    const std::vector<std::pair<std::vector<std::string>, std::string>> refused = {
        {{"sliding_slap"}, "sliding_slab"},
        {{"/no/such/folder"}, "/no/such/folder"},
        {{"slab", "--json-file", "no/such/folder/v.json"}, "no/such/folder"},
        {{"slab", "--html", "."}, "is a folder"},
        {{"slab", "--quick"}, "none of these cases is quick"},
        {{"slab", "--threads", "0"}, "--threads"},
        {{"slab", "--threads", "2", "--parallel-runs", "3"}, "--parallel-runs = 3: must be from 1 to 2"},
        {{"slab", "--json", "v.json"}, "--json-file v.json writes the table"},
        {{"slab", "--progress-json"}, "--progress-json: is now --json"},
    };
    for (const auto& [arguments, says] : refused) {
        const ProgramOutcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << arguments[0];
        EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
        EXPECT_THAT(outcome.error, HasSubstr(says));
        EXPECT_EQ(outcome.out, "");
    }
}

TEST_F(Validate, help_names_its_exit_codes) {
    const ProgramOutcome outcome = run({"--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, HasSubstr("4  an expectation does not hold"));
}

}  // namespace
}  // namespace talus::test
