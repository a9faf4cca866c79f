#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command.hpp"
#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "exit_code.hpp"
#include "extras.hpp"
#include "interrupt.hpp"
#include "layers.hpp"
#include "params/contours.hpp"
#include "params/fields.hpp"
#include "params/scene_text.hpp"
#include "products/products.hpp"
#include "products/text_file.hpp"
#include "progress.hpp"
#include "publish.hpp"
#include "run/run_scene.hpp"
#include "scene/builtin.hpp"
#include "scene/scene.hpp"
#include "scene_input.hpp"
#include "state_file.hpp"
#include "summary.hpp"
#include "variant_plan.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* run_help = R"(
Every value of the scene can be set with --set section.key=value. The result folder holds maps (GeoTIFF with QGIS
styles), front.csv, timeseries.csv, buildings.csv, results.gpkg, results.qlr (opens all layers in QGIS), results.kml, results.json,
manifest.json and report.html; with --publish also twin.html (talus publish --help).

--layers N chooses the particle spacing from the thickness of the debris, and says what it costs before it starts;
--layers real-time takes the most layers that this machine runs in real time, and says how to repeat that elsewhere.

--convergence, --vary and --variants compare with the scene as given: front velocity at every observation, arrival (first
building hit; if there is none, the front at 90 % of its chainage), run-out, deposit area and depth, which buildings are
hit, force and impact pressure on each; on the terminal, in convergence.csv and variants.csv, in the report, the manifest
and --json. --convergence passes if none changes by more than its limit: 5 % of velocity, arrival and run-out, 10 % of
the deposit, 15 % of force and pressure, and the same buildings.

--zoom NAME runs the event with the depth-averaged model, and with particles only what comes near a building or barrier:
what crosses a rectangle --zoom-margin metres around it becomes inflow there. --zoom-polygon FILE takes another area. The
section [zoom] of a scene is the same, and has the spacing of its particles. What leaves the area is not fed back.

--save-state FILE saves the state of the debris at the end, FILE@TIME after the step that reaches TIME seconds.
--from-state FILE starts from it: the results are those of the run that was not interrupted, to the bit. The scene must be
the same but for solver.end_time_s, so that a longer one continues a run.
)";

/// Everything that is checked before a run: the scene, its variants, the output folder.
struct Job {
    SceneInput input;
    VariantPlan plan;
    fs::path shown;  ///< the output folder as the user wrote it
    products::OutputFolder output;
    std::optional<SavedState> save = {};  ///< --save-state
    std::string start_from = {};          ///< the state of --from-state; empty: none
};

/// What the options of a zoom set.
std::vector<std::string> zoom_overrides(const RunArguments& arguments) {
    const auto text = [](const std::string& value) { return params::toml_text(params::ParameterValue(value)); };
    std::vector<std::string> all;
    if (!arguments.zoom.empty()) all.push_back("zoom.structure=" + text(arguments.zoom));
    if (!arguments.zoom_polygon.empty()) {  // from here, not from the scene's folder
        all.push_back("zoom.polygon_file=" + text(fs::absolute(arguments.zoom_polygon).string()));
    }
    if (arguments.zoom_margin) all.push_back(fmt::format("zoom.margin_m={}", *arguments.zoom_margin));
    return all;
}

/// Errors: options that a zoom cannot be together with.
Status check_zoom_options(const RunArguments& arguments, const scene::Scene& scene) {
    if (!scene.zoom) {
        const bool asked = !arguments.zoom.empty() || !arguments.zoom_polygon.empty();
        if (asked) return Error{"--model depth_averaged is refused beside a zoom, which is of particles"};
        return {};
    }
    if (!arguments.layers.empty()) return Error{"--layers is refused beside a zoom; give zoom.target_layers"};
    if (arguments.convergence) return Error{"--convergence is refused beside a zoom"};
    return {};
}

/// Errors: what cannot be together with a state to start from.
Status check_from_state(const RunArguments& arguments) {
    if (arguments.from_state.empty()) return {};
    const bool others = arguments.convergence || arguments.named_variants || !arguments.variations.empty();
    if (!others) return {};
    return Error{"--from-state is refused beside --convergence, --variants and --vary, whose runs start at 0 s"};
}

