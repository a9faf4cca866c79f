#include "publish.hpp"

#include <cstdio>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "exit_code.hpp"
#include "layers.hpp"
#include "products/products.hpp"
#include "products/text_file.hpp"
#include "scene/builtin.hpp"
#include "scene_input.hpp"
#include "serve/library.hpp"
#include "throttled_progress.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* publish_help = R"(
Writes one page that opens from disk in a browser, with the scene, the recorded run, its charts, maps, tables and report.
It needs no program, no server and no network, and sends nothing: attach it to a mail, or put it on any web server.
What it contains is printed before it is written: check that you may pass the scene's data on.

  talus publish my_scene.toml -o twin.html          runs the scene, and publishes the run with the engine: a reader
                                                    can change values, draw barriers and run it again
  talus publish my_scene.toml -o twin.html --without-engine
                                                    a recording alone
  talus publish session.json -o twin.html           the runs of a saved live session, side by side
  talus publish talus_out/my_scene -o twin.html     a result of talus run: the run is computed again, to the same hash
  talus publish my_scene.toml -o site --folder      a folder for a web server

A run has as many frames as 4 MB take, 0.72 MB beside an engine, most of them while debris moves; the page draws the way
between two of them. --interval takes a fixed distance.

Exit codes:
    0  written
    1  the machine failed: disk full, out of memory
    2  bad input: command line, scene or a file it names; nothing was written
  130  interrupted by Ctrl-C; nothing was written
)";

struct PublishArguments {
    std::string source;  ///< a scene, a result folder or a saved session; empty: the built-in scene
    std::string output, data, layers;
    std::vector<std::string> overrides;
    std::optional<int> threads;
    PublishOptions options;
    bool no_files = false, force = false, quiet = false, json = false;
};

/// What is published, loaded.
struct Source {
    SceneFile file;
    serve::ToPublish wanted;
    std::string hash;  ///< that the run must have; empty: any
};

std::string scene_of(const json& manifest) {
    const auto found = manifest.find("scene_file");
    return found != manifest.end() && found->is_string() ? found->get<std::string>() : "";
}

/// The scene of a result folder, and the hash of its run.
Result<std::pair<std::string, std::string>> read_result(const fs::path& folder) {
    const fs::path file = folder / "manifest.json";
    constexpr std::uintmax_t longest = 64'000'000;
    TALUS_ASSIGN(const std::string text, serve::read_whole(file, longest));
    const json manifest = json::parse(text, nullptr, false);
    if (!manifest.is_object() || scene_of(manifest).empty()) {
        return Error{fmt::format("{}: no manifest of talus run: scene_file is missing", file.string())};
    }
    std::string scene = scene_of(manifest);
    // Of a bundle and of the built-in scene the manifest names the file in it.
    return std::pair{std::move(scene), manifest.value("result_hash", "")};
}

Result<Source> load_session(const PublishArguments& arguments, const serve::SayShare& say, InterruptWatch& watch) {
    TALUS_ASSIGN(const std::string text, serve::read_whole(arguments.source, serve::Library::longest_session));
    auto session = serve::read_session(text);
    if (!session) return Error{fmt::format("{}: {}", arguments.source, session.error().message)};
    if (!arguments.overrides.empty() || !arguments.layers.empty()) {
        return Error{
            fmt::format("--set and --layers are refused beside {}: a session has its own values", arguments.source)};
    }
    Source source;
    source.wanted.overrides = session->scenarios.front().journal.overrides;
    TALUS_ASSIGN(source.file, find_scene(session->scenarios.front().journal.scene_file, watch));
    TALUS_TRY(scene::check_saved_overrides(source.file.file, source.wanted.overrides));
    TALUS_ASSIGN(auto scene, scene::load_scene(source.file.file, source.wanted.overrides));
    leave_out_zoom(scene, "a published twin");
    name_originals(scene, source.file.originals);
    if (source.file.unpacked) name_unpacked_files(scene, source.file.unpacked->path(), source.file.name);
    source.wanted.scene = std::make_shared<const scene::Scene>(std::move(scene));
    std::vector<std::string> notes;
    TALUS_ASSIGN(source.wanted.scenarios, serve::replay_session(*session, source.wanted.scene, say, notes));
    for (const std::string& sentence : notes) note(sentence);
    source.wanted.overlays = std::move(session->overlays);
    return Result<Source>(std::move(source));
}

