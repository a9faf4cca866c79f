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

std::vector<std::string> calibrate_command(const std::string& output, const std::vector<std::string>& more = {},
                                           const std::string& runs = "8") {
    std::vector<std::string> arguments = {"calibrate", "slope.toml",
                                          "--vary",    "material.friction_coefficient=0.1:0.6",
                                          "--vary",    "release.thickness_m=normal:0.3:0.05",
                                          "--runs",    runs,
                                          "-o",        output};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

/// A front that comes to its observation in every run.
class FlowingScene : public SmallScene {
  public:
    FlowingScene() {
        replace("end_time_s = 1", "end_time_s = 4");
        replace("chainage_m = 5", "chainage_m = 24");
    }
};

TEST(Calibrate, writes_what_it_found_and_a_scene_that_runs_it) {
    const FlowingScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    const auto outcome = run_program(calibrate_command("result", {"--json"}), here);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto event = nlohmann::json::parse(lines_of(outcome.out).back());
    EXPECT_EQ(event.at("event"), "result");
    EXPECT_LE(event.at("runs").get<int>(), 8);
    EXPECT_EQ(event.at("factors").size(), 2u);
    const auto interval = event.at("factors")[0].at("interval_95");
    EXPECT_GE(interval[0].get<double>(), 0.1);
    EXPECT_LE(interval[0].get<double>(), interval[1].get<double>());
    EXPECT_LE(interval[1].get<double>(), 0.6);
    for (const char* file : {"runs.csv", "factors.csv", "observations.csv", "misfit_map.csv", "posterior.csv",
                             "misfit_map.svg", "report.html", "calibration.json"}) {
        EXPECT_TRUE(fs::exists(scene.folder() / "result" / file)) << file;
    }
    const std::string page = read_text(scene.folder() / "result/report.html");
    EXPECT_THAT(page, HasSubstr("<h2>Predicted against observed</h2>"));
    EXPECT_THAT(page, testing::Not(HasSubstr("{{")));

    const auto best = run_program({"run", "result/best_fit/scene.toml", "-o", "again", "--quiet"}, here);
    ASSERT_EQ(best.exit_code, 0) << best.error;
    const auto manifest = nlohmann::json::parse(read_text(scene.folder() / "again/manifest.json"));
    EXPECT_EQ(manifest.at("result_hash"), event.at("best_hash"));
}

TEST(Calibrate, recovers_the_friction_of_a_run_of_the_depth_averaged_model) {
    const FlowingScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    scene.replace("[solver]\n", "[solver]\nmodel = \"depth_averaged\"\ngrid_cell_m = 1.25\n");
    const auto truth = run_program(
        {"run", "slope.toml", "-o", "truth", "--json", "--set", "material.friction_coefficient=0.25"}, here);
    ASSERT_EQ(truth.exit_code, 0) << truth.error;
    const double velocity =
        nlohmann::json::parse(lines_of(truth.out).back()).at("observations")[0].at("front_velocity_mps");
    scene.replace("front_velocity_mps = 3\n",
                  "front_velocity_mps = " + std::to_string(velocity) + "\nuncertainty_mps = 0.1\n");
    const auto outcome = run_program({"calibrate", "slope.toml", "--vary", "material.friction_coefficient=0.1:0.45",
                                      "--runs", "14", "--checks", "2", "-o", "result", "--json"},
                                     here);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto friction = nlohmann::json::parse(lines_of(outcome.out).back()).at("factors")[0];
    EXPECT_NEAR(friction.at("median").get<double>(), 0.25, 0.03);
    const auto best = run_program({"run", "result/best_fit/scene.toml", "-o", "again", "--quiet"}, here);
    ASSERT_EQ(best.exit_code, 0) << best.error;
    EXPECT_THAT(read_text(scene.folder() / "again/manifest.json"), HasSubstr("\"model\": \"depth_averaged\""));
}

/// Where debris started follows from when it came to two places, even if the drawing is 9 m off.
TEST(Calibrate, recovers_how_far_the_release_was_moved) {
    const FlowingScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    // A path of its own: one that is traced would begin at the crown, wherever that is.
    write_text(scene.input("path.geojson"),
               R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": )"
               R"("urn:ogc:def:crs:EPSG::2326"}}, "features": [{"type": "Feature", "properties": {}, "geometry": )"
               R"({"type": "LineString", "coordinates": [[824240, 825100], [824020, 825100]]}}]})");
    scene.replace("[buildings]\nfile = \"buildings.geojson\"\n",
                  "[flow_path]\nfile = \"path.geojson\"\n[material]\nfriction_coefficient = 0.2\n");
    scene.replace("end_time_s = 4", "end_time_s = 8");
    const auto truth =
        run_program({"run", "slope.toml", "-o", "truth", "--quiet", "--set", "release.shift_along_m=9"}, here);
    ASSERT_EQ(truth.exit_code, 0) << truth.error;
    std::string observations;
    for (const std::string& line : lines_of(read_text(scene.folder() / "truth/front.csv"))) {
        for (const std::string chainage : {"65", "75"}) {
            if (!line.starts_with(chainage + ",")) continue;
            const std::string time =
                line.substr(chainage.size() + 1, line.find(',', chainage.size() + 1) - chainage.size() - 1);
            observations += "[[arrival]]\nchainage_m = " + chainage + "\ntime_s = " + time + "\nuncertainty_s = 0.05\n";
        }
    }
    scene.replace("[[observation]]\nchainage_m = 24\nfront_velocity_mps = 3\n", observations);
    const auto outcome = run_program({"calibrate", "slope.toml", "--vary", "release.shift_along_m=-20:20", "--runs",
                                      "14", "--checks", "2", "-o", "result", "--json"},
                                     here);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto shift = nlohmann::json::parse(lines_of(outcome.out).back()).at("factors")[0];
    EXPECT_NEAR(shift.at("median").get<double>(), 9, 0.5);
    EXPECT_LT(shift.at("interval_95")[0].get<double>(), 9);
    EXPECT_GT(shift.at("interval_95")[1].get<double>(), 9);
    EXPECT_LT(shift.at("interval_95")[1].get<double>() - shift.at("interval_95")[0].get<double>(), 3);
}

TEST(Calibrate, without_a_complete_run_the_exit_code_is_three) {
    const FlowingScene scene;
    const std::vector<std::string> failing = {"--quiet", "--set", "solver.displacement_limit=0.001", "--set",
                                              "solver.smallest_time_step_s=0.01"};
    for (int time = 0; time < 2; ++time) {  // the second finds the runs made
        const auto outcome = run_program(calibrate_command("result", failing), {.folder = scene.folder()});
        EXPECT_EQ(outcome.exit_code, 3);
        EXPECT_THAT(outcome.error, HasSubstr("no run of the design is complete"));
    }
}

TEST(Calibrate, an_interrupted_one_goes_on_to_the_same_result) {
    const FlowingScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    ASSERT_EQ(run_program(calibrate_command("whole", {"--quiet"}, "14"), here).exit_code, 0);
    ProgramOptions options = here;
    options.wait_for = "\"event\":\"progress\"";
    options.while_running = [](int process) { kill(process, SIGINT); };
    const auto first = run_program(calibrate_command("part", {"--json", "--threads", "1"}, "14"), options);
    ASSERT_EQ(first.exit_code, 130) << first.error;
    EXPECT_THAT(first.error, HasSubstr("the same command resumes from there"));
    EXPECT_FALSE(fs::exists(scene.folder() / "part/report.html"));
    ASSERT_EQ(run_program(calibrate_command("part", {"--quiet"}, "14"), here).exit_code, 0);
    for (const char* file : {"factors.csv", "observations.csv", "posterior.csv", "calibration.json"}) {
        EXPECT_EQ(read_text(scene.folder() / "whole" / file), read_text(scene.folder() / "part" / file)) << file;
    }
}

TEST(Calibrate, tries_itself_on_known_values) {
    const FlowingScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    const auto outcome = run_program(calibrate_command("tried", {"--recover", "2", "--json"}), here);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto event = nlohmann::json::parse(lines_of(outcome.out).back());
    ASSERT_EQ(event.at("seeds").size(), 2u);
    EXPECT_NE(event.at("seeds")[0].at("truth"), event.at("seeds")[1].at("truth"));
    EXPECT_THAT(read_text(scene.folder() / "tried/recovery.csv"), HasSubstr("seed,factor,truth,median"));
}

TEST(Calibrate, bad_input_is_one_line_and_leaves_nothing) {
    const SmallScene scene;
    const auto before = scene.files();
    const auto expect = [&](const std::vector<std::string>& arguments, const std::string& part) {
        const auto outcome = run_program(arguments, {.folder = scene.folder()});
        EXPECT_EQ(outcome.exit_code, 2) << part;
        EXPECT_EQ(lines_of(outcome.error).size(), 1u) << outcome.error;
        EXPECT_THAT(outcome.error, HasSubstr(part));
    };
    expect({"calibrate", "slope.toml", "-o", "x"}, "there is nothing to vary");
    expect({"calibrate", "nix.toml", "--vary", "material.viscosity=0:0.1", "-o", "x"}, "nix.toml");
    expect(calibrate_command("x", {"--vary", "material.viscosity=0.2:0.2"}), "the range is empty");
    expect(calibrate_command("x", {"--vary", "material.viscosity=0.2:2"}), "material.viscosity = 2 is refused");
    expect(calibrate_command("x", {"--vary", "solver.kernel=spiky,cubic_spline"}),
           "a list has nothing between its values");
    expect(calibrate_command("x", {}, "7"), "runs = 7 is refused; it must be 8 to 2000 with 2 factors");
    expect(calibrate_command("x", {"--design", "9"}), "--design 9 with --checks 10 is refused");
    expect(calibrate_command("x", {"--set", "observation[0].chainage_m=5000"}),
           "observation[0].chainage_m = 5000 lies beyond the flow path");
    scene.replace("[[observation]]\nchainage_m = 5\nfront_velocity_mps = 3\n", "");
    expect(calibrate_command("x"), "has nothing to calibrate against");
    scene.write(SmallScene::text());
    EXPECT_EQ(scene.files(), before);
}

TEST(Calibrate, searches_with_the_faster_model_and_confirms_with_particles) {
    const FlowingScene scene;
    const ProgramOptions here{.folder = scene.folder()};
    const std::vector<std::string> two = {"--search-with", "depth_averaged",        "--fast-runs", "12",
                                          "--set",         "solver.grid_cell_m=2.5"};
    auto loud = two;
    loud.emplace_back("--json");
    const auto outcome = run_program(calibrate_command("two", loud, "5"), here);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto event = nlohmann::json::parse(lines_of(outcome.out).back());
    EXPECT_LE(event.at("runs").get<int>(), 5);
    EXPECT_EQ(event.at("fast_runs").at("model"), "depth_averaged");
    EXPECT_LE(event.at("fast_runs").at("runs").get<int>(), 12);
    EXPECT_EQ(event.at("observations")[0].at("models").at("pairs"), event.at("runs"));
    int particles = 0, fast = 0;
    for (const std::string& line : lines_of(read_text(scene.folder() / "two/runs.csv"))) {
        particles += line.find(",particles,") != std::string::npos ? 1 : 0;
        fast += line.find(",depth_averaged,") != std::string::npos ? 1 : 0;
    }
    EXPECT_EQ(particles, event.at("runs").get<int>());
    EXPECT_EQ(fast, event.at("fast_runs").at("runs").get<int>());
    const std::string page = read_text(scene.folder() / "two/report.html");
    EXPECT_THAT(page, HasSubstr("class=\"dot-fast\""));
    EXPECT_THAT(page, HasSubstr("Two models were run"));
    const auto results = nlohmann::json::parse(read_text(scene.folder() / "two/results.json"));
    EXPECT_EQ(results.at("fast").at("runs"), event.at("fast_runs").at("runs"));
    EXPECT_THAT(read_text(scene.folder() / "two/best_fit/scene.toml"),
                testing::Not(HasSubstr("\nmodel = \"depth_averaged\"")));

    // interrupted while the fast model runs, then to the same result
    ProgramOptions options = here;
    options.wait_for = "\"event\":\"progress\"";
    options.while_running = [](int process) { kill(process, SIGINT); };
    loud.insert(loud.end(), {"--threads", "1"});
    const auto first = run_program(calibrate_command("part", loud, "5"), options);
    ASSERT_EQ(first.exit_code, 130) << first.error;
    auto quiet = two;
    quiet.emplace_back("--quiet");
    ASSERT_EQ(run_program(calibrate_command("part", quiet, "5"), here).exit_code, 0);
    for (const char* file : {"factors.csv", "observations.csv", "posterior.csv"}) {
        EXPECT_EQ(read_text(scene.folder() / "two" / file), read_text(scene.folder() / "part" / file)) << file;
    }
    // the runs of one model alone are another calibration
    const auto other = run_program(calibrate_command("two", {"--quiet"}, "8"), here);
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_THAT(other.error, HasSubstr("holds another ensemble"));
}

TEST(Calibrate, says_why_it_cannot_search_with_two_models) {
    const FlowingScene scene;
    const auto refused = [&](const std::vector<std::string>& more, const std::string& runs) {
        const auto outcome = run_program(calibrate_command("none", more, runs), {.folder = scene.folder()});
        EXPECT_EQ(outcome.exit_code, 2);
        return outcome.error;
    };
    EXPECT_THAT(refused({"--search-with", "particles"}, "8"), HasSubstr("it must be depth_averaged"));
    EXPECT_THAT(refused({"--fast-runs", "20"}, "8"), HasSubstr("--search-with"));
    EXPECT_THAT(refused({"--search-with", "depth_averaged", "--fast-runs", "5"}, "8"),
                HasSubstr("fast runs = 5 is refused; it must be 8 to 500 with 2 factors"));
    EXPECT_THAT(refused({"--search-with", "depth_averaged"}, "2"),
                HasSubstr("runs = 2 is refused; it must be 3 to 2000"));
    EXPECT_THAT(refused({"--search-with", "depth_averaged", "--set", "solver.model=depth_averaged"}, "8"),
                HasSubstr("is the faster model itself"));
    EXPECT_FALSE(fs::exists(scene.folder() / "none"));
}

}  // namespace
}  // namespace talus::test
