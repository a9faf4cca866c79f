#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <netinet/in.h>
#include <signal.h>
#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"
#include "serve/client.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr const char* controller_token = "controller-token-of-tests";
constexpr const char* viewer_token = "viewer-token-of-the-tests";

/// A port of this machine that was free just now, held by nobody when this has gone.
std::uint16_t free_port() {
    const int file = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ::bind(file, reinterpret_cast<const sockaddr*>(&address), size);
    ::getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
    ::close(file);
    return ntohs(address.sin_port);
}

/// `talus serve` with these arguments, tokens and a port of its own; `meanwhile` runs once it has printed its links,
/// then Ctrl-C ends it.
ProgramOutcome serve(const SmallScene& scene, std::vector<std::string> arguments,
                     const std::function<void(std::uint16_t port)>& meanwhile, const std::string& wait_for = "\n") {
    const std::uint16_t port = free_port();
    arguments.insert(arguments.begin(), "serve");
    for (const std::string& more : {std::string("--port"), std::to_string(port), std::string("--token"),
                                    std::string(controller_token), std::string("--token"), std::string(viewer_token)}) {
        arguments.push_back(more);
    }
    ProgramOptions options;
    options.folder = scene.folder();
    options.environment = {"TMPDIR=" + scene.folder().string()};
    options.wait_for = wait_for;
    options.while_running = [&](int process) {
        meanwhile(port);
        kill(process, SIGINT);
    };
    return run_program(arguments, options);
}

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(ServeCommand, begins_paused_prints_both_links_and_ends_by_ctrl_c) {
    const SmallScene scene;
    const std::size_t files = files_in(scene.folder());
    std::string links;
    const auto outcome = serve(
        scene, {"slope.toml"},
        [&](std::uint16_t port) {
            links = fmt::format("http://127.0.0.1:{}/#token=", port);
            HttpClient client(port, viewer_token);
            const auto state = client.get("/api/scenarios/A/state").json();
            EXPECT_EQ(state["status"], "paused");
            EXPECT_EQ(state["time_s"], 0);
            EXPECT_EQ(client.get("/api/scenarios/A/exports/front.csv").status, 200);
            EXPECT_EQ(HttpClient(port, controller_token).get("/api/session").json()["title"], "Plane");
        },
        "Ctrl-C");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr(links + controller_token));
    EXPECT_THAT(outcome.out, HasSubstr(links + viewer_token));
    EXPECT_THAT(outcome.out, HasSubstr("press Run"));
    EXPECT_EQ(outcome.error, "");
    EXPECT_EQ(files_in(scene.folder()), files) << "something temporary is left";
}

