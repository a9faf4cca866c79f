#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "command.hpp"
#include "core/input_file.hpp"
#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "scene/builtin.hpp"
#include "scene/bundle.hpp"
#include "scene/scene.hpp"
#include "scene_input.hpp"
#include "twin/journal.hpp"

namespace talus::cli {
namespace {

struct ReplayArguments {
    std::string journal;
    std::string scene;  ///< instead of the journal's; empty: that of the journal
    std::optional<int> threads;
    std::string data;
    bool quiet = false;
};

constexpr const char* replay_help = R"(
A live session saves its journal from the page's menu or with GET /api/scenarios/A/journal: the scene, and all actions
with the step before which they took effect. The same actions at the same steps give a bit-identical result on any
number of threads. The scene may be packed in a bundle (talus bundle).

Exit codes:
    0  the result is the same: the hash of the last step equals that of the session
    1  the machine failed: out of memory
    2  bad input: the journal, its scene or a file it names
    3  the result differs
  130  interrupted by Ctrl-C
)";

Result<std::string> read_file(const std::string& path) {
    TALUS_TRY(check_input_file(path));
    std::ifstream file(path, std::ios::binary);
    if (!file) return Error{fmt::format("{}: cannot be opened", path)};
    std::string text{std::istreambuf_iterator<char>(file), {}};
    if (file.bad() || text.empty()) return Error{fmt::format("{}: cannot be read", path)};
    return text;
}

/// The scene that a journal names, or the one that the user names instead.
Result<scene::Scene> load_scene_of(const ReplayArguments& arguments, const twin::Journal& journal,
                                   InterruptWatch& watch) {
    std::vector<std::string> overrides = journal.overrides;
    if (arguments.threads) overrides.push_back(fmt::format("solver.thread_count={}", *arguments.threads));
    const std::string file = arguments.scene.empty() ? journal.scene_file : arguments.scene;
    TALUS_ASSIGN(const SceneFile found, find_scene(file, watch));
    TALUS_TRY(scene::check_saved_overrides(found.file, journal.overrides));
    TALUS_ASSIGN(scene::Scene scene, scene::load_scene(found.file, overrides));
    name_originals(scene, found.originals);
    if (found.unpacked) name_unpacked_files(scene, found.unpacked->path(), found.name);
    return scene;
}

int replay_command(const ReplayArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    const auto text = read_file(arguments.journal);
    if (!text) return fail(exit_code::bad_input, text.error().message);
    auto journal = twin::read_journal(*text);
    if (!journal) return fail(exit_code::bad_input, arguments.journal + ": " + journal.error().message);
    auto scene = load_scene_of(arguments, *journal, watch);
    if (!scene) {
        return fail(exit_code::bad_input,
                    scene.error().message + " (the scene of this journal; give its present path with --scene)");
    }
    // The scene file of a bundle has other paths in it than the one that was packed.
    if (scene::is_bundle(arguments.scene)) {
        std::erase_if(journal->inputs, [](const scene::InputFile& input) { return input.role == "scene"; });
    }
    for (const std::string& sentence : twin::changed_inputs(*journal, *scene)) note(sentence);

    const bool shows = !arguments.quiet && isatty(STDERR_FILENO) != 0;
    const auto replayed =
        twin::replay(*journal, std::make_shared<const scene::Scene>(*std::move(scene)), [&](std::uint64_t step) {
            if (shows && step % 50 == 0) {
                (void)std::fprintf(stderr, "\rstep %llu of %llu", static_cast<unsigned long long>(step),
                                   static_cast<unsigned long long>(journal->steps));
            }
            return !watch.stop_requested();
        });
    if (shows) (void)std::fputs("\r\033[K", stderr);
    if (!replayed) return fail(exit_code::bad_input, arguments.journal + ": " + replayed.error().message);
    if (watch.stop_requested()) return fail(exit_code::interrupted, "interrupted before the end of the journal");
    if (replayed->hash != journal->hash) {
        return fail(
            exit_code::fault,
            fmt::format("{}: the result differs: hash {} after step {}, the session had {}; a scene, a program "
                        "or an instruction set that differs is the usual reason (the session ran on {})",
                        arguments.journal, replayed->hash, replayed->steps, journal->hash, journal->instruction_set));
    }
    if (arguments.quiet) return exit_code::success;
    return print_result(fmt::format("the same result: {} actions, step {}, t = {:.4g} s, hash {}\n",
                                    journal->entries.size(), replayed->steps, replayed->time, replayed->hash));
}

}  // namespace

void add_replay(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("replay", "repeat the journal of a live session and compare the result");
    const auto replay = std::make_shared<ReplayArguments>();
    app->add_option("journal", replay->journal, "journal of a session")->required()->type_name("JOURNAL");
    app->add_option("--scene", replay->scene, "scene file; default: the one that the journal names")
        ->type_name("SCENE");
    app->add_option("--threads", replay->threads, "number of threads; default: as in the scene")
        ->type_name("N")
        ->check(CLI::Range(1, 512));
    add_data_folder(*app, replay->data);
    app->add_flag("--quiet", replay->quiet, "print only errors and differences");
    app->footer(replay_help);
    commands.push_back({app, [replay] { return replay_command(*replay); }});
}

}  // namespace talus::cli
