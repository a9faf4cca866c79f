#include <filesystem>
#include <signal.h>
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

std::vector<std::string> ensemble_command(const std::string& output, const std::vector<std::string>& more = {},
                                          const std::string& runs = "4") {
    std::vector<std::string> arguments = {"ensemble",  "slope.toml",
                                          "--vary",    "material.friction_coefficient=0.1:0.5",
                                          "--vary",    "release.thickness_m=0.2:0.5",
                                          "--depth-m", "0.2",
                                          "--runs",    runs,
                                          "-o",        output};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST(Ensemble, shards_put_together_are_the_whole_byte_for_byte) {
    const SmallScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    const auto whole = run_program(ensemble_command("whole"), here);
    ASSERT_EQ(whole.exit_code, 0) << whole.error;
    EXPECT_THAT(whole.out, HasSubstr("4 of 4 runs complete, 0 failed"));
    EXPECT_THAT(whole.out, HasSubstr("whole/report.html"));
    ASSERT_EQ(run_program(ensemble_command("first", {"--shard", "1/2"}), here).exit_code, 0);
    ASSERT_EQ(run_program(ensemble_command("second", {"--shard", "2/2", "--threads", "1"}), here).exit_code, 0);
    EXPECT_FALSE(fs::exists(scene.folder() / "first/report.html"));
    const auto merged = run_program({"ensemble", "merge", "first", "second", "-o", "both"}, here);
    ASSERT_EQ(merged.exit_code, 0) << merged.error;
    for (const char* file : {"probability_depth_0.2m.tif", "peak_speed_p95.tif", "arrival_time_p50.tif",
                             "buildings.csv", "distributions.csv", "sensitivity.csv", "statistics.json"}) {
        EXPECT_EQ(read_text(scene.folder() / "whole" / file), read_text(scene.folder() / "both" / file)) << file;
    }
}

TEST(Ensemble, means_of_both_models_are_those_of_particles_with_a_smaller_error) {
    const SmallScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    const std::vector<std::string> two = {"--fast-runs", "24", "--set", "solver.grid_cell_m=2.5", "--json"};
    const auto outcome = run_program(ensemble_command("two", two, "6"), here);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto both = nlohmann::json::parse(lines_of(outcome.out).back()).at("two_models");
    EXPECT_EQ(both.at("pairs"), 6);
    EXPECT_EQ(both.at("fast_complete"), 24);
    int narrower = 0;
    for (const auto& row : both.at("results")) {
        const double plain = row.at("particles").at("standard_error"), error = row.at("both").at("standard_error");
        EXPECT_LE(error, plain) << row.at("result");
        narrower += error < 0.8 * plain ? 1 : 0;
        const bool plain_mean = row.at("both") == row.at("particles");
        EXPECT_TRUE(plain_mean || row.at("factor") != 0) << row.at("result");
    }
    EXPECT_GT(narrower, 0);
    EXPECT_THAT(read_text(scene.folder() / "two/report.html"), HasSubstr("Means with the depth-averaged model"));
    EXPECT_TRUE(fs::exists(scene.folder() / "two/fast/runs/000023.run"));
    // particles alone, from the same points
    ASSERT_EQ(run_program(ensemble_command("one", {}, "6"), here).exit_code, 0);
    EXPECT_EQ(read_text(scene.folder() / "one/distributions.csv"), read_text(scene.folder() / "two/distributions.csv"));
    EXPECT_FALSE(fs::exists(scene.folder() / "one/two_models.csv"));
    // evaluated again, without running anything
    const std::string table = read_text(scene.folder() / "two/two_models.csv");
    fs::remove(scene.folder() / "two/two_models.csv");
    ASSERT_EQ(run_program({"ensemble", "merge", "two", "--depth-m", "0.3", "--quiet"}, here).exit_code, 0);
    EXPECT_EQ(read_text(scene.folder() / "two/two_models.csv"), table);
}

TEST(Ensemble, says_why_it_has_no_fast_runs) {
    const SmallScene scene;
    const auto refused = [&](const std::vector<std::string>& more) {
        const auto outcome = run_program(ensemble_command("none", more, "6"), {.folder = scene.folder()});
        EXPECT_EQ(outcome.exit_code, 2);
        return outcome.error;
    };
    EXPECT_THAT(refused({"--fast-runs", "6"}), HasSubstr("they must be more than the 6 runs of particles"));
    EXPECT_THAT(refused({"--fast-runs", "24", "--design", "grid"}), HasSubstr("its points are no sample"));
    EXPECT_THAT(refused({"--fast-runs", "24", "--shard", "1/2"}), HasSubstr("--shard 1/2 is refused"));
    EXPECT_THAT(refused({"--fast-runs", "24", "--set", "solver.model=depth_averaged"}),
                HasSubstr("is the faster model itself"));
    EXPECT_FALSE(fs::exists(scene.folder() / "none"));
}

TEST(Ensemble, runs_the_depth_averaged_model) {
    const SmallScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    const std::string model = "solver.model=depth_averaged";
    const auto outcome = run_program(ensemble_command("result", {"--json", "--set", model}, "6"), here);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto event = nlohmann::json::parse(lines_of(outcome.out).back());
    EXPECT_EQ(event.at("complete"), 6);
    EXPECT_TRUE(fs::exists(scene.folder() / "result/probability_depth_0.2m.tif"));
    EXPECT_TRUE(fs::exists(scene.folder() / "result/report.html"));
    // A number of its own for each hash: six different runs.
    const auto runs = lines_of(read_text(scene.folder() / "result/runs.csv"));
    ASSERT_EQ(runs.size(), 7u);
    const auto cell =
        run_program(ensemble_command("cells", {"--set", model, "--vary", "solver.grid_cell_m=1:2"}), here);
    EXPECT_EQ(cell.exit_code, 2);
    EXPECT_THAT(cell.error, HasSubstr("solver.grid_cell_m: is refused; maps of all runs need the same cells"));
}

TEST(Ensemble, counts_again_with_other_thresholds) {
    const SmallScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    ASSERT_EQ(run_program(ensemble_command("result", {"--quiet"}), here).exit_code, 0);
    const auto again = run_program({"ensemble", "merge", "result", "--depth-m", "0.25", "--json"}, here);
    ASSERT_EQ(again.exit_code, 0) << again.error;
    const auto event = nlohmann::json::parse(lines_of(again.out).back());
    EXPECT_EQ(event.at("event"), "result");
    EXPECT_EQ(event.at("complete"), 4);
    EXPECT_EQ(event.at("thresholds").at("depth_m"), nlohmann::json({0.25}));
    EXPECT_TRUE(fs::exists(scene.folder() / "result/probability_depth_0.25m.tif"));
    EXPECT_FALSE(fs::exists(scene.folder() / "result/probability_depth_0.2m.tif"));  // counted no more
}

TEST(Ensemble, an_interrupted_one_goes_on) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 6");
    scene.replace("particle_spacing_m = 0.8", "particle_spacing_m = 0.5");
    ProgramOptions options{.folder = scene.folder()};
    options.wait_for = "\"event\":\"progress\"";
    options.while_running = [](int process) { kill(process, SIGINT); };
    const auto first = run_program(ensemble_command("result", {"--json", "--threads", "1"}, "6"), options);
    ASSERT_EQ(first.exit_code, 130) << first.error;
    EXPECT_THAT(first.error, HasSubstr("the same command resumes from there"));
    EXPECT_FALSE(fs::exists(scene.folder() / "result/report.html"));
    const auto rest = run_program(ensemble_command("result", {"--quiet"}, "6"), {.folder = scene.folder()});
    EXPECT_EQ(rest.exit_code, 0) << rest.error;
    EXPECT_TRUE(fs::exists(scene.folder() / "result/report.html"));
}