TEST(ServeCommand, runs_at_once_where_told_and_takes_values_of_the_scene) {
    const SmallScene scene;
    const auto outcome =
        serve(scene, {"slope.toml", "--run", "--json", "--set", "solver.end_time_s=0.2", "--threads", "1"},
              [&](std::uint16_t port) {
                  HttpClient client(port, viewer_token);
                  nlohmann::json state;
                  for (int i = 0; i < 100 && state["status"] != "ended"; ++i) {
                      state = client.get("/api/scenarios/A/state").json();
                      usleep(50'000);
                  }
                  EXPECT_EQ(state["status"], "ended");
                  EXPECT_NEAR(state["time_s"].get<double>(), 0.2, 0.05);
                  // Nothing is left to run; a restart shows the beginning.
                  HttpClient hand(port, controller_token);
                  EXPECT_EQ(hand.post("/api/scenarios/A/actions", {{"action", "run"}}).status, 400);
                  EXPECT_EQ(hand.post("/api/scenarios/A/actions", {{"action", "restart"}}).status, 200);
                  EXPECT_EQ(client.get("/api/scenarios/A/state").json()["status"], "paused");
              });
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto links = nlohmann::json::parse(outcome.out);
    EXPECT_THAT(links["controller_url"].get<std::string>(), HasSubstr(std::string("#token=") + controller_token));
}

TEST(ServeCommand, opens_the_built_in_scene_when_none_is_given) {
    const SmallScene scene;
    const auto outcome = serve(
        scene, {},
        [](std::uint16_t port) {
            const auto session = HttpClient(port, viewer_token).get("/api/session").json();
            EXPECT_THAT(session["title"].get<std::string>(), HasSubstr("Sham Tseng"));
        },
        "Ctrl-C");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST(ServeCommand, says_in_one_line_what_is_wrong) {
    const SmallScene scene;
    const auto fails = [&](std::vector<std::string> arguments, int code, const std::string& part) {
        arguments.insert(arguments.begin(), "serve");
        const auto outcome = run_program(arguments, {.folder = scene.folder()});
        EXPECT_EQ(outcome.exit_code, code) << outcome.error;
        EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
        EXPECT_THAT(outcome.error, HasSubstr(part));
        EXPECT_EQ(outcome.out, "");
    };
    fails({"missing.toml"}, 2, "missing.toml");
    fails({"slope.toml", "--set", "solver.particle_spacing_m=-1"}, 2, "solver.particle_spacing_m");
    fails({"slope.toml", "--set", "solver.particle_spacing_m=0.001", "--port", "0"}, 2, "solver.");
    fails({"slope.toml", "--port", "70000"}, 2, "--port");
    fails({"slope.toml", "--host", "here"}, 2, "--host here");
    fails({"slope.toml", "--token", "short"}, 2, "--token");
    const int file = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ASSERT_EQ(::bind(file, reinterpret_cast<const sockaddr*>(&address), size), 0);
    ASSERT_EQ(::listen(file, 1), 0);
    ::getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
    const std::string port = std::to_string(ntohs(address.sin_port));
    fails({"slope.toml", "--tiles", "file:///{z}/{x}/{y}"}, 2, "--tiles file:///{z}/{x}/{y}: begins with neither");
    fails({"slope.toml", "--port", port}, 1, "port " + port + " is in use");
    ::close(file);
}

TEST(ServeCommand, help_teaches) {
    const auto outcome = run_program({"serve", "--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    for (const char* part :
         {"--port", "--allow-host", "--token", "--ensemble", "--calibrations", "Ctrl-C", "Exit codes", "8123"}) {
        EXPECT_THAT(outcome.out, HasSubstr(part));
    }
}

TEST(ServeCommand, refuses_triggers_and_alarms_that_cannot_be_used_without_repeating_secrets) {
    const SmallScene scene;
    const auto said = [&](const std::vector<std::string>& arguments) {
        std::vector<std::string> all{"serve", "slope.toml", "--port", "0"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        ProgramOptions options;
        options.folder = scene.folder();
        const auto outcome = run_program(all, options);
        EXPECT_EQ(outcome.exit_code, 2);
        return outcome.error;
    };
    write_text(scene.input("token.txt"), "secret-1\n");
    write_text(scene.input("hook.txt"), "gopher://secret-2\n");
    EXPECT_THAT(said({"--trigger-token-file", "token.txt"}), HasSubstr("no [[trigger]]"));
    EXPECT_THAT(said({"--webhook-file", "hook.txt"}), HasSubstr("no [[alarm]]"));
    EXPECT_THAT(said({"--mqtt", "127.0.0.1"}), HasSubstr("neither [[trigger]] nor [[alarm]]"));
    EXPECT_THAT(said({"--mqtt-topic", "valley"}), HasSubstr("--mqtt"));
    scene.write(SmallScene::text() +
                "[[trigger]]\nname = \"slope\"\n[[alarm]]\nname = \"a\"\nchainage_m = 5\ndistance_m = 1\n");
    EXPECT_THAT(said({"--trigger-token-file", "nothing.txt"}),
                HasSubstr("--trigger-token-file nothing.txt: no such file"));
    const std::string token = said({"--trigger-token-file", "token.txt"}), hook = said({"--webhook-file", "hook.txt"});
    EXPECT_THAT(token, HasSubstr("16 to 128"));
    EXPECT_THAT(hook, HasSubstr("https:// or http://"));
    EXPECT_EQ((token + hook).find("secret"), std::string::npos);
    EXPECT_THAT(said({"--mqtt", "host:0"}), HasSubstr("HOST or HOST:PORT"));
    EXPECT_THAT(said({"--mqtt", "host", "--mqtt-login-file", "token.txt"}), HasSubstr("password on its"));
}

TEST(ServeCommand, the_start_page_has_the_same_options_of_triggers_and_alarms) {
    const SmallScene scene;
    scene.write(SmallScene::text() +
                "[[trigger]]\nname = \"slope\"\n[[alarm]]\nname = \"a\"\nchainage_m = 5\ndistance_m = 1\n");
    write_text(scene.input("token.txt"), "trigger-token-of-the-tests\n");
    ProgramOptions options;
    options.folder = scene.folder();
    options.environment = {"TMPDIR=" + scene.folder().string()};
    options.wait_for = "\n";
    const std::uint16_t port = free_port();
    Answer started;
    options.while_running = [&](int process) {
        HttpClient client(port, "trigger-token-of-the-tests");
        // Refused with 409 until the scene is open.
        for (int i = 0; i < 400 && started.status != 200; ++i) {
            started = client.post("/api/trigger", {{"trigger", "slope"}});
            usleep(25'000);
        }
        kill(process, SIGINT);
    };
    const auto outcome = run_program({"start", "slope.toml", "--no-browser", "--json", "--folder", "data", "--port",
                                      std::to_string(port), "--trigger-token-file", "token.txt"},
                                     options);
    EXPECT_EQ(started.status, 200) << started.body;
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("started by trigger \"slope\""));
    const auto wrong =
        run_program({"start", "--no-browser", "--webhook-file", "nothing.txt"}, {.folder = scene.folder()});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.error, HasSubstr("--webhook-file nothing.txt: no such file"));
}

TEST(ServeCommand, refuses_secrets_from_a_pipe_instead_of_waiting_for_them) {
    SmallScene scene;
    const std::string pipe = (scene.folder() / "pipe").string();
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::ofstream(scene.scene_file(), std::ios::app)
        << "\n[[trigger]]\nname = \"slope\"\nrelease = \"scar\"\n"
           "\n[[alarm]]\nname = \"moving\"\nchainage_m = 30\ndistance_m = 20\n";
    const std::vector<std::string> broker = {"--mqtt", "localhost"};
    for (const char* option : {"--trigger-token-file", "--webhook-file", "--mqtt-login-file", "--mqtt-ca"}) {
        std::vector<std::string> arguments = {"serve", scene.scene_file(), "--port", "0", option, pipe};
        if (std::string(option).starts_with("--mqtt")) {
            arguments.insert(arguments.end(), broker.begin(), broker.end());
        }
        const ProgramOutcome outcome = run_program(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << option;
        EXPECT_THAT(outcome.error, HasSubstr(std::string(option) + " " + pipe + ": is a pipe")) << outcome.error;
    }
}

}  // namespace
}  // namespace talus::test
