#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <signal.h>
#include <sstream>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command.hpp"
#include "exit_code.hpp"
#include "geo/foreign.hpp"
#include "sim/backend_choice.hpp"
#include "simd/dispatch.hpp"
#include "start.hpp"

namespace talus::cli {
namespace {

constexpr const char* program_help = R"(
Examples:
  talus                                     at a desktop: the start page in the browser
  talus run                                 the built-in scene, into talus_out/sham_tseng
  talus run my_scene.toml -o result         your scene, into the folder result
  talus run my_scene.toml --set material.friction_coefficient=0.3
  talus run my_scene.toml --layers 4        debris four particles thick; says what it costs before it starts
  talus run my_scene.toml --convergence     check convergence: four runs, about nine times as long
  talus run my_scene.toml --vary material.friction_coefficient=0.3,0.5 --vary solver.target_particle_count=3000
                                            sensitivity to inputs: a run per value, one at a time
  talus compare my_scene.toml               a second opinion: particles beside the depth-averaged model
  talus scene new --dem dem.tif --release scar.geojson --thickness-m 1.5 -o my_scene
                                            a commented scene from your own terrain, ready to run
  talus scene check my_scene/scene.toml     reads and checks a scene without running it
  talus bundle my_scene/scene.toml -o my_scene.zip
                                            the scene with its files in one archive; talus run takes that too
  talus replay session.json                 repeats a saved live session and compares its result
  talus publish my_scene.toml -o twin.html --without-engine
                                            the run in one page, for anybody with a browser
  talus validate --quick                    computes cases with known results, and prints one table
  talus serve                               the built-in scene live in the browser: watch, control and share it
  talus calibrate my_scene.toml --vary material.friction_coefficient=0.1:0.6
                                            which friction explains the field observations, with its uncertainty
  talus bench                               speed of talus on this machine: milliseconds per stage, particles per second

Exit codes:
    0  complete
    1  the machine failed: disk full, out of memory. A reader of what is printed that ends early, such as head, is
       no failure
    2  bad input: command line, scene or a file it names; nothing was written
    3  a step could not be trusted (fault); the results so far are written, marked partial
    4  talus validate: a case failed
  130  interrupted by Ctrl-C; the results so far are written, marked partial.
       A second Ctrl-C ends at once and writes nothing. With --convergence or --vary, missing runs are listed.)";

/// The command at which the error occurred: its --help is the relevant one.
std::string deepest_command(const CLI::App& app) {
    std::string name = app.get_name();
    const CLI::App* command = &app;
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
        name += " " + command->get_name();
    }
    return name;
}

/// A misspelt variable would be ignored in silence.
Status check_environment() {
    constexpr std::array<std::string_view, 2> known = {"TALUS_DATA", "TALUS_SIMD"};
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string_view variable = *entry;
        const std::string_view name = variable.substr(0, variable.find('='));
        if (!name.starts_with("TALUS_") || std::find(known.begin(), known.end(), name) != known.end()) continue;
        return Error{fmt::format("environment variable {} is unknown; talus reads {}", name, fmt::join(known, ", "))};
    }
    return simd::choose_instruction_set_of_environment();
}

std::string version_text() {
    const std::vector<std::string> sets = simd::instruction_sets();
    const char* chosen = std::getenv("TALUS_SIMD");
    return fmt::format("talus {}\ncommit {}\ninstruction set {}, of {}\nbackends {}", TALUS_VERSION, TALUS_COMMIT,
                       chosen != nullptr && *chosen != 0 ? chosen : sets.front(), fmt::join(sets, ", "),
                       sim::describe_backends());
}

int talus_main(int argc, char** argv) {
    CLI::App app("talus simulates landslides and debris flows on a terrain model, and writes hazard maps and a report.",
                 "talus");
    app.set_version_flag("-V,--version", version_text, "Print version, commit, instruction set and backends");
    app.require_subcommand(0, 1);

    std::vector<Command> commands;
    for (const auto add : {add_start, add_run, add_compare, add_serve, add_replay, add_publish, add_scene, add_bundle,
                           add_validate, add_ensemble, add_calibrate, add_design, add_risk, add_bench, add_manual}) {
        add(app, commands);
    }
    app.footer(program_help);  // last: commands made after it would inherit it

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help_or_version) {
        std::ostringstream text;
        (void)app.exit(help_or_version, text);
        return print_result(text.str());
    } catch (const CLI::ParseError& error) {
        return fail(exit_code::bad_input, fmt::format("{}; see {} --help", error.what(), deepest_command(app)));
    }

    if (const Status checked = check_environment(); !checked) {
        return fail(exit_code::bad_input, checked.error().message);
    }
    for (const Command& command : commands) {
        if (*command.app) return command.run();
    }
    // Scripts, and terminals without a display, read what there is.
    return at_a_desktop() ? start_page() : print_result(app.help());
}

}  // namespace
}  // namespace talus::cli

int main(int argc, char** argv) {
    // A closed pipe and a file size limit are errors to report; they must not terminate the program.
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    talus::geo::read_foreign(argc, argv);  // the part of a child process of this program
    try {
        return talus::cli::talus_main(argc, argv);
    } catch (const std::bad_alloc&) {
        return talus::cli::fail(talus::cli::exit_code::failure,
                                "out of memory; set a larger solver.particle_spacing_m or a smaller terrain.extent");
    } catch (const std::exception& error) {
        return talus::cli::fail(talus::cli::exit_code::failure, std::string("ended unexpectedly: ") + error.what());
    }
}