Result<Source> load_scene_or_result(const PublishArguments& arguments, InterruptWatch& watch) {
    Source source;
    std::string scene_name = arguments.source;
    std::error_code error;
    if (fs::is_directory(scene_name, error)) {
        TALUS_ASSIGN(auto result, read_result(scene_name));
        scene_name = std::move(result.first);
        source.hash = std::move(result.second);
    }
    std::vector<std::string> overrides = arguments.overrides;
    if (arguments.threads) overrides.push_back(fmt::format("solver.thread_count={}", *arguments.threads));
    TALUS_ASSIGN(auto input, open_scene(scene_name, overrides, arguments.layers, watch));
    leave_out_zoom(input.scene, "a published twin");
    if (input.scene.spec.solver.model == params::ModelChoice::depth_averaged) {
        return Error{
            "solver.model = \"depth_averaged\": a published run has particles; add --set solver.model=particles"};
    }
    if (input.unpacked) name_unpacked_files(input.scene, input.unpacked->path(), input.name);
    source.wanted.overrides = input.source.overrides;
    source.wanted.scene = std::make_shared<const scene::Scene>(std::move(input.scene));
    source.file = std::move(static_cast<SceneFile&>(input));
    return Result<Source>(std::move(source));
}

/// The folder to write into, or none for one file. Errors: what is there may not be replaced.
Result<std::optional<products::OutputFolder>> prepare_output(const PublishArguments& arguments) {
    using Folder = std::optional<products::OutputFolder>;
    if (arguments.options.folder) {
        TALUS_ASSIGN(auto made, products::OutputFolder::create(arguments.output, arguments.force));
        return Result<Folder>(Folder(std::move(made)));
    }
    std::error_code error;
    const fs::path output = arguments.output;
    if (output.extension() != ".html") {
        return Error{
            fmt::format("{}: the name of a published twin ends in .html; for a folder add --folder", arguments.output)};
    }
    if (!arguments.force && fs::exists(fs::symlink_status(output, error))) {
        return Error{
            fmt::format("{}: already exists; name another file, or replace it with --force", arguments.output)};
    }
    TALUS_TRY(check_output_file(arguments.output));
    return Result<Folder>(Folder());
}

Status write(const PublishArguments& arguments, const Twin& twin, std::optional<products::OutputFolder>& folder) {
    if (!folder) return products::replace_text_file(arguments.output, twin.files.front().bytes);
    for (const publish::File& file : twin.files) {
        TALUS_TRY(products::write_text_file(folder->path() / file.name, file.bytes));
    }
    return folder->commit();
}

int publish_command(PublishArguments arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    if (const Status fits = check_publish(arguments.options); !fits)
        return fail(exit_code::bad_input, fits.error().message);
    auto output = prepare_output(arguments);
    if (!output) return fail(exit_code::bad_input, output.error().message);
    if (*output) watch.remove_at_once((*output)->path());
    arguments.options.recording.files = !arguments.no_files;
    ThrottledProgress progress(arguments.quiet, arguments.json);
    const serve::SayShare say = [&](const std::string& what, double share) {
        progress.report([&] { return fmt::format("{:3.0f} %  {}", 100 * share, what); },
                        [&] {
                            return json{{"event", "progress"}, {"what", what}, {"share_done", share}}.dump();
                        });
        return !watch.stop_requested();
    };
    TemporaryFolder folder;
    if (folder.path().empty()) return fail(exit_code::failure, "cannot make a temporary folder; set TMPDIR");
    watch.remove_at_once(folder.path());
    const bool session = arguments.source.ends_with(".json");
    auto source = session ? load_session(arguments, say, watch) : load_scene_or_result(arguments, watch);
    progress.clear();
    if (watch.stop_requested()) return fail(exit_code::interrupted, "interrupted; nothing was written");
    if (!source) return fail(exit_code::bad_input, source.error().message);
    source->wanted.folder = folder.path();
    const auto twin = make_twin(std::move(source->wanted), arguments.options, say);
    progress.clear();
    if (watch.stop_requested()) return fail(exit_code::interrupted, "interrupted; nothing was written");
    if (!twin) return fail(exit_code::bad_input, twin.error().message);
    if (!source->hash.empty() && source->hash != twin->hash) {
        return fail(exit_code::bad_input,
                    fmt::format("{}: computed again, the run has the hash {}, the result has {}: its scene has changed "
                                "since, or it was run with other values; give them with --set, or publish its scene",
                                arguments.source, twin->hash, source->hash));
    }
    if (!arguments.quiet && !arguments.json && !print(twin->contents)) return exit_code::failure;
    if (const Status written = write(arguments, *twin, *output); !written)
        return fail(exit_code::failure, written.error().message);
    if (arguments.quiet) return exit_code::success;
    if (arguments.json) {
        return print_result(
            json{{"event", "published"}, {"file", arguments.output}, {"bytes", twin->bytes}, {"hash", twin->hash}}
                .dump() +
            "\n");
    }
    return print_result(fmt::format(
        "wrote {}: open it in a browser, or pass it on; it needs no program and no network\n", arguments.output));
}

}  // namespace