TEST(Ensemble, whichever_file_cannot_be_written_nothing_that_was_finished_is_lost) {
    const SmallScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    ASSERT_EQ(run_program(ensemble_command("whole", {"--quiet"}), here).exit_code, 0);
    int failed = 0;
    for (const long largest :
         {1L, 1000L, 4000L, 12000L, 40000L, 150000L}) {  // bytes of a file: one kind after the other
        ProgramOptions full = here;
        full.largest_file = largest;
        const auto outcome = run_program(ensemble_command("result", {"--quiet"}), full);
        if (outcome.exit_code == 0) break;
        ++failed;
        EXPECT_THAT(outcome.exit_code, testing::AnyOf(1, 2)) << largest;
        EXPECT_EQ(lines_of(outcome.error).size(), 1u) << outcome.error;
        EXPECT_THAT(outcome.error, HasSubstr("result/")) << largest;
    }
    EXPECT_GE(failed, 3);
    const auto rest = run_program(ensemble_command("result", {"--quiet"}), here);
    EXPECT_EQ(rest.exit_code, 0) << rest.error;
    EXPECT_EQ(rest.error, "");
    EXPECT_EQ(read_text(scene.folder() / "result/statistics.json"),
              read_text(scene.folder() / "whole/statistics.json"));
}

