#include <algorithm>
#include <filesystem>
#include <signal.h>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"
#include "params/fields.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

nlohmann::json result_of(const ProgramOutcome& outcome) {
    const auto lines = lines_of(outcome.out);
    return lines.empty() ? nlohmann::json() : nlohmann::json::parse(lines.back(), nullptr, false);
}

TEST(Run, writes_every_product_and_says_where_the_report_is) {
    const SmallScene scene;
    const auto outcome = run_program({"run", "slope.toml"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    for (const char* name :
         {"peak_depth.tif",    "peak_depth.qml",    "peak_speed.tif",   "peak_speed.qml", "peak_pressure.tif",
          "peak_pressure.qml", "arrival_time.tif",  "arrival_time.qml", "intensity.tif",  "intensity.qml",
          "deposit_depth.tif", "deposit_depth.qml", "terrain.tif",      "terrain.qml",    "front.csv",
          "buildings.csv",     "results.gpkg",      "timeseries.csv",   "manifest.json",  "results.json",
          "report.html"}) {
        EXPECT_TRUE(fs::exists(scene.folder() / "talus_out/slope" / name)) << name;
    }
    EXPECT_THAT(outcome.out, HasSubstr("talus_out/slope/report.html"));
    EXPECT_THAT(outcome.out, HasSubstr("at 5 m: "));
    EXPECT_THAT(outcome.out, HasSubstr("observed 3 m/s"));
    EXPECT_THAT(outcome.out, HasSubstr("run-out angle"));
    EXPECT_THAT(outcome.out, HasSubstr("x real time"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("PARTIAL")));
    EXPECT_THAT(lines_of(outcome.error), testing::Contains("writing maps, tables and report"));
    EXPECT_THAT(outcome.error, Not(HasSubstr("\r"))) << "no bar where stderr is no terminal";
}

TEST(Run, on_the_code_of_a_card_says_so_in_the_manifest) {
    const SmallScene scene;
    for (const char* backend : {"host", "auto"}) {
        const auto outcome = run_program({"run", "slope.toml", "--quiet", "--backend", backend, "-o", backend},
                                         {.folder = scene.folder(), .environment = {"CUDA_VISIBLE_DEVICES=-1"}});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
        const auto manifest = nlohmann::json::parse(read_text(scene.folder() / backend / "manifest.json"));
        const auto& resolved = manifest["resolved"];
        EXPECT_EQ(resolved["backend"], std::string(backend) == "auto" ? "cpu" : backend) << "without a card";
        EXPECT_TRUE(resolved["graphics_card"].is_null());
        EXPECT_EQ(resolved["instruction_set"] == "host", std::string(backend) == "host");
    }
}

TEST(Run, writes_contours_tracks_and_discharge_where_they_are_asked_for) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 2");
    scene.replace("[[observation]]",
                  "[[cross_section]]\nname = \"ditch\"\nline_m = [[824210, 825150], [824210, 825050]]\n"
                  "interval_s = 0.25\n[[observation]]");
    const auto outcome = run_program({"run", "slope.toml", "-o", "result", "--contours", "peak_depth=0.05,0.1",
                                      "--contours", "peak_speed=1", "--tracks"},
                                     {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr("ditch: peak "));
    EXPECT_THAT(read_text(scene.input("result/tracks.csv")), HasSubstr("particle,time_s"));
    EXPECT_TRUE(fs::exists(scene.folder() / "result/tracks.gpkg"));
    EXPECT_GE(lines_of(read_text(scene.input("result/discharge.csv"))).size(), 5U);
    const GDALDatasetUniquePtr data(GDALDataset::Open(scene.input("result/results.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    for (const char* layer : {"contours_peak_depth", "contours_peak_speed", "cross_sections"}) {
        EXPECT_NE(data->GetLayerByName(layer), nullptr) << layer;
    }
    const auto manifest = nlohmann::json::parse(read_text(scene.input("result/manifest.json")));
    EXPECT_GT(manifest["results"]["cross_sections"][0]["passed_m3"], 0);
}

TEST(Run, quiet_prints_nothing) {
    const SmallScene scene;
    const auto outcome = run_program({"run", "slope.toml", "--quiet", "-o", "result"}, {.folder = scene.folder()});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.error, "");
    EXPECT_TRUE(fs::exists(scene.folder() / "result/report.html"));
}

TEST(StandardOutput, on_a_full_disk_is_a_failure) {
    const SmallScene scene;
    const std::vector<std::vector<std::string>> commands{{"--help"},
                                                         {"--version"},
                                                         {"run", "--help"},
                                                         {"scene", "reference"},
                                                         {"scene", "check", "slope.toml"},
                                                         {"validate", "--list"},
                                                         {"run", "slope.toml", "-o", "result"},
                                                         {"run", "slope.toml", "-o", "other", "--json"}};
    for (const std::vector<std::string>& command : commands) {
        const auto outcome = run_program(command, {.folder = scene.folder(), .out = "/dev/full"});
        EXPECT_EQ(outcome.exit_code, 1) << command.front();
        EXPECT_THAT(outcome.error, HasSubstr("talus: error: cannot write to standard output\n"));
    }
    EXPECT_TRUE(std::filesystem::exists(scene.folder() / "result/report.html")) << "only the printed text is lost";
    const auto quiet =
        run_program({"run", "slope.toml", "-o", "quiet", "--quiet"}, {.folder = scene.folder(), .out = "/dev/full"});
    EXPECT_EQ(quiet.exit_code, 0) << quiet.error;
}

TEST(StandardOutput, a_reader_that_ends_early_is_no_failure) {
    const SmallScene scene;
    const std::string command =
        fmt::format("cd '{}' && {{ '{}' run slope.toml -o result; echo $? >code; }} | head -n 1 >first",
                    scene.folder().string(), TALUS_PROGRAM);
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(read_text(scene.folder() / "code"), "0\n");
    EXPECT_EQ(lines_of(read_text(scene.folder() / "first")).size(), 1u);
    EXPECT_TRUE(std::filesystem::exists(scene.folder() / "result/report.html"));
}

TEST(StandardOutput, shows_what_would_reverse_the_text_or_control_the_terminal) {
    const SmallScene scene;
    scene.replace("title = \"", "title = \"safe\\u202Efdp \\u001b[31m");
    const auto outcome = run_program({"run", "slope.toml", "-o", "result"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const std::string report = read_text(scene.folder() / "result/report.html");
    for (const std::string& text : {outcome.out, outcome.error, report}) {
        EXPECT_EQ(text.find("\u202E"), std::string::npos);
        EXPECT_EQ(text.find('\x1b'), std::string::npos);
    }
    EXPECT_THAT(outcome.out + outcome.error, HasSubstr("safe\\u202Efdp \\u001B[31m"));
    EXPECT_THAT(report, HasSubstr("safe\\u202Efdp \\u001B[31m"));
    const auto refused = run_program({"run", "\u202Etoml"}, {.folder = scene.folder()});
    EXPECT_THAT(refused.error, HasSubstr("\\u202Etoml"));
}

TEST(Environment, unknown_variables_of_talus_are_refused) {
    const SmallScene scene;
    for (const std::string wrong : {"TALUS_SIMDS=AVX2", "TALUS_SIMD=fast"}) {
        const auto outcome =
            run_program({"scene", "check", "slope.toml"}, {.folder = scene.folder(), .environment = {wrong}});
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.error, HasSubstr(wrong.substr(0, wrong.find('='))));
    }
}

TEST(Run, json_is_one_object_per_line_with_the_result_last) {
    const SmallScene scene;
    const auto outcome = run_program({"run", "slope.toml", "--json", "-o", "result"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_EQ(outcome.error, "");
    const auto lines = lines_of(outcome.out);
    ASSERT_GE(lines.size(), 2u);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const auto event = nlohmann::json::parse(lines[i], nullptr, false);
        ASSERT_TRUE(event.is_object()) << lines[i];
        EXPECT_EQ(event.at("event"), i + 1 < lines.size() ? "progress" : "result");
    }
    const auto result = result_of(outcome);
    EXPECT_EQ(result.at("status"), "complete");
    EXPECT_EQ(result.at("output"), fs::canonical(scene.folder() / "result").string());
    EXPECT_DOUBLE_EQ(result.at("volume_released_m3").get<double>(),
                     result.at("volume_moving_m3").get<double>() + result.at("volume_deposited_m3").get<double>() +
                         result.at("volume_held_m3").get<double>() + result.at("volume_left_m3").get<double>());
    EXPECT_EQ(result.at("observations").at(0).at("chainage_m"), 5);
}

TEST(Run, gives_the_same_result_on_one_and_two_threads) {
    const SmallScene scene;
    const auto one =
        run_program({"run", "slope.toml", "--json", "-o", "one", "--threads", "1"}, {.folder = scene.folder()});
    const auto two =
        run_program({"run", "slope.toml", "--json", "-o", "two", "--threads", "2"}, {.folder = scene.folder()});
    ASSERT_TRUE(result_of(one).is_object());
    ASSERT_TRUE(result_of(two).is_object());
    EXPECT_EQ(result_of(one).at("hash"), result_of(two).at("hash"));
    EXPECT_EQ(result_of(one).at("thread_count"), 1);
    EXPECT_EQ(result_of(two).at("thread_count"), 2);
}

TEST(Run, draws_a_bar_on_a_terminal_and_removes_it) {
    const SmallScene scene;
    const auto outcome =
        run_program({"run", "slope.toml", "-o", "result"},
                    {.folder = scene.folder(), .environment = {"TERM=xterm"}, .error_is_terminal = true});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("\r["));
    EXPECT_THAT(outcome.error, HasSubstr("x real time"));
    EXPECT_THAT(outcome.error, HasSubstr("ETA "));
    EXPECT_THAT(outcome.error, testing::EndsWith("\r\x1b[K"));
    EXPECT_THAT(outcome.error, Not(HasSubstr("\n"))) << "the bar keeps to one line";
}

TEST(Run, force_replaces_an_earlier_result_whole) {
    const SmallScene scene;
    const std::vector<std::string> arguments{"run", "slope.toml", "-o", "result", "--quiet"};
    ASSERT_EQ(run_program(arguments, {.folder = scene.folder()}).exit_code, 0);
    write_text(scene.input("result/stale.txt"), "from before");
    EXPECT_EQ(run_program(arguments, {.folder = scene.folder()}).exit_code, 2);
    EXPECT_TRUE(fs::exists(scene.input("result/stale.txt")));
    auto forced = arguments;
    forced.emplace_back("--force");
    EXPECT_EQ(run_program(forced, {.folder = scene.folder()}).exit_code, 0);
    EXPECT_FALSE(fs::exists(scene.input("result/stale.txt")));
    EXPECT_TRUE(fs::exists(scene.input("result/report.html")));
}

TEST(Run, force_never_replaces_what_is_no_result) {
    const SmallScene scene;
    fs::create_directory(scene.folder() / "photos");
    write_text(scene.input("photos/cat.jpg"), "precious");
    const auto outcome = run_program({"run", "slope.toml", "-o", "photos", "--force"}, {.folder = scene.folder()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(lines_of(outcome.error).size(), 1u) << outcome.error;
    EXPECT_EQ(read_text(scene.input("photos/cat.jpg")), "precious");
}

TEST(Run, set_replaces_a_value_of_the_scene) {
    const SmallScene scene;
    const auto outcome = run_program({"run", "slope.toml", "--json", "--set", "solver.end_time_s=0.25", "--set",
                                      "solver.particle_spacing_m=1.5", "-o", "result"},
                                     {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_NEAR(result_of(outcome).at("simulated_time_s").get<double>(), 0.25, 0.02);
    EXPECT_DOUBLE_EQ(result_of(outcome).at("particle_spacing_m").get<double>(), 1.5);
}

TEST(Run, data_is_what_the_scene_calls_talus_data) {
    const SmallScene scene;
    fs::create_directory(scene.folder() / "elsewhere");
    fs::rename(scene.input("terrain.tif"), scene.input("elsewhere/terrain.tif"));
    scene.replace("\"terrain.tif\"", "\"${TALUS_DATA}/terrain.tif\"");
    const auto outcome =
        run_program({"run", "slope.toml", "-o", "result", "--quiet", "--data", scene.input("elsewhere")},
                    {.folder = scene.folder()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST(Run, a_fault_writes_what_there_is_and_says_why) {
    const SmallScene scene;
    const auto outcome =
        run_program({"run", "slope.toml", "-o", "result", "--json", "--set", "solver.largest_time_step_s=0.25", "--set",
                     "solver.smallest_time_step_s=0.25", "--set", "material.viscosity=0"},
                    {.folder = scene.folder()});
    EXPECT_EQ(outcome.exit_code, 3);
    const auto lines = lines_of(outcome.error);
    ASSERT_EQ(lines.size(), 1u) << outcome.error;
    EXPECT_THAT(lines[0], testing::StartsWith("talus: error: "));
    EXPECT_THAT(lines[0], HasSubstr("solver.smallest_time_step_s"));
    EXPECT_THAT(lines[0], HasSubstr("partial"));
    EXPECT_EQ(result_of(outcome).at("status"), "fault");
    EXPECT_THAT(lines[0], HasSubstr("; particle "));
    const auto manifest = nlohmann::json::parse(read_text(scene.input("result/manifest.json")));
    EXPECT_EQ(manifest["partial"], true);
    EXPECT_THAT(manifest["files"], testing::IsSupersetOf({"fault/fault.json", "fault/last_good_state.csv"}));
    const auto fault = nlohmann::json::parse(read_text(scene.input("result/fault/fault.json")));
    const std::string table = read_text(scene.input("result/fault/last_good_state.csv"));
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), fault["last_good"]["particles"].get<int>() + 1);
    EXPECT_LE(fault["step"].get<int>() - fault["last_good"]["step"].get<int>(), 16);
    EXPECT_GT(fault["step"].get<int>(), fault["last_good"]["step"].get<int>());
}

class Interrupted : public testing::Test {
  protected:
    Interrupted() {
        scene_.replace("end_time_s = 1", "end_time_s = 1000");
        scene_.replace("thickness_m = 0.3", "thickness_m = 3");
    }
    [[nodiscard]] ProgramOutcome run(const std::function<void(int)>& interrupt) const {
        return run_program({"run", "slope.toml", "--json", "-o", "result"},
                           {.folder = scene_.folder(), .while_running = interrupt, .wait_for = "progress"});
    }
    SmallScene scene_;
};

TEST_F(Interrupted, by_ctrl_c_writes_what_there_is_marked_partial) {
    const auto outcome = run([](int process) { kill(process, SIGINT); });
    EXPECT_EQ(outcome.exit_code, 130);
    EXPECT_EQ(result_of(outcome).at("status"), "interrupted");
    EXPECT_THAT(read_text(scene_.input("result/manifest.json")), HasSubstr("partial"));
    EXPECT_TRUE(fs::exists(scene_.input("result/report.html")));
}

TEST_F(Interrupted, after_plain_lines_of_progress_says_so) {
    const auto outcome = run_program(
        {"run", "slope.toml", "-o", "result"},
        {.folder = scene_.folder(), .while_running = [](int process) { kill(process, SIGINT); }, .wait_for = "left\n"});
    EXPECT_EQ(outcome.exit_code, 130);
    const std::vector<std::string> lines = lines_of(outcome.error);
    ASSERT_GE(lines.size(), 2U);
    EXPECT_THAT(lines.front(), testing::ContainsRegex("^t [0-9.]+ s of at most 1000 s, [0-9.]+ x real time, front"));
    EXPECT_EQ(lines.back(), "interrupted: writing the results so far");
    EXPECT_THAT(outcome.out, HasSubstr("PARTIAL RESULT"));
}

TEST_F(Interrupted, by_termination_too) {
    const auto outcome = run([](int process) { kill(process, SIGTERM); });
    EXPECT_EQ(outcome.exit_code, 130);
    EXPECT_TRUE(fs::exists(scene_.input("result/report.html")));
}

TEST_F(Interrupted, twice_ends_at_once_and_leaves_nothing) {
    const auto before = scene_.files();
    const auto outcome = run([](int process) {
        // Both are pending when it goes on, so the second arrives before anything can have been written.
        kill(process, SIGSTOP);
        kill(process, SIGINT);
        kill(process, SIGTERM);
        kill(process, SIGCONT);
    });
    EXPECT_EQ(outcome.exit_code, 130);
    EXPECT_THAT(outcome.out, Not(HasSubstr("\"result\"")));
    EXPECT_EQ(scene_.files(), before);
}

TEST(Run, says_on_which_instruction_set_it_ran) {
    const SmallScene scene;
    std::vector<std::string> hashes;
    for (const std::string set : {"SSE4", "AVX2"}) {
        const auto outcome = run_program({"run", "slope.toml", "--quiet", "-o", "result", "--force"},
                                         {.folder = scene.folder(), .environment = {"TALUS_SIMD=" + set}});
        if (outcome.exit_code == 2) GTEST_SKIP() << outcome.error;
        const auto manifest = nlohmann::json::parse(read_text(scene.input("result/manifest.json")));
        EXPECT_THAT(manifest.dump(), HasSubstr("\"instruction_set\":\"" + set + "\""));
        hashes.push_back(manifest.at("result_hash"));
    }
    EXPECT_EQ(hashes.at(0), hashes.at(1));
}

TEST(BuiltinScene, runs_without_any_file_and_leaves_no_temporary_folder) {
    const TemporaryFolder folder;
    fs::create_directory(folder.path() / "tmp");
    const auto outcome =
        run_program({"run", "--quiet", "--set", "solver.end_time_s=0.5", "--set", "solver.target_particle_count=500"},
                    {.folder = folder.path(), .environment = {"TMPDIR=" + folder.file("tmp")}});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_TRUE(fs::exists(folder.path() / "talus_out/sham_tseng/report.html"));
    EXPECT_TRUE(fs::is_empty(folder.path() / "tmp"));
    EXPECT_THAT(read_text(folder.path() / "talus_out/sham_tseng/manifest.json"), Not(HasSubstr(folder.file("tmp"))));
}

TEST(Help, teaches_commands_exit_codes_and_every_tunable) {
    const auto general = run_program({"--help"});
    EXPECT_EQ(general.exit_code, 0);
    for (const char* part : {"talus run", "scene new", "scene check", "talus bench", "Exit codes", "130"}) {
        EXPECT_THAT(general.out, HasSubstr(part));
    }
    const auto run = run_program({"run", "--help"});
    EXPECT_EQ(run.exit_code, 0);
    for (const params::Section& section : params::scene_sections()) {
        for (const params::Parameter& parameter : section.parameters) {
            EXPECT_THAT(run.out, HasSubstr("\n  " + parameter.key + "\n")) << section.name;
        }
    }
    EXPECT_EQ(run_program({}).out, general.out) << "without a command the program explains itself";
}

TEST(Run, says_why_the_front_stays_behind_the_run_out) {
    const SmallScene scene;
    const auto outcome = run_program({"run", "slope.toml", "--model", "depth_averaged", "-o", "result", "--set",
                                      "solver.end_time_s=6", "--set", "outputs.arrival_depth_m=0.2"},
                                     {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr("; beyond it debris was at most 0.2 m deep (outputs.arrival_depth_m)\n"));
}

}  // namespace
}  // namespace talus::test