Status check_publish(const PublishOptions& options) {
    TALUS_TRY(serve::published_page());
    if (options.without_engine || serve::carries_engine()) return {};
    return Error{
        "this program was built without the engine for browsers; publish the recorded run alone with --without-engine"};
}

Result<Twin> make_twin(serve::ToPublish wanted, const PublishOptions& options, const serve::SayShare& say) {
    wanted.recording = options.recording;
    wanted.engine = !options.without_engine;
    TALUS_ASSIGN(const serve::Published made, serve::publish(std::move(wanted), say));
    Twin twin;
    if (options.folder)
        twin.files = publish::folder(made.page, made.content);
    else
        twin.files = {{"", publish::one_file(made.page, made.content)}};
    for (const publish::File& file : twin.files) twin.bytes += file.bytes.size();
    twin.contents = made.content.title + "\n";
    for (const std::string& line : made.contents) twin.contents += "  " + line + "\n";
    twin.contents +=
        fmt::format("  engine: {}\n  size: {:.1f} MB\n",
                    made.content.engine ? "with it: a reader can change the run" : "none, a recording alone",
                    static_cast<double>(twin.bytes) / 1e6);
    twin.hash = made.hash;
    return twin;
}

void add_publish(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app =
        program.add_subcommand("publish", "write a twin as one page that opens without program, server or network");
    const auto publish = std::make_shared<PublishArguments>();
    app->add_option("source", publish->source,
                    "scene file, result folder of talus run, or saved session; default: the built-in scene")
        ->type_name("SCENE|RESULT|SESSION");
    app->add_option("-o,--output", publish->output, "page to write, or with --folder the folder")
        ->required()
        ->type_name("FILE.html");
    app->add_flag("--folder", publish->options.folder, "write a folder for a web server in place of one file");
    app->add_flag("--without-engine", publish->options.without_engine,
                  "publish the recorded run alone: nothing can be changed in the page");
    app->add_option(
           "--interval", publish->options.recording.frame_interval,
           "s between frames; default: as many as 4 MB take (0.72 MB beside an engine), most while debris moves")
        ->type_name("S")
        ->check(CLI::Range(0.1, 3600.0));
    app->add_flag("--no-files", publish->no_files, "leave out report, tables and maps as files to download");
    app->add_flag("--force", publish->force, "replace the output if it exists");
    app->add_option("--threads", publish->threads, "number of threads; default: all cores; does not affect the result")
        ->type_name("N");
    add_overrides(*app, publish->overrides);
    add_layers(*app, publish->layers, false);
    add_data_folder(*app, publish->data);
    CLI::Option* quiet = app->add_flag("--quiet", publish->quiet, "print only errors");
    app->add_flag("--json", publish->json, "progress and result as one JSON object per line on stdout")
        ->excludes(quiet);
    app->footer(publish_help);
    commands.push_back({app, [publish] { return publish_command(*publish); }});
}

}  // namespace talus::cli
