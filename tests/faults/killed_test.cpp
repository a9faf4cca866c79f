// kill -9 in a loop: KILLS=200 build/release/bin/test_faults --gtest_filter='Killed*'; an ordinary test run kills
// twice.
#include <csignal>
#include <filesystem>
#include <string>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "faults/faults.hpp"
#include "serve/client.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const long kills = wanted("KILLS", 2);

/// Kills a program some time after it has said where it is, another time each.
void kill_after_a_while(int process, long k) {
    usleep(static_cast<useconds_t>(k * 37'000 % 500'000));
    kill(process, SIGKILL);
}

void expect_nothing_unfinished(const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("unfinished")));
    }
}

/// Ends, however often it was killed, in the same results as if it never was.
void expect_same_result(const SmallScene& scene, std::vector<std::string> command,
                        const std::vector<std::string>& results) {
    const ProgramOptions here{.folder = scene.folder()};
    const auto into = [&](const char* folder, const char* style) {
        auto whole = command;
        whole.insert(whole.end(), {"-o", folder, style});
        return whole;
    };
    ASSERT_EQ(run_program(into("whole", "--quiet"), here).exit_code, 0);
    for (long k = 0; k < kills; ++k) {
        ProgramOptions killed = here;
        killed.wait_for = "\"event\":\"progress\"";
        killed.while_running = [k](int process) { kill_after_a_while(process, k); };
        (void)run_program(into("result", "--json"), killed);
    }
    const auto rest = run_program(into("result", "--quiet"), here);
    EXPECT_EQ(rest.exit_code, 0) << rest.error;
    EXPECT_EQ(rest.error, "") << "a run is there whole or not at all";
    for (const std::string& file : results) {
        EXPECT_EQ(read_text(scene.folder() / "result" / file), read_text(scene.folder() / "whole" / file)) << file;
    }
    expect_nothing_unfinished(scene.folder() / "result");
}

TEST(Killed, an_ensemble_ends_in_the_same_result) {
    const SmallScene scene;
    expect_same_result(scene,
                       {"ensemble", "slope.toml", "--vary", "material.friction_coefficient=0.1:0.5", "--vary",
                        "release.thickness_m=0.2:0.5", "--depth-m", "0.2", "--runs", "4", "--threads", "1"},
                       {"statistics.json", "buildings.csv"});
}

TEST(Killed, a_calibration_ends_in_the_same_result) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 4");
    scene.replace("chainage_m = 5", "chainage_m = 24");
    scene.replace("particle_spacing_m = 0.8", "particle_spacing_m = 1.2");
    expect_same_result(scene,
                       {"calibrate", "slope.toml", "--vary", "material.friction_coefficient=0.1:0.6", "--runs", "6",
                        "--checks", "1", "--threads", "1"},
                       {"factors.csv", "observations.csv", "posterior.csv", "calibration.json"});
}

TEST(Killed, a_run_leaves_nothing_that_the_next_does_not_delete) {
    const SmallScene scene;
    const auto before = scene.files();
    for (long k = 0; k < kills; ++k) {
        ProgramOptions killed{.folder = scene.folder()};
        killed.wait_for = "\"event\":\"progress\"";
        killed.while_running = [k](int process) { kill_after_a_while(process, k); };
        (void)run_program({"run", "slope.toml", "-o", "result", "--json", "--force"}, killed);
    }
    const auto rest =
        run_program({"run", "slope.toml", "-o", "result", "--quiet", "--force"}, {.folder = scene.folder()});
    EXPECT_EQ(rest.exit_code, 0) << rest.error;
    expect_nothing_unfinished(scene.folder());
    fs::remove_all(scene.folder() / "result");
    EXPECT_EQ(scene.files(), before);
}

/// What a person has saved of a session outlives it; the next one has the port and the folder.
TEST(Killed, a_served_session_leaves_its_journal_good_and_its_port_free) {
    const SmallScene scene;
    const std::string token = "controller-token-of-tests";
    const std::uint16_t port = free_port();
    for (long k = 0; k < kills; ++k) {
        const std::string journal = scene.input("session.json");
        ProgramOptions killed{.folder = scene.folder(), .environment = {"TMPDIR=" + scene.folder().string()}};
        killed.wait_for = "\n";
        killed.while_running = [&](int process) {
            HttpClient client(port, token);
            const Answer acted =
                client.post("/api/scenarios/A/actions",
                            {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.3}});
            EXPECT_EQ(acted.status, 200) << acted.body;
            usleep(50'000);
            const Answer saved = client.get("/api/scenarios/A/journal");
            EXPECT_EQ(saved.status, 200);
            write_text(journal, saved.body);
            // Killed while it writes an export.
            Socket exporting(port);
            exporting.send(
                fmt::format("GET /api/scenarios/A/exports/report.html HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n"
                            "Authorization: Bearer {}\r\n\r\n",
                            port, token));
            kill_after_a_while(process, k);
        };
        const auto outcome =
            run_program({"serve", "slope.toml", "--run", "--json", "--token", token, "--token",
                         "viewer-token-of-the-tests", "--port", std::to_string(port), "--threads", "1"},
                        killed);
        EXPECT_EQ(outcome.exit_code, 128 + SIGKILL) << outcome.error;
        const auto replayed = run_program({"replay", "session.json", "--quiet"}, {.folder = scene.folder()});
        EXPECT_EQ(replayed.exit_code, 0) << replayed.error;
    }
}

}  // namespace
}  // namespace talus::test
