#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class StateFile : public testing::Test {
  protected:
    [[nodiscard]] ProgramOutcome run(std::vector<std::string> more) const {
        more.insert(more.begin(), {"run", "slope.toml", "--quiet"});
        return run_program(more, {.folder = scene.folder()});
    }
    [[nodiscard]] std::string hash(const std::string& results) const {
        return nlohmann::json::parse(read_text(scene.input(results + "/manifest.json"))).at("result_hash");
    }
    /// One line, and nothing written.
    void expect_refused(const std::vector<std::string>& options, const std::string& why) const {
        const auto before = scene.files();
        const auto outcome = run(options);
        EXPECT_EQ(outcome.exit_code, 2) << outcome.error;
        EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
        EXPECT_THAT(outcome.error, HasSubstr(why));
        EXPECT_EQ(scene.files(), before);
    }
    SmallScene scene;
};

TEST_F(StateFile, starts_a_run_that_ends_as_the_whole_one_does) {
    ASSERT_EQ(run({"-o", "whole", "--save-state", "half.state@0.5"}).exit_code, 0);
    const auto rest = run({"-o", "rest", "--from-state", "half.state"});
    ASSERT_EQ(rest.exit_code, 0) << rest.error;
    EXPECT_EQ(hash("rest"), hash("whole"));
    for (const char* file : {"peak_depth.tif", "deposit_depth.tif", "front.csv", "buildings.csv"}) {
        EXPECT_EQ(read_text(scene.input(std::string("rest/") + file)),
                  read_text(scene.input(std::string("whole/") + file)))
            << file;
    }
}

TEST_F(StateFile, that_cannot_be_used_is_refused_in_one_sentence) {
    ASSERT_EQ(run({"-o", "first", "--save-state", "end.state"}).exit_code, 0);
    expect_refused({"--from-state", "slope.toml"}, "slope.toml: is no state of a run");
    expect_refused({"--from-state", "none.state"}, "none.state: cannot be read");
    expect_refused({"--from-state", "end.state", "--set", "material.friction_coefficient=0.31"},
                   "end.state: is of a scene with material.friction_coefficient = ");
    expect_refused({"--from-state", "end.state", "--model", "depth_averaged"},
                   "end.state: is of a scene with solver.model = \"particles\", here it is \"depth_averaged\"");
    expect_refused({"--from-state", "end.state", "--convergence"}, "--from-state is refused beside --convergence");
    std::string text = read_text(scene.input("end.state"));
    text[text.size() / 2] ^= 1;
    write_text(scene.input("damaged.state"), text);
    expect_refused({"--from-state", "damaged.state"}, "damaged.state: is damaged");
    expect_refused({"--save-state", "nowhere/x.state"}, "is no folder");
    expect_refused({"-o", "first", "--force", "--save-state", "first/x.state"}, "in the result folder");
}

TEST_F(StateFile, of_the_depth_averaged_model_starts_a_run_that_ends_as_the_whole_one_does) {
    ASSERT_EQ(run({"--model", "depth_averaged", "-o", "whole", "--save-state", "half.state@0.5"}).exit_code, 0);
    const auto rest = run({"--model", "depth_averaged", "-o", "rest", "--from-state", "half.state"});
    ASSERT_EQ(rest.exit_code, 0) << rest.error;
    EXPECT_EQ(hash("rest"), hash("whole"));
    for (const char* file : {"peak_depth.tif", "deposit_depth.tif", "front.csv", "buildings.csv"}) {
        EXPECT_EQ(read_text(scene.input(std::string("rest/") + file)),
                  read_text(scene.input(std::string("whole/") + file)))
            << file;
    }
}

}  // namespace
}  // namespace talus::test
