#include <arpa/inet.h>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "alert_options.hpp"
#include "command.hpp"
#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "layers.hpp"
#include "scene/builtin.hpp"
#include "scene/scene.hpp"
#include "scene_input.hpp"
#include "serve/server.hpp"
#include "serve/tile_addresses.hpp"
#include "tokens.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

struct ServeArguments {
    std::string scene;  ///< a scene file; empty: the built-in scene
    std::string host = "127.0.0.1";
    int port = 8123;
    std::vector<std::string> allowed_hosts;
    std::vector<std::string> tokens;  ///< the controllers', then the viewers'; absent: random ones
    std::optional<int> threads;
    std::vector<std::string> overrides;  ///< "section.key=value"
    std::string layers;                  ///< of --layers; empty: not given
    std::string data;                    ///< value of TALUS_DATA; empty: as in the environment
    std::string calibrations;            ///< a folder that keeps calibrations; empty: they are not kept
    std::vector<std::string> ensembles;  ///< folders of finished ensembles whose maps are shown
    std::vector<std::string> tiles;      ///< addresses of map tiles that the page may offer
    AlertArguments alerts;
    bool run = false;  ///< start immediately
    bool quiet = false, json = false;
};

constexpr const char* serve_help = R"(
Opens the scene as a live twin in the browser: press Run in the page, change parameters, releases, barriers and buildings
while debris moves, replay any moment, compare two scenarios, export maps and report. It prints two links: with the
first, one person at a time controls the twin; the second only allows watching. Both contain a secret token.
Ctrl-C ends it.

By default only this computer can reach it. To share it in a network, listen on all addresses and give the host names
that browsers use. Connections are not encrypted; where that matters, put a web server with TLS in front:
  talus serve my_scene.toml --host 0.0.0.0 --allow-host twin.example.org

Programs can use the same interface as the page: docs/protocol.md, or /api/openapi.json of the running server.
  talus serve my_scene.toml --run --json
  curl -H "Authorization: Bearer TOKEN" http://127.0.0.1:8123/api/scenarios/A/state

A scene with [[trigger]] and [[alarm]] starts runs when a program or a gauge says so, and tells others what is coming:
docs/triggers.md. Both are off unless an option turns them on.
  talus serve my_scene.toml --trigger-token-file token.txt --mqtt 127.0.0.1 --webhook-file webhook.txt

Exit codes:
    0  ended by Ctrl-C
    1  the machine failed: port in use, out of memory
    2  bad input: command line, scene or a file it names
  130  ended at once by a second Ctrl-C
)";

bool is_address(const std::string& text) {
    in6_addr ignored{};
    return text == "localhost" || inet_pton(AF_INET, text.c_str(), &ignored) == 1 ||
           inet_pton(AF_INET6, text.c_str(), &ignored) == 1;
}

int print_links(const ServeArguments& arguments, const scene::Scene& scene, const serve::Server& server) {
    if (arguments.quiet) return exit_code::success;
    const std::string control = server.link(serve::Role::controller), view = server.link(serve::Role::viewer);
    std::string text;
    if (arguments.json) {
        const nlohmann::json links = {{"title", scene.spec.scene.title},
                                      {"port", server.port()},
                                      {"controller_url", control},
                                      {"viewer_url", view}};
        text = links.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    } else {
        for (const std::string& note : scene.notes) text += fmt::format("note: {}\n", note);
        text += fmt::format("{}\n\n  to control it  {}\n  to watch it    {}\n\n{} Ctrl-C ends it.\n",
                            scene.spec.scene.title, control, view,
                            arguments.run ? "It runs. Open a link in the browser."
                                          : "Open the first link in the browser and press Run.");
    }
    return print_result(text);
}