/// Errors: what cannot be together with --publish.
Status check_run_publish(const RunArguments& arguments, const scene::Scene& scene) {
    if (!arguments.publish) return {};
    const bool averaged = scene.spec.solver.model == params::ModelChoice::depth_averaged;
    if (scene.zoom || averaged || !arguments.from_state.empty()) {
        return Error{
            "--publish is refused beside a zoom, --from-state and the depth-averaged model: a published run has "
            "particles from time 0"};
    }
    return check_publish({.without_engine = true});
}

Result<Job> open_job(const RunArguments& arguments, ProgressReporter& progress, InterruptWatch& watch) {
    std::vector<std::string> overrides = arguments.overrides;
    if (!arguments.model.empty()) overrides.push_back("solver.model=" + arguments.model);
    if (arguments.threads) overrides.push_back(fmt::format("solver.thread_count={}", *arguments.threads));
    for (const std::string& zoom : zoom_overrides(arguments)) overrides.push_back(zoom);
    if (!arguments.series.empty()) {
        overrides.push_back(fmt::format("outputs.series=[\"{}\"]", fmt::join(arguments.series, "\", \"")));
    }
    if (!arguments.contours.empty()) {
        overrides.push_back(fmt::format("outputs.contours=[\"{}\"]", fmt::join(arguments.contours, "\", \"")));
    }
    if (arguments.tracks) overrides.push_back(fmt::format("outputs.tracks={}", *arguments.tracks));
    TALUS_ASSIGN(auto input, open_scene(arguments.scene, overrides, arguments.layers, watch));
    if (input.scene.spec.solver.model == params::ModelChoice::depth_averaged) {
        const params::BackendChoice backend = input.scene.spec.solver.backend;
        const bool device = backend == params::BackendChoice::cuda || backend == params::BackendChoice::host;
        const char* refused = device                      ? "a backend other than the processor"
                              : !arguments.layers.empty() ? "--layers"
                              : arguments.convergence     ? "--convergence"
                              : arguments.tracks          ? "--tracks"
                                                          : nullptr;
        if (refused != nullptr) {
            return Error{fmt::format(
                "{} is refused; it needs particles, and solver.model = \"depth_averaged\" has none", refused)};
        }
    }

    TALUS_TRY(check_zoom_options(arguments, input.scene));
    TALUS_TRY(check_from_state(arguments));
    TALUS_TRY(check_run_publish(arguments, input.scene));
    std::string start_from;
    if (!arguments.from_state.empty()) {
        TALUS_ASSIGN(start_from, read_state_file(arguments.from_state, input.scene));
    }
    const fs::path shown = arguments.output.empty() ? default_output(input.short_name) : fs::path(arguments.output);
    std::optional<SavedState> save;
    if (!arguments.save_state.empty()) {
        TALUS_ASSIGN(save, read_save_option(arguments.save_state, input.scene, shown));
    }
    TALUS_ASSIGN(auto output, products::OutputFolder::create(shown, arguments.force));
    watch.remove_at_once(output.path());

    std::function<void(const std::string&)> say;
    if (!arguments.quiet) say = [&](const std::string& what) { progress.say(what); };
    TALUS_ASSIGN(const auto settled, settle_layers(input.source.file, input.source.overrides, arguments.layers,
                                                   input.scene, say, watch.stop_requested()));
    TALUS_ASSIGN(auto plan, VariantPlan::make(arguments, input.source, input.scene));
    name_originals(input.scene, input.originals);  // it may have been loaded again
    if (input.unpacked) name_unpacked_files(input.scene, input.unpacked->path(), input.name);
    progress.clear();
    if (settled && arguments.json) (void)print(cost_json(*settled) + "\n");
    if (settled && !arguments.json && !arguments.quiet) (void)std::fputs((cost_text(*settled) + "\n").c_str(), stderr);
    return Job{std::move(input), std::move(plan), shown, std::move(output), std::move(save), std::move(start_from)};
}

