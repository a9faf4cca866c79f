#include "start.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <mutex>
#include <spawn.h>
#include <string>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "alert_options.hpp"
#include "command.hpp"
#include "core/input_file.hpp"
#include "core/isolation.hpp"
#include "core/temporary_folder.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "serve/server.hpp"
#include "tokens.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds longest_end{30};  // jobs are asked to end, and have half of it for that

struct StartArguments {
    std::string file;    ///< a scene or a saved session; empty: the start page
    std::string folder;  ///< empty: the user's data folder
    int port = 0;
    std::vector<std::string> tokens;  ///< as of talus serve
    AlertArguments alerts;
    bool browser = true, json = false;
};

constexpr const char* start_help = R"(
Opens the start page in the browser: recent scenes, the built-in one, a new scene from your own terrain, saved
sessions. talus without arguments does the same at a desktop. With a scene or a saved session it opens that at once.
"End talus" on the start page, or Ctrl-C, ends it.

Only this computer can reach it. Own scenes, saved sessions and the list of recent scenes are kept in
$XDG_DATA_HOME/talus, by default ~/.local/share/talus.

A scene with [[trigger]] starts runs when a program or a gauge says so, one with [[alarm]] tells others what is coming.
The options are those of talus serve (docs/triggers.md), and apply to every scene that is opened.
  talus start my_scene.toml --trigger-token-file token.txt --mqtt 127.0.0.1 --webhook-file webhook.txt

Exit codes:
    0  ended on the page or by Ctrl-C
    1  the machine failed: out of memory, no temporary folder
    2  bad input: command line or a file it names
  130  ended at once by a second Ctrl-C
)";

/// Empty: there is none.
fs::path data_folder() {
    if (const char* data = std::getenv("XDG_DATA_HOME"); data != nullptr && *data == '/')
        return fs::path(data) / "talus";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
        return fs::path(home) / ".local/share/talus";
    return {};
}

/// The system chooses the browser; the program does not wait for it. False: it could not be started.
bool open_browser(const std::string& link) {
    std::string opener = "xdg-open", argument = link;
    char* const arguments[] = {opener.data(), argument.data(), nullptr};
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        posix_spawn_file_actions_addopen(&files, file, "/dev/null", O_RDWR, 0);
    }
    pid_t process = 0;
    const bool started = posix_spawnp(&process, opener.c_str(), &files, nullptr, arguments, environ) == 0;
    posix_spawn_file_actions_destroy(&files);
    if (started) {
        std::thread([process] {
            int ignored = 0;
            waitpid(process, &ignored, 0);
        }).detach();
    }
    return started;
}

int start_command(const StartArguments& arguments) {
    InterruptWatch watch;
    serve::StartSettings start;
    start.folder = arguments.folder.empty() ? data_folder() : fs::absolute(arguments.folder);
    if (start.folder.empty()) return fail(exit_code::bad_input, "there is no home folder; name one with --folder");
    if (!arguments.file.empty()) {
        std::error_code error;
        if (!fs::is_regular_file(arguments.file, error)) {
            return fail(exit_code::bad_input, fmt::format("{}: there is no such file", arguments.file));
        }
        start.file = fs::absolute(arguments.file);
    }
    auto tokens = choose_tokens(arguments.tokens);
    if (!tokens) return fail(exit_code::bad_input, tokens.error().message);
    auto alerts = read_alerts(arguments.alerts, *tokens);
    if (!alerts) return fail(exit_code::bad_input, alerts.error().message);
    TemporaryFolder folder;
    if (folder.path().empty()) return fail(exit_code::failure, "cannot make a temporary folder; set TMPDIR");
    watch.remove_at_once(folder.path());
    start.on_quit = [&watch] { watch.request_stop(); };
    std::error_code unknown;
    start.program = fs::read_symlink("/proc/self/exe", unknown);  // without it there are no jobs

    std::mutex mutex;  // guards failure, which another thread writes
    std::string failure;
    serve::ServerOptions options;
    options.port = static_cast<std::uint16_t>(arguments.port);
    options.tokens = std::move(*tokens);
    options.export_folder = folder.path();
    options.scenario.fault_folder = start.folder / "faults";
    options.alerts = std::move(*alerts);
    options.alerts.log = [](const std::string& what) { (void)std::fputs((what + "\n").c_str(), stderr); };
    options.on_failure = [&](const std::string& message) {
        {
            const std::lock_guard lock(mutex);
            failure = message;
        }
        watch.request_stop();
    };
    if (const std::string lacks = missing_isolation(available_isolation()); !lacks.empty()) note(lacks);
    auto server = serve::Server::listen(std::move(options));
    if (!server) return fail(exit_code::failure, server.error().message);
    (*server)->start(std::move(start));
    const std::string link = (*server)->link(serve::Role::controller);
    const nlohmann::json links = {
        {"port", (*server)->port()}, {"controller_url", link}, {"viewer_url", (*server)->link(serve::Role::viewer)}};
    const bool opened = arguments.browser && open_browser(link);
    const std::string text =
        arguments.json ? links.dump() + "\n"
                       : fmt::format("talus {} at\n\n  {}\n\n\"End talus\" on that page, or Ctrl-C, ends it.\n",
                                     opened ? "opens in your browser," : "has its start page", link);
    // Nobody could open a page whose link is lost.
    if (const int printed = print_result(text); printed != exit_code::success && !opened) return printed;
    watch.wait();
    // Whatever still computes then: who ends the program wants it to end.
    std::thread([] {
        std::this_thread::sleep_for(longest_end);
        kill(getpid(), SIGTERM);  // as a second Ctrl-C
    }).detach();
    server->reset();

    const std::lock_guard lock(mutex);
    if (!failure.empty()) return fail(exit_code::failure, "the simulation cannot continue: " + failure);
    return exit_code::success;
}

}  // namespace

bool at_a_desktop() {
    const auto set = [](const char* name) {
        const char* value = std::getenv(name);
        return value != nullptr && *value != 0;
    };
    return isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0 && (set("DISPLAY") || set("WAYLAND_DISPLAY"));
}

int start_page() {
    return start_command({});
}

void add_start(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app =
        program.add_subcommand("start", "open the start page in the browser: choose, make or reopen a scene");
    const auto start = std::make_shared<StartArguments>();
    app->add_option("file", start->file, "a scene file or a saved session to open; default: the start page")
        ->type_name("FILE");
    app->add_flag("!--no-browser", start->browser, "print the link and open no browser");
    app->add_option("--folder", start->folder, "folder that keeps own scenes and saved sessions")->type_name("DIR");
    app->add_option("--port", start->port, "port to listen on; default: 0, any free port")
        ->type_name("N")
        ->check(CLI::Range(0, 65535));
    app->add_option("--token", start->tokens,
                    "token of the links, once for controllers, again for viewers; default: "
                    "new tokens each time")
        ->type_name("TOKEN")
        ->allow_extra_args(false);
    add_alerts(*app, start->alerts);
    app->add_flag("--json", start->json, "print the links as one JSON object on stdout");
    app->footer(start_help);
    commands.push_back({app, [start] { return start_command(*start); }});
}

}  // namespace talus::cli
