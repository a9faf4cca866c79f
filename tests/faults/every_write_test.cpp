// Every write of the program, and every large allocation of memory, fails once in turn:
// EVERY_WRITE=1 build/release/bin/test_faults --gtest_filter='Every*' tries all of them, an ordinary test run some of
// each kind.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "faults/faults.hpp"
#include "serve/client.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;

/// Files of a folder with their text, where it is the same in every run: times and dates are not.
std::map<std::string, std::string> contents(const fs::path& folder) {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        const std::string name = entry.path().lexically_relative(folder).string();
        const bool dated = name == "manifest.json" || name == "results.json" || name == "report.html" ||
                           name == "timeseries.csv" || name == "results.gpkg" || name == "stac_item.json";
        found[name] = dated ? "" : read_text(entry.path());
    }
    return found;
}

/// One line that names the cause.
void expect_told(const ProgramOutcome& outcome, const std::string& place) {
    EXPECT_THAT(outcome.exit_code, AnyOf(1, 2));
    EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("talus: error: "));
    EXPECT_THAT(outcome.error, HasSubstr(place));
}

TEST(EveryWrite, of_a_run_that_fails_leaves_nothing) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 0.1");
    scene.replace(
        "[[observation]]",
        "[outputs]\nseries = [\"netcdf\", \"geotiff\", \"paraview\"]\nseries_interval_s = 0.05\n[[observation]]");
    FailingFiles files(scene.folder());
    const auto before = scene.files();
    const auto run = [&](long failing) {
        return run_program({"run", "slope.toml", "-o", "result", "--quiet", "--threads", "1"},
                           {.folder = scene.folder(), .environment = files.environment(failing)});
    };
    ASSERT_EQ(run(0).exit_code, 0);
    const auto whole = contents(scene.folder() / "result");
    EXPECT_GT(whole.size(), 20U);
    const std::vector<std::string> calls = files.calls();
    // netCDF 4.9.0 reads what HDF5 has freed when the last write of a file, of its first block, fails
    // (docs/reliability.md).
    const auto of_netcdf =
        std::find_if(calls.rbegin(), calls.rend(), [](const std::string& c) { return c.ends_with(".nc"); });
    const long closes_netcdf = calls.rend() - of_netcdf;
    for (const long call : chosen(calls, 16)) {
        if (call == closes_netcdf) continue;
        fs::remove_all(scene.folder() / "result");
        const ProgramOutcome outcome = run(call);
        SCOPED_TRACE(files.failed() + " (" + std::to_string(call) + "): " + outcome.error);
        EXPECT_NE(files.failed(), "");
        if (outcome.exit_code == 0) {  // what failed was done otherwise
            EXPECT_EQ(contents(scene.folder() / "result"), whole);
            continue;
        }
        expect_told(outcome, "result");
        if (fs::exists(scene.folder() / "result")) {  // the run over time is missing, or a format of it
            EXPECT_THAT(outcome.error, HasSubstr("all other results are in result"));
            auto found = contents(scene.folder() / "result");
            for (const std::string file : {"depth.tif", "speed.tif", "pressure.tif", "maps.nc"}) {
                const bool named = found["results.qlr"].find("/" + file) != std::string::npos;
                EXPECT_LE(named, found.contains("series/" + file)) << "a layer of a file that is missing: " << file;
            }
            for (const auto& [name, text] : whole) {
                if (name.starts_with("series/") || name == "results.qlr") continue;
                EXPECT_EQ(found[name], text) << name;
            }
            continue;
        }
        EXPECT_EQ(scene.files(), before);
    }
}

TEST(EveryAllocation, of_a_run_that_fails_leaves_nothing) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 0.1");
    FailingFiles memory;
    const auto before = scene.files();
    const auto run = [&](long failing) {
        return run_program({"run", "slope.toml", "-o", "result", "--quiet", "--threads", "1"},
                           {.folder = scene.folder(), .environment = memory.environment(failing)});
    };
    ASSERT_EQ(run(0).exit_code, 0);
    const auto whole = contents(scene.folder() / "result");
    for (const long call : chosen(memory.calls(), 6)) {
        fs::remove_all(scene.folder() / "result");
        const ProgramOutcome outcome = run(call);
        SCOPED_TRACE(memory.failed() + " (" + std::to_string(call) + "): " + outcome.error);
        EXPECT_NE(memory.failed(), "");
        if (outcome.exit_code == 0) {
            EXPECT_EQ(contents(scene.folder() / "result"), whole);
            continue;
        }
        expect_told(outcome, "out of memory");
        EXPECT_EQ(scene.files(), before);
    }
}

/// A command that goes on where it was stopped: after each failing write, it ends with the same results, and no run
/// that was finished is made again.
class Resumed {
  public:
    Resumed(const SmallScene& scene, std::vector<std::string> command, std::vector<std::string> results)
        : scene_(scene), files_(scene.folder()), command_(std::move(command)), results_(std::move(results)) {}