TEST(Ensemble, a_damaged_run_is_made_again_with_a_note) {
    const SmallScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    ASSERT_EQ(run_program(ensemble_command("result", {"--quiet"}), here).exit_code, 0);
    const std::string before = read_text(scene.folder() / "result/statistics.json");
    fs::copy_file(scene.folder() / "result/runs/000000.run", scene.folder() / "result/runs/000001.run",
                  fs::copy_options::overwrite_existing);
    const auto merged = run_program({"ensemble", "merge", "result"}, here);
    EXPECT_EQ(merged.exit_code, 1);
    EXPECT_THAT(merged.error, HasSubstr("000001.run: is run 0, not run 1"));
    const auto again = run_program(ensemble_command("result", {"--quiet"}), here);
    EXPECT_EQ(again.exit_code, 0) << again.error;
    EXPECT_EQ(again.error, "talus: note: result/runs/000001.run: is run 0, not run 1; the run is made again\n");
    EXPECT_EQ(read_text(scene.folder() / "result/statistics.json"), before);
}

TEST(Ensemble, bad_input_is_one_line_and_leaves_nothing) {
    const SmallScene scene;
    const auto before = scene.files();
    const auto expect = [&](const std::vector<std::string>& arguments, const std::string& part) {
        const auto outcome = run_program(arguments, {.folder = scene.folder()});
        EXPECT_EQ(outcome.exit_code, 2) << part;
        EXPECT_EQ(lines_of(outcome.error).size(), 1u) << outcome.error;
        EXPECT_THAT(outcome.error, HasSubstr(part));
    };
    expect({"ensemble", "slope.toml", "-o", "x"}, "there is nothing to vary");
    expect({"ensemble", "nix.toml", "--vary", "material.viscosity=0:0.1", "-o", "x"}, "nix.toml");
    expect(ensemble_command("x", {"--vary", "material.viscosity=0.2:0.1"}), "the range is empty");
    expect(ensemble_command("x", {"--vary", "material.viscosity=0.2:2"}), "material.viscosity = 2 is refused");
    expect(ensemble_command("x", {"--speed-mps", "1,half"}), "--speed-mps = \"1,half\" is refused");
    expect(ensemble_command("x", {"--shard", "3/2"}), "i from 1 to n");
    expect(ensemble_command("x", {"--design", "best"}), "must be one of monte_carlo, latin_hypercube");
    expect(ensemble_command("x", {"--plan", "nix.toml"}), "nix.toml");
    expect({"ensemble", "merge", "nix"}, "is no ensemble of talus");
    EXPECT_EQ(scene.files(), before);
}

}  // namespace
}  // namespace talus::test
