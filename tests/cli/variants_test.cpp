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
using testing::Contains;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

nlohmann::json last_event(const ProgramOutcome& outcome) {
    const auto lines = lines_of(outcome.out);
    return lines.empty() ? nlohmann::json() : nlohmann::json::parse(lines.back(), nullptr, false);
}

TEST(Convergence, prints_a_table_and_writes_it_with_the_products) {
    const SmallScene scene;
    const auto outcome =
        run_program({"run", "slope.toml", "--convergence", "-o", "result"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    for (const char* part : {"half the time step", "double the iterations", "three times the particles", "at 5 m, m/s",
                             "run-out", "wall"}) {
        EXPECT_THAT(outcome.out, HasSubstr(part));
    }
    EXPECT_THAT(outcome.out, ContainsRegex("convergence +(not )?converge"));
    EXPECT_TRUE(fs::exists(scene.folder() / "result/convergence.csv"));
    EXPECT_THAT(read_text(scene.folder() / "result/report.html"), HasSubstr("<section id=\"convergence\">"));
    EXPECT_THAT(read_text(scene.folder() / "result/manifest.json"), HasSubstr("\"three times the particles\""));
    EXPECT_FALSE(fs::exists(scene.folder() / "result/variants.csv"));
}

TEST(Convergence, leaves_the_result_of_the_scene_as_it_is) {
    const SmallScene scene;
    scene.replace("thickness_m = 0.3", "thickness_m = 2");  // layers that press, so that iterations matter
    const auto alone = run_program({"run", "slope.toml", "--json", "-o", "one"}, {.folder = scene.folder()});
    const auto compared =
        run_program({"run", "slope.toml", "--json", "--convergence", "-o", "two"}, {.folder = scene.folder()});
    EXPECT_EQ(last_event(alone).at("hash"), last_event(compared).at("hash"));
    EXPECT_FALSE(last_event(alone).contains("convergence"));
    const auto variants = last_event(compared).at("convergence").at("variants");
    ASSERT_EQ(variants.size(), 3u);
    for (const auto& variant : variants) EXPECT_NE(variant.at("result_hash"), last_event(alone).at("hash"));
    const double particles = last_event(compared).at("particles").get<double>();
    EXPECT_NEAR(variants.at(2).at("particles").get<double>() / particles, 3, 0.3);
    EXPECT_GT(variants.at(0).at("steps").get<double>(), 1.8 * last_event(compared).at("steps").get<double>());
}

TEST(Convergence, json_progress_says_which_run_goes_on) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 2");
    const auto outcome =
        run_program({"run", "slope.toml", "--json", "--convergence", "-o", "result"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    double last_share = 0;
    for (const std::string& line : lines_of(outcome.out)) {
        const auto event = nlohmann::json::parse(line);
        if (event.at("event") == "result") continue;
        EXPECT_EQ(event.at("runs"), 4);
        EXPECT_LE(event.at("share_done_of_all_runs").get<double>(), 1);
        last_share = event.at("share_done_of_all_runs").get<double>();
    }
    EXPECT_GT(last_share, 0);
}

TEST(Convergence, works_without_observations_and_where_debris_hits_nothing) {
    const SmallScene scene;
    scene.replace("[[observation]]\nchainage_m = 5\nfront_velocity_mps = 3\n", "");
    scene.replace("[buildings]\nfile = \"buildings.geojson\"\n", "");
    scene.replace("end_time_s = 1", "end_time_s = 0.02");
    const auto outcome =
        run_program({"run", "slope.toml", "--convergence", "-o", "result"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr("not measured in the run as given"));
    EXPECT_THAT(read_text(scene.folder() / "result/report.html"), HasSubstr("The scene has no observation"));
}

TEST(Vary, runs_once_per_value_one_at_a_time) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 3");  // until they are a few particles apart
    const auto outcome = run_program({"run", "slope.toml", "--json", "--vary", "material.friction_coefficient=0.1,0.3",
                                      "--vary", "release.thickness_m=0.6", "-o", "result"},
                                     {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto variants = last_event(outcome).at("sensitivity").at("variants");
    ASSERT_EQ(variants.size(), 3u);
    EXPECT_EQ(variants.at(0).at("name"), "material.friction_coefficient = 0.1");
    EXPECT_GT(variants.at(0).at("values").at("run_out").at("value_m"),
              variants.at(1).at("values").at("run_out").at("value_m"));
    EXPECT_GT(variants.at(0).at("values").at("peak_speed").at("value_mps"),
              variants.at(1).at("values").at("peak_speed").at("value_mps"));
    EXPECT_NEAR(variants.at(2).at("particles").get<double>() / last_event(outcome).at("particles").get<double>(), 2,
                0.2);
    EXPECT_TRUE(fs::exists(scene.folder() / "result/variants.csv"));
    EXPECT_FALSE(last_event(outcome).contains("convergence"));
}

/// The plane with two variants of its friction.
class NamedVariants : public testing::Test {
  protected:
    NamedVariants() {
        scene_.replace("[[observation]]", R"([[variant]]
name = "slippery"
set = ["material.friction_coefficient=0.1", "material.viscosity=0.2"]
notes = "Like wet clay."
source = "A report."

[[variant]]
name = "rough"
set = ["material.friction_coefficient=0.3"]

[[observation]])");
    }
    [[nodiscard]] ProgramOutcome run(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments{"run", "slope.toml", "--json", "--force", "-o", "result"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_program(arguments, {.folder = scene_.folder()});
    }
    [[nodiscard]] nlohmann::json hash(const std::vector<std::string>& more) const {
        const auto outcome = run(more);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
        return last_event(outcome).at("hash");
    }
    SmallScene scene_;
};

TEST_F(NamedVariants, are_the_scene_with_what_they_set) {
    const auto set_by_hand = hash({"--set", "material.friction_coefficient=0.1", "--set", "material.viscosity=0.2"});
    EXPECT_EQ(hash({"--variant", "slippery"}), set_by_hand);
    EXPECT_NE(hash({}), set_by_hand);
    EXPECT_EQ(hash({"--set", "material.viscosity=0.1", "--variant", "slippery"}),
              hash({"--set", "material.friction_coefficient=0.1", "--set", "material.viscosity=0.1"}))
        << "what is set by hand goes before";
}

TEST_F(NamedVariants, are_all_run_and_compared_in_one_figure) {
    const auto outcome = run({"--variants", "--vary", "material.viscosity=0.3"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto variants = last_event(outcome).at("sensitivity").at("variants");
    ASSERT_EQ(variants.size(), 3U);
    EXPECT_EQ(variants.at(0).at("name"), "slippery");
    EXPECT_EQ(variants.at(0).at("result_hash"), hash({"--variant", "slippery"}));
    EXPECT_EQ(variants.at(1).at("name"), "rough");
    EXPECT_EQ(variants.at(2).at("name"), "material.viscosity = 0.3");
    (void)run({"--variants"});
    const std::string report = read_text(scene_.folder() / "result/report.html");
    for (const char* part : {"<b>slippery</b>", "material.viscosity=0.2", "Like wet clay. Source: A report."}) {
        EXPECT_THAT(report, HasSubstr(part));
    }
    EXPECT_THAT(read_text(scene_.folder() / "result/variants.csv"), HasSubstr("\nslippery,"));
}

TEST_F(NamedVariants, are_listed_where_a_name_is_wrong) {
    const auto wrong = run({"--variant", "sliperry"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.error, HasSubstr("--variant sliperry: the scene has no [[variant]] of that name; it has "
                                       "\"slippery\", \"rough\""));
    EXPECT_EQ(lines_of(wrong.error).size(), 1U);
    const auto check = run_program({"scene", "check", "slope.toml", "--variant", "rough"}, {.folder = scene_.folder()});
    EXPECT_EQ(check.exit_code, 0) << check.error;
    EXPECT_THAT(check.out,
                HasSubstr("variant     slippery: material.friction_coefficient=0.1, material.viscosity=0.2"));
    scene_.write(SmallScene::text());
    EXPECT_THAT(run({"--variants"}).error, HasSubstr("--variants: the scene has no [[variant]]"));
    EXPECT_THAT(run({"--variant", "rough"}).error, HasSubstr("it has none"));
}

class InterruptedVariants : public testing::Test {
  protected:
    InterruptedVariants() { scene_.replace("end_time_s = 1", "end_time_s = 2"); }

    /// Interrupts while the first variant is run.
    [[nodiscard]] ProgramOutcome run(std::vector<std::string> more) const {
        std::vector<std::string> arguments{"run",    "slope.toml",
                                           "-o",     "result",
                                           "--vary", "solver.end_time_s=1000",
                                           "--vary", "material.viscosity=0.2"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_program(arguments, {.folder = scene_.folder(),
                                       .while_running = [](int process) { kill(process, SIGINT); },
                                       .wait_for = "solver.end_time_s = 1000"});
    }
    SmallScene scene_;
};

TEST_F(InterruptedVariants, keep_the_result_of_the_scene_and_name_what_is_missing) {
    const auto outcome = run({"--json"});
    EXPECT_EQ(outcome.exit_code, 130);
    const auto result = last_event(outcome);
    EXPECT_EQ(result.at("status"), "complete");
    const auto variants = result.at("sensitivity").at("variants");
    EXPECT_THAT(variants.at(0).at("missing").get<std::string>(), HasSubstr("interrupted at t = "));
    EXPECT_EQ(variants.at(1).at("missing"), "interrupted before it began");
    EXPECT_FALSE(fs::exists(scene_.folder() / "result/PARTIAL.txt")) << "the scene's own result is whole";
    EXPECT_THAT(read_text(scene_.folder() / "result/variants.csv"), HasSubstr("missing: interrupted before it began"));
}

TEST_F(InterruptedVariants, are_named_on_the_terminal_too) {
    const auto outcome = run({});
    EXPECT_EQ(outcome.exit_code, 130);
    EXPECT_THAT(outcome.out, HasSubstr("2 of 2 runs missing"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("PARTIAL")));
    EXPECT_THAT(lines_of(outcome.error),
                Contains(ContainsRegex("^run 2 of 3, solver.end_time_s = 1000: t .* left of all runs$")));
    EXPECT_THAT(lines_of(outcome.error), Contains("interrupted: writing the results so far"));
}

TEST(Fault, of_the_scene_leaves_its_variants_out) {
    const SmallScene scene;
    const auto outcome = run_program(
        {"run", "slope.toml", "-o", "result", "--json", "--convergence", "--set", "solver.largest_time_step_s=0.25",
         "--set", "solver.smallest_time_step_s=0.25", "--set", "material.viscosity=0"},
        {.folder = scene.folder()});
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(last_event(outcome).at("convergence").at("variants").at(0).at("missing").get<std::string>(),
                HasSubstr("not run because of the fault"));
    EXPECT_TRUE(last_event(outcome).at("convergence").at("converged").is_null());
}

TEST(Compression, is_reported_with_its_limits_and_said_when_above_them) {
    const SmallScene scene;
    const auto good = run_program({"run", "slope.toml", "--json", "-o", "good", "--set", "solver.iteration_count=16"},
                                  {.folder = scene.folder()});
    ASSERT_EQ(good.exit_code, 0) << good.error;
    EXPECT_EQ(last_event(good).at("compression").at("within_limits"), true);
    EXPECT_EQ(last_event(good).at("compression").at("mean_limit"), 0.01);

    // Debris that piles up behind a wall, hardly solved.
    const std::vector<std::string> poor{"run",   "slope.toml",
                                        "-o",    "poor",
                                        "--set", "release.thickness_m=8",
                                        "--set", "solver.iteration_count=1",
                                        "--set", "solver.extra_iteration_count=0",
                                        "--set", "solver.time_step_s=0.06",
                                        "--set", "solver.end_time_s=3"};
    const auto said = run_program(poor, {.folder = scene.folder()});
    ASSERT_EQ(said.exit_code, 0) << said.error;
    EXPECT_THAT(said.out, ContainsRegex("VERDICT +beyond .*compression"));
    EXPECT_THAT(said.out, ContainsRegex("  Debris too compressed during .* % of the simulated time; raise "
                                        "solver.extra_iteration_count \\(now 0\\) or lower solver.time_step_s"));
    EXPECT_THAT(read_text(scene.folder() / "poor/report.html"), HasSubstr("</b> Debris too compressed during"));
    EXPECT_THAT(read_text(scene.folder() / "poor/manifest.json"), HasSubstr("\"within_limits\": false"));
}

}  // namespace
}  // namespace talus::test
