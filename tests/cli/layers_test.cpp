#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"

namespace talus::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

nlohmann::json event_of(const std::string& line) {
    return nlohmann::json::parse(line, nullptr, false);
}

nlohmann::json manifest_of(const SmallScene& scene, const std::string& folder) {
    return nlohmann::json::parse(read_text(scene.folder() / folder / "manifest.json"));
}

TEST(Layers, choose_the_spacing_and_say_what_they_cost) {
    const SmallScene scene;
    const auto outcome =
        run_program({"run", "slope.toml", "--layers", "1", "-o", "result"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.error, ContainsRegex("1 layers: [0-9]+ particles of 0.3 m, about [0-9:]+ for 1 s of debris "
                                             "\\([0-9.e+-]+ x real time\\), [0-9.]+ GB of memory"));
    EXPECT_THAT(outcome.out, HasSubstr("solver.target_layers = 1 over release \"scar\" (0.3 m thick)"));
    EXPECT_THAT(outcome.out, HasSubstr("1 asked for over release \"scar\"; the flow was "));
    EXPECT_THAT(read_text(scene.folder() / "result/results.json"), HasSubstr("asked for: 1 over release"));
    const auto manifest = manifest_of(scene, "result");
    EXPECT_EQ(manifest.at("resolved").at("particle_spacing_m"), 0.3);
    EXPECT_EQ(manifest.at("parameters").at("solver").at("target_layers"), 1);
    EXPECT_TRUE(manifest.at("parameters").at("solver").at("particle_spacing_m").is_null()) << "of the scene file";

    const auto repeated =
        run_program({"run", "slope.toml", "--quiet", "--set", "solver.particle_spacing_m=0.3", "-o", "again"},
                    {.folder = scene.folder()});
    ASSERT_EQ(repeated.exit_code, 0) << repeated.error;
    EXPECT_EQ(manifest_of(scene, "again").at("result_hash"), manifest.at("result_hash"));
}

TEST(Layers, are_a_cost_event_of_json_and_nothing_of_quiet) {
    const SmallScene scene;
    scene.replace("particle_spacing_m = 0.8", "target_layers = 1");
    const auto json = run_program({"run", "slope.toml", "--json", "-o", "one"}, {.folder = scene.folder()});
    ASSERT_EQ(json.exit_code, 0) << json.error;
    EXPECT_EQ(json.error, "");
    const auto first = event_of(lines_of(json.out).front()), last = event_of(lines_of(json.out).back());
    EXPECT_EQ(first.at("event"), "cost");
    EXPECT_EQ(first.at("particle_spacing_m"), 0.3);
    EXPECT_NEAR(first.at("particles").get<double>(), last.at("particles").get<double>(), 1);
    EXPECT_EQ(last.at("target_layers"), 1);
    const auto quiet = run_program({"run", "slope.toml", "--quiet", "-o", "two"}, {.folder = scene.folder()});
    EXPECT_EQ(quiet.exit_code, 0);
    EXPECT_EQ(quiet.out + quiet.error, "");
}

TEST(Layers, of_a_check_stand_with_the_cost) {
    const SmallScene scene;
    const auto outcome = run_program({"scene", "check", "slope.toml", "--layers", "1"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr("with a spacing of 0.3 m (from solver.target_layers)"));
    EXPECT_THAT(outcome.out, HasSubstr("\ncost        1 layers: "));
}

TEST(Layers, in_real_time_are_recorded_and_can_be_repeated) {
    const SmallScene scene;
    // Six particles a layer, and few in all: any machine is fast enough.
    scene.replace("thickness_m = 0.3", "thickness_m = 8");
    scene.replace("particle_spacing_m = 0.8", "particle_limit = 800");
    const auto outcome =
        run_program({"run", "slope.toml", "--layers", "real-time", "-o", "result"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto manifest = manifest_of(scene, "result");
    const double layers = manifest.at("parameters").at("solver").at("target_layers").get<double>();
    EXPECT_GE(layers, 1);
    const std::string repeat = "solver.particle_spacing_m=" + manifest.at("resolved").at("particle_spacing_m").dump();
    EXPECT_THAT(outcome.out, HasSubstr("--set " + repeat + " repeats the run on any machine"));
    const auto repeated =
        run_program({"run", "slope.toml", "--quiet", "--set", repeat, "-o", "again"}, {.folder = scene.folder()});
    ASSERT_EQ(repeated.exit_code, 0) << repeated.error;
    EXPECT_EQ(manifest_of(scene, "again").at("result_hash"), manifest.at("result_hash"));
}

TEST(Layers, are_refused_in_one_line) {
    const SmallScene scene;
    const auto refusal = [&](const std::vector<std::string>& options, const std::string& command = "run") {
        std::vector<std::string> arguments{command};
        if (command == "scene") arguments.emplace_back("check");
        arguments.emplace_back("slope.toml");
        arguments.insert(arguments.end(), options.begin(), options.end());
        const auto before = scene.files();
        const auto outcome = run_program(arguments, {.folder = scene.folder()});
        EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
        EXPECT_EQ(lines_of(outcome.error).size(), 1u) << outcome.error;
        EXPECT_EQ(scene.files(), before);
        return outcome.error;
    };
    for (const char* command : {"run", "serve", "scene", "ensemble", "calibrate"}) {
        EXPECT_THAT(refusal({"--layers", "many"}, command),
                    HasSubstr("--layers many is refused; it must be a number from 1 to 1000, or real-time"));
    }
    EXPECT_THAT(refusal({"--layers", "0.5"}), HasSubstr("--layers 0.5 is refused"));
    EXPECT_THAT(refusal({"--layers", "2", "--set", "solver.particle_spacing_m=0.5"}),
                HasSubstr("--layers 2 and --set solver.particle_spacing_m=0.5: both choose the particle spacing"));
    EXPECT_THAT(refusal({"--set", "solver.target_layers=2", "--set", "solver.target_particle_count=500"}),
                HasSubstr("both choose the particle spacing"));
    EXPECT_THAT(refusal({"--layers", "900"}),
                testing::AllOf(HasSubstr("--layers 900: solver.target_layers = 900 is refused; over release \"scar\""),
                               HasSubstr("solver.particle_limit = 2000000; it must be from 1 to ")));
    EXPECT_THAT(refusal({"--layers", "real-time"}, "ensemble"), HasSubstr("real-time is for a single run"));
}

TEST(Layers, of_an_ensemble_are_those_of_every_run) {
    const SmallScene scene;
    const auto outcome =
        run_program({"ensemble", "slope.toml", "--layers", "1", "--vary", "material.friction_coefficient=0.2:0.4",
                     "--runs", "2", "--set", "solver.end_time_s=0.1", "-o", "many"},
                    {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(read_text(scene.folder() / "many/runs.csv"), Not(HasSubstr("refused")));
}

}  // namespace
}  // namespace talus::test