/// Progress during the run, and Ctrl-C.
class RunCallbacks {
  public:
    RunCallbacks(const RunArguments& arguments, Job& job, ProgressReporter& progress, InterruptWatch& watch)
        : job_(job), progress_(progress), notes_said_(arguments.quiet || arguments.json) {
        options_.stop_requested = &watch.stop_requested();
        options_.on_progress = [this](const run::Progress& now) { report(now); };
        options_.start_from = job.start_from;
        options_.start_from_file = arguments.from_state;
    }
    RunCallbacks(const RunCallbacks&) = delete;
    RunCallbacks& operator=(const RunCallbacks&) = delete;

    [[nodiscard]] run::RunOptions& options() { return options_; }

  private:
    void report(const run::Progress& now) {
        // Notes are printed only now: an invalid input is refused with a single line.
        if (!std::exchange(notes_said_, true)) {
            (void)print_notes(job_.input.scene.notes);
        }
        job_.plan.report_base(progress_, now);
    }

    Job& job_;
    ProgressReporter& progress_;
    bool notes_said_;
    run::RunOptions options_;
};

/// twin.html beside the report. It failing is no reason to lose the results.
void add_twin(const Job& job, Extras& extras, ProgressReporter& progress, InterruptWatch& watch) {
    TemporaryFolder folder;
    watch.remove_at_once(folder.path());
    progress.say("computing the run again for twin.html");
    const serve::SayShare say = [&](const std::string&, double) { return !watch.stop_requested(); };
    const auto twin = make_twin({.scene = std::make_shared<const scene::Scene>(job.input.scene),
                                 .overrides = job.input.source.overrides,
                                 .folder = folder.path()},
                                {.without_engine = !serve::carries_engine()}, say);
    const Status written = twin ? products::write_text_file(job.output.path() / "twin.html", twin->files.front().bytes)
                                : Status(twin.error());
    if (!written) extras.failures().push_back("twin.html: " + written.error().message);
}

Status write_report(Job& job, const run::RunResult& result, const std::vector<run::Comparison>& comparisons,
                    Extras& extras, InterruptWatch& watch) {
    TALUS_TRY(products::write_products(job.input.scene, result, job.output.path(), comparisons, {},
                                       extras.frame_times(), &extras.failures()));
    // Replacing an earlier result takes two renames; a second Ctrl-C must not fall between them.
    const auto lock = watch.hold();
    return job.output.commit();
}

/// From scene file to report.
int run_command(const RunArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    ProgressReporter progress(progress_style(arguments.quiet, arguments.json));

    auto job = open_job(arguments, progress, watch);  // load
    progress.clear();
    if (!job) return fail(exit_code::bad_input, job.error().message);
    if (watch.stop_requested()) return fail(exit_code::interrupted, "interrupted before the run began");
    const scene::Scene& scene = job->input.scene;

    RunCallbacks callbacks(arguments, *job, progress, watch);
    Extras extras(scene, job->save, job->output.path(), job->output.final_path(),
                  [&](const std::string& what) { progress.say(what); });
    extras.take_part(callbacks.options());
    const auto result = run_scene(scene, callbacks.options());  // run; its observer measures every step
    progress.clear();
    if (!result && watch.stop_requested()) return fail(exit_code::interrupted, result.error().message);
    if (!result) return fail(exit_code::bad_input, result.error().message);
    extras.finish(*result);

    const auto comparisons = job->plan.run(scene, *result, progress, watch.stop_requested());
    const bool interrupted =
        result->status == run::RunStatus::interrupted ||
        (watch.stop_requested() &&
         !std::all_of(comparisons.begin(), comparisons.end(), [](const run::Comparison& c) { return c.all_ran(); }));
    progress.say(interrupted ? "interrupted: writing the results so far" : "writing maps, tables and report");
    take_followed_path(job->input.scene, *result);
    if (arguments.publish && !interrupted) add_twin(*job, extras, progress, watch);
    const Status written = write_report(*job, *result, comparisons, extras, watch);  // report
    progress.clear();
    if (!written) return fail(exit_code::failure, written.error().message);

    std::string summary;
    if (arguments.json) {
        summary = summary_json(scene, *result, comparisons, job->output.final_path()) + "\n";
    } else if (!arguments.quiet) {
        summary = summary_text(scene, *result, comparisons, job->shown);
    }
    const int printed = print_result(summary, interrupted ? exit_code::interrupted : exit_code::success);
    if (!extras.failures().empty()) {
        const auto failed = extras.failures().size();
        const std::string more = failed > 1 ? fmt::format(" (and {} more)", failed - 1) : "";
        return fail(exit_code::failure, fmt::format("{}{}; all other results are in {}", extras.failures().front(),
                                                    more, job->shown.string()));
    }
    if (result->status != run::RunStatus::fault) return printed;
    return fail(exit_code::fault, fmt::format("{}; the results so far are in {}, marked partial", result->stop_reason,
                                              job->shown.string()));
}

}  // namespace

