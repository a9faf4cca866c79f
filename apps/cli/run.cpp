#include "run/run.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "command.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "params/scene_text.hpp"
#include "products/particle_series.hpp"
#include "products/products.hpp"
#include "progress.hpp"
#include "scene/builtin.hpp"
#include "scene/scene.hpp"
#include "summary.hpp"
#include "temporary_folder.hpp"
#include "variant_plan.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

constexpr const char* run_help = R"(
Every value of the scene can be set with --set section.key=value. The result folder holds maps (GeoTIFF with QGIS
styles), front.csv, timeseries.csv, buildings.csv, results.gpkg, manifest.json and report.html.

--convergence and --vary compare front velocity at every observation, arrival (first building hit; where none is, the
front at 90 % of its way) and run-out with the scene as given: on the terminal, in convergence.csv and variants.csv, in
the report, the manifest and --json. --convergence passes where nothing changes by more than 5 %.
)";

/// talus_out in the current folder, made when needed and removed again if nothing came to lie in it.
class DefaultParent {
  public:
    DefaultParent() : made_(fs::create_directory(name, error_)) {}
    ~DefaultParent() {
        std::error_code not_empty;
        if (made_) fs::remove(name, not_empty);
    }
    DefaultParent(const DefaultParent&) = delete;
    DefaultParent& operator=(const DefaultParent&) = delete;

    static constexpr const char* name = "talus_out";

  private:
    std::error_code error_;  // not asked: the output folder says it better when it cannot be made
    bool made_;
};

/// The folder's name for a file called scene.toml, the file's name without its ending for another.
std::string scene_name(const fs::path& file) {
    const std::string stem = file.stem().string();
    const std::string folder = fs::absolute(file).parent_path().filename().string();
    return stem == "scene" && !folder.empty() ? folder : stem;
}

void print(const std::string& text) {
    (void)std::fputs(text.c_str(), stdout);
    (void)std::fflush(stdout);
}

/// `shown`: the output folder as the user wrote it.
int run_loaded(const RunArguments& arguments, const Scene& scene, VariantPlan& plan, OutputFolder& output,
               const fs::path& shown, InterruptWatch& watch) {
    ProgressReporter progress(progress_style(arguments.quiet, arguments.json));
    Status series_status;
    std::optional<ParticleSeries> series;
    RunOptions options;
    bool notes_said = arguments.quiet || arguments.json;
    options.on_progress = [&](const Progress& now) {
        // Not before: an input that cannot be run is refused with one line alone.
        if (!std::exchange(notes_said, true)) {
            for (const std::string& note : scene.notes) print(fmt::format("note: {}\n", note));
        }
        plan.report_base(progress, now);
    };
    options.stop_requested = &watch.stop_requested();
    if (scene.spec.outputs.particle_series_interval > 0) {
        series.emplace(output.path() / "particles");
        options.on_frame = [&](const Model& model, const State& state) {
            if (series_status) series_status = series->write_frame(model, state);
            if (!series_status) watch.request_stop();
        };
    }

    auto result = run_scene(scene, options);
    progress.clear();
    if (!result) return fail(exit_code::bad_input, result.error().message);
    if (series && series_status) series_status = series->finish();
    if (!series_status) return fail(exit_code::failure, series_status.error().message);

    const auto comparisons = plan.run(scene, *result, progress, watch.stop_requested());
    const bool interrupted = result->status == RunStatus::interrupted ||
                             (watch.stop_requested() && !std::all_of(comparisons.begin(), comparisons.end(),
                                                                     [](const Comparison& c) { return c.all_ran(); }));
    progress.say(interrupted ? "interrupted: writing what there is" : "writing maps, tables and report");
    Status written = write_products(scene, *result, output.path(), comparisons);
    if (written) {
        // Replacing an earlier result takes two renames; a second Ctrl-C must not fall between them.
        const auto lock = watch.hold();
        written = output.commit();
    }
    progress.clear();
    if (!written) return fail(exit_code::failure, written.error().message);

    if (arguments.json) {
        print(summary_json(scene, *result, comparisons, output.final_path()) + "\n");
    } else if (!arguments.quiet) {
        print(summary_text(scene, *result, comparisons, shown));
    }
    if (result->status != RunStatus::fault) return interrupted ? exit_code::interrupted : exit_code::success;
    return fail(exit_code::fault, fmt::format("{}; what was computed until then is in {}, marked partial",
                                              result->stop_reason, shown.string()));
}

int run_command(const RunArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;

    std::optional<TemporaryFolder> unpacked;
    fs::path file = arguments.scene;
    std::string name;
    if (arguments.scene.empty()) {
        unpacked.emplace();
        if (unpacked->path().empty()) {
            return fail(exit_code::failure, "cannot make a temporary folder for the built-in scene; set TMPDIR");
        }
        watch.remove_at_once(unpacked->path());
        auto scene_file = unpack_builtin_scene(unpacked->path());
        if (!scene_file) return fail(exit_code::failure, scene_file.error().message);
        file = *scene_file;
        name = builtin_scene_name;
    } else {
        name = scene_name(file);
    }

    std::vector<std::string> overrides = arguments.overrides;
    if (arguments.threads) overrides.push_back(fmt::format("solver.thread_count={}", *arguments.threads));
    const SceneSource source{file, overrides};
    auto scene = load_scene(source.file, source.overrides);
    if (!scene) return fail(exit_code::bad_input, scene.error().message);
    auto plan = VariantPlan::make(arguments, source, *scene);
    if (!plan) return fail(exit_code::bad_input, plan.error().message);
    if (unpacked) name_builtin_files(*scene, unpacked->path());
    if (watch.stop_requested()) return fail(exit_code::interrupted, "interrupted before the run began");

    std::optional<DefaultParent> parent;
    if (arguments.output.empty()) parent.emplace();
    const fs::path folder = parent ? fs::path(DefaultParent::name) / name : fs::path(arguments.output);
    auto output = OutputFolder::create(folder, arguments.force);
    if (!output) return fail(exit_code::bad_input, output.error().message);
    watch.remove_at_once(output->path());

    return run_loaded(arguments, *scene, *plan, *output, folder, watch);
}

}  // namespace

void add_run(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("run", "run a scene and write maps, tables and a report");
    const auto run = std::make_shared<RunArguments>();
    app->add_option("scene", run->scene, "scene file; default: the built-in scene")->type_name("SCENE");
    app->add_option("-o,--output", run->output, "result folder; default: talus_out/<scene name>")->type_name("DIR");
    app->add_flag("--force", run->force, "replace the result folder if it is already there");
    app->add_option("--threads", run->threads, "number of threads; default: all cores; the result is the same")
        ->type_name("N");
    add_overrides(*app, run->overrides);
    app->add_flag("--convergence", run->convergence,
                  "run again with half the time step, double the iterations, three times the particles; compare");
    app->add_option("--vary", run->variations, "run again with each of the values; compare; may be given many times")
        ->type_name("SECTION.KEY=VALUE,VALUE")
        ->allow_extra_args(false);
    add_data_folder(*app, run->data);
    CLI::Option* quiet = app->add_flag("--quiet", run->quiet, "print nothing but errors");
    app->add_flag("--json", run->json, "progress and result as one JSON object per line on stdout")->excludes(quiet);
    app->footer([] { return run_help + scene_reference_text(); });
    commands.push_back({app, [run] { return run_command(*run); }});
}

}  // namespace talus