int serve_command(const ServeArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    if (!is_address(arguments.host)) {
        return fail(exit_code::bad_input,
                    fmt::format("--host {}: not an address; for example 127.0.0.1, 0.0.0.0 or ::1", arguments.host));
    }
    auto tokens = choose_tokens(arguments.tokens);
    if (!tokens) return fail(exit_code::bad_input, tokens.error().message);

    TemporaryFolder folder;
    if (folder.path().empty()) return fail(exit_code::failure, "cannot make a temporary folder; set TMPDIR");
    watch.remove_at_once(folder.path());
    const auto found = find_scene(arguments.scene, watch);
    if (!found) return fail(exit_code::bad_input, found.error().message);
    const fs::path& file = found->file;
    auto overrides = with_layers(arguments.overrides, arguments.layers);
    if (!overrides) return fail(exit_code::bad_input, overrides.error().message);
    if (arguments.threads) overrides->push_back(fmt::format("solver.thread_count={}", *arguments.threads));
    auto loaded = load_layered(file, *overrides, arguments.layers);
    if (!loaded) return fail(exit_code::bad_input, loaded.error().message);
    leave_out_zoom(*loaded, "the live twin");
    std::function<void(const std::string&)> say;
    if (!arguments.quiet) say = [](const std::string& what) { (void)std::fputs((what + "\n").c_str(), stderr); };
    const auto settled = settle_layers(file, *overrides, arguments.layers, *loaded, say, watch.stop_requested());
    if (!settled) return fail(exit_code::bad_input, settled.error().message);
    if (*settled && say) say(cost_text(**settled));
    name_originals(*loaded, found->originals);
    if (found->unpacked) name_unpacked_files(*loaded, found->unpacked->path(), found->name);
    if (const Status fits = check_alerts(arguments.alerts, loaded->spec); !fits) {
        return fail(exit_code::bad_input, fits.error().message);
    }
    for (const std::string& address : arguments.tiles) {
        if (const Status right = serve::check_tile_address(address); !right)
            return fail(exit_code::bad_input, "--tiles " + right.error().message);
    }
    auto alerts = read_alerts(arguments.alerts, *tokens);
    if (!alerts) return fail(exit_code::bad_input, alerts.error().message);
    if (watch.stop_requested()) return exit_code::success;
    const auto scene = std::make_shared<const scene::Scene>(std::move(*loaded));

    std::mutex mutex;  // guards failure, which another thread writes
    std::string failure;
    serve::ServerOptions options;
    options.host = arguments.host;
    options.port = static_cast<std::uint16_t>(arguments.port);
    options.allowed_hosts = arguments.allowed_hosts;
    options.tokens = std::move(*tokens);
    options.export_folder = folder.path();
    options.scenario.overrides = *overrides;
    options.scenario.fault_folder = "talus_out";
    options.run = arguments.run;
    options.tiles = arguments.tiles;
    options.ensembles.assign(arguments.ensembles.begin(), arguments.ensembles.end());
    options.calibration.source = {file, *overrides};
    options.calibration.own_files = found->unpacked != nullptr;
    options.calibration.scene_name = arguments.scene.empty() ? std::string("built-in") : found->name;
    options.calibration.keep = !arguments.calibrations.empty();
    options.calibration.folder = options.calibration.keep ? fs::path(arguments.calibrations) : folder.path();
    if (options.calibration.keep) {
        std::error_code error;
        fs::create_directories(options.calibration.folder, error);
        if (error) {
            return fail(exit_code::bad_input,
                        fmt::format("--calibrations {}: cannot be made: {}", arguments.calibrations, error.message()));
        }
    }
    options.alerts = std::move(*alerts);
    options.alerts.log = say;
    options.on_failure = [&](const std::string& message) {
        {
            const std::lock_guard lock(mutex);
            failure = message;
        }
        watch.request_stop();
    };
    auto server = serve::Server::listen(std::move(options));
    if (!server) return fail(exit_code::failure, server.error().message);
    if (const Status serving = (*server)->serve(scene); !serving)
        return fail(exit_code::bad_input, serving.error().message);
    // Nobody could open a session whose links are lost.
    if (const int printed = print_links(arguments, *scene, **server); printed != exit_code::success) return printed;
    watch.wait();
    server->reset();

    const std::lock_guard lock(mutex);
    if (!failure.empty()) return fail(exit_code::failure, "the simulation cannot continue: " + failure);
    return exit_code::success;
}

}  // namespace

Result<serve::Tokens> choose_tokens(const std::vector<std::string>& given) {
    if (given.size() > 2) return Error{"--token is given more than twice; it is for controllers, then for viewers"};
    serve::Tokens tokens;
    std::string* const wanted[] = {&tokens.controller, &tokens.viewer};
    for (std::size_t i = 0; i < 2; ++i) {
        TALUS_ASSIGN(auto token, i < given.size() ? Result<std::string>(given[i]) : serve::random_token());
        *wanted[i] = std::move(token);
    }
    if (Status good = serve::check_tokens(tokens); !good) return Error{"--token: " + good.error().message};
    return tokens;
}

void add_serve(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("serve", "open a scene live in the browser: watch, control and share it");
    const auto serve = std::make_shared<ServeArguments>();
    app->add_option("scene", serve->scene, "scene file; default: the built-in scene")->type_name("SCENE");
    app->add_option("--port", serve->port, "port to listen on; default: 8123; 0: any free port")
        ->type_name("N")
        ->check(CLI::Range(0, 65535));
    app->add_option("--host", serve->host, "address to listen on; default: 127.0.0.1, this computer only; 0.0.0.0: all")
        ->type_name("ADDRESS");
    app->add_option("--allow-host", serve->allowed_hosts,
                    "a host name under which browsers reach this server; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app->add_option("--token", serve->tokens,
                    "token of the links, once for controllers, again for viewers; default: new tokens each time")
        ->type_name("TOKEN")
        ->allow_extra_args(false);
    app->add_option("--calibrations", serve->calibrations,
                    "folder that keeps the runs and the report of calibrations started in the page; default: deleted "
                    "when the program ends")
        ->type_name("DIR");
    app->add_option("--ensemble", serve->ensembles,
                    "folder of a finished talus ensemble of this scene, whose maps the page shows; may be repeated")
        ->type_name("DIR")
        ->allow_extra_args(false);
    app->add_option(
           "--tiles", serve->tiles,
           "address of map tiles, with {z}, {x} and {y}, that the page offers as a background; may be repeated. "
           "Off until somebody switches it on; then each browser loads them from there, not this program")
        ->type_name("URL")
        ->allow_extra_args(false);
    app->add_flag("--run", serve->run, "start running instead of paused at time 0");
    app->add_option("--threads", serve->threads, "number of threads; default: all cores; does not affect the result")
        ->type_name("N");
    add_overrides(*app, serve->overrides);
    add_backend(*app, serve->overrides);
    add_layers(*app, serve->layers, true);
    add_data_folder(*app, serve->data);
    add_alerts(*app, serve->alerts);
    CLI::Option* quiet = app->add_flag("--quiet", serve->quiet, "print only errors");
    app->add_flag("--json", serve->json, "print the links as one JSON object on stdout")->excludes(quiet);
    app->footer(serve_help);
    commands.push_back({app, [serve] { return serve_command(*serve); }});
}

}  // namespace talus::cli