void add_run(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("run", "run a scene and write maps, tables and a report");
    const auto run = std::make_shared<RunArguments>();
    app->add_option("scene", run->scene, "scene file; default: the built-in scene")->type_name("SCENE");
    app->add_option("-o,--output", run->output, "result folder; default: talus_out/<scene name>")->type_name("DIR");
    app->add_flag("--force", run->force, "replace the result folder if it exists");
    app->add_option("--threads", run->threads, "number of threads; default: all cores; does not affect the result")
        ->type_name("N");
    app->add_option("--model", run->model, "particles, or depth_averaged: in seconds, without what happens inside")
        ->type_name("NAME");
    app->add_option("--series", run->series,
                    fmt::format("also write the run over time: {}; separated by commas; frames are "
                                "outputs.series_interval_s apart",
                                fmt::join(params::series_formats, ", ")))
        ->delimiter(',')
        ->type_name("FORMAT,...");
    app->add_option("--contours", run->contours,
                    fmt::format("also write contours of a map at these values, in the unit of its file, into "
                                "results.gpkg; may be repeated; maps: {}",
                                fmt::join(params::contour_maps, ", ")))
        ->type_name("MAP=VALUE,VALUE")
        ->allow_extra_args(false);
    app->add_option("--tracks", run->tracks,
                    "also write the ways of N particles, evenly chosen, at outputs.series_interval_s; default: 200")
        ->type_name("N")
        ->expected(0, 1)
        ->default_str("200");
    app->add_flag(
        "--publish", run->publish,
        "also write twin.html, the run in one page for anybody's browser; computes the run again to record it");
    add_overrides(*app, run->overrides);
    add_backend(*app, run->overrides);
    add_layers(*app, run->layers, true);
    app->add_flag("--convergence", run->convergence,
                  "run again with half the time step, double the iterations, three times the particles; compare");
    app->add_flag("--variants", run->named_variants, "run again as every [[variant]] of the scene; compare")
        ->excludes(app->get_option("--variant"));
    app->add_option("--vary", run->variations, "run again with each of the values; compare; may be repeated")
        ->type_name("SECTION.KEY=VALUE,VALUE")
        ->allow_extra_args(false);
    CLI::Option* zoom =
        app->add_option("--zoom", run->zoom, "particles around one building or barrier, the rest depth-averaged")
            ->type_name("NAME");
    app->add_option("--zoom-polygon", run->zoom_polygon, "the same in the area of a polygon")
        ->type_name("FILE")
        ->excludes(zoom);
    app->add_option("--zoom-margin", run->zoom_margin, "m, from the structure to the boundary of the zoom; default: 15")
        ->type_name("M");
    app->add_option("--save-state", run->save_state, "save the state at the end, or at TIME seconds, to start from")
        ->type_name("FILE[@TIME]");
    app->add_option("--from-state", run->from_state, "start from a saved state of the same scene")->type_name("FILE");
    add_data_folder(*app, run->data);
    CLI::Option* quiet = app->add_flag("--quiet", run->quiet, "print only errors");
    app->add_flag("--json", run->json, "progress and result as one JSON object per line on stdout")->excludes(quiet);
    app->footer([] { return run_help + params::scene_reference_text(); });
    commands.push_back({app, [run] { return run_command(*run); }});
}

}  // namespace talus::cli