    void expect_nothing_lost(std::size_t some) {
        ASSERT_EQ(run(0).exit_code, 0);
        const auto whole = results();
        const auto all_runs = runs();
        EXPECT_GT(all_runs.size(), 1U);
        for (const long call : chosen(files_.calls(), some)) {
            const ProgramOutcome outcome = run_afresh(call);
            SCOPED_TRACE(files_.failed() + " (" + std::to_string(call) + "): " + outcome.error);
            EXPECT_NE(files_.failed(), "");
            if (outcome.exit_code != 0) expect_told(outcome, "result");
            const auto finished = runs();
            const ProgramOutcome rest = run(0);
            EXPECT_EQ(rest.exit_code, 0) << rest.error;
            EXPECT_EQ(rest.error, "");
            EXPECT_EQ(results(), whole);
            const auto now = runs();
            for (const auto& [name, written] : finished) EXPECT_EQ(now.at(name), written) << name << " was made again";
            for (const auto& entry : fs::recursive_directory_iterator(folder())) {
                EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr("unfinished")));
            }
        }
    }

  private:
    ProgramOutcome run(long failing) {
        return run_program(command_, {.folder = scene_.folder(), .environment = files_.environment(failing)});
    }
    /// Now and then a run makes one write less than that before: the last call is then not reached, and it is tried
    /// again.
    ProgramOutcome run_afresh(long failing) {
        ProgramOutcome outcome;
        for (int attempt = 0; attempt < 3; ++attempt) {
            fs::remove_all(folder());
            outcome = run(failing);
            if (!files_.failed().empty()) break;
        }
        return outcome;
    }
    [[nodiscard]] fs::path folder() const { return scene_.folder() / "result"; }
    [[nodiscard]] std::vector<std::string> results() const {
        std::vector<std::string> texts;
        for (const std::string& file : results_) texts.push_back(read_text(folder() / file));
        return texts;
    }
    /// The records of runs, and when each was written.
    [[nodiscard]] std::map<std::string, fs::file_time_type> runs() const {
        std::map<std::string, fs::file_time_type> found;
        if (!fs::exists(folder() / "runs")) return found;
        for (const auto& entry : fs::directory_iterator(folder() / "runs")) {
            if (entry.path().extension() == ".run") found[entry.path().filename()] = fs::last_write_time(entry);
        }
        return found;
    }
    const SmallScene& scene_;
    FailingFiles files_;
    std::vector<std::string> command_, results_;
};

TEST(EveryWrite, of_an_ensemble_that_fails_loses_nothing) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 0.2");
    Resumed({scene,
             {"ensemble", "slope.toml", "--vary", "material.friction_coefficient=0.1:0.5", "--depth-m", "0.2", "--runs",
              "3", "-o", "result", "--quiet", "--threads", "1"},
             {"statistics.json", "buildings.csv"}})
        .expect_nothing_lost(6);
}

TEST(EveryWrite, of_a_calibration_that_fails_loses_nothing) {
    const SmallScene scene;
    scene.replace("end_time_s = 1", "end_time_s = 4");
    scene.replace("chainage_m = 5", "chainage_m = 24");
    scene.replace("particle_spacing_m = 0.8", "particle_spacing_m = 1.6");
    Resumed({scene,
             {"calibrate", "slope.toml", "--vary", "material.friction_coefficient=0.1:0.6", "--runs", "6", "--checks",
              "1", "-o", "result", "--quiet", "--threads", "1"},
             {"factors.csv", "observations.csv", "posterior.csv", "calibration.json"}})
        .expect_nothing_lost(3);
}

TEST(EveryWrite, of_an_export_that_fails_is_told_and_made_by_the_next_request) {
    const SmallScene scene;
    FailingFiles files(scene.folder());
    // Answers of three requests for the same export.
    const auto serve = [&](long failing) {
        std::vector<Answer> answers;
        ProgramOptions options{.folder = scene.folder(), .environment = files.environment(failing)};
        options.environment.push_back("TMPDIR=" + scene.folder().string());
        options.wait_for = "\n";
        const std::string token = "controller-token-of-tests";
        const std::uint16_t port = free_port();
        options.while_running = [&](int process) {
            HttpClient client(port, token);
            for (int k = 0; k < 3; ++k) answers.push_back(client.get("/api/scenarios/A/exports/peak_depth.tif"));
            kill(process, SIGINT);
        };
        const ProgramOutcome outcome = run_program({"serve", "slope.toml", "--json", "--token", token, "--token",
                                                    "viewer-token-of-the-tests", "--port", std::to_string(port)},
                                                   options);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
        return answers;
    };
    const auto before = scene.files();
    const auto whole = serve(0);
    ASSERT_EQ(whole.size(), 3U);
    ASSERT_EQ(whole[0].status, 200) << whole[0].body;
    std::vector<std::string> of_exports = files.calls();
    // The first call makes the folder of the session, without which there is none.
    for (const long call : chosen(of_exports, 5)) {
        if (call == 1) continue;
        const auto answers = serve(call);
        SCOPED_TRACE(files.failed() + " (" + std::to_string(call) + ")");
        ASSERT_EQ(answers.size(), 3U);
        if (answers[0].status != 200) {
            EXPECT_EQ(answers[0].status, 500);
            // The cause in the words of the C library, or of SQLite for what lies behind it.
            EXPECT_THAT(answers[0].body, AnyOf(HasSubstr("No space left on device"), HasSubstr("cannot be written")));
        } else {
            EXPECT_EQ(answers[0].body, whole[0].body);
        }
        for (const int k : {1, 2}) {
            EXPECT_EQ(answers[k].status, 200) << answers[k].body;
            EXPECT_EQ(answers[k].body, whole[0].body);
        }
        EXPECT_EQ(scene.files(), before);
    }
}

}  // namespace
}  // namespace talus::test
