#include "ensemble/ensemble.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "command.hpp"
#include "core/try.hpp"
#include "ensemble/ensemble_products.hpp"
#include "ensemble/fast_model.hpp"
#include "ensemble_text.hpp"
#include "evaluation_options.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "layers.hpp"
#include "ranks.hpp"
#include "scene_input.hpp"
#include "thread_options.hpp"
#include "throttled_progress.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

struct EnsembleArguments {
    std::string scene;                 ///< a scene file; empty: the built-in scene
    std::string output;                ///< a folder; empty: talus_out/<scene name>_ensemble
    std::string plan;                  ///< a plan file; empty: options alone
    std::vector<std::string> factors;  ///< "section.key=distribution"
    std::optional<std::string> design;
    std::optional<std::size_t> runs, fast_runs, levels;
    std::optional<std::uint64_t> seed;
    Evaluation evaluation;
    std::vector<std::string> overrides;  ///< "section.key=value"
    std::string layers;                  ///< of --layers; empty: not given
    std::string data;                    ///< value of TALUS_DATA; empty: as in the environment
    ThreadOptions threads;
    std::string shard;  ///< "i/n"; empty: all runs
    bool retry_failed = false, quiet = false, json = false;
};

struct MergeArguments {
    std::vector<std::string> folders;
    std::string output;  ///< empty: the only folder itself
    std::string scene;   ///< current path of the scene; empty: unchanged
    Evaluation evaluation;
    std::string data;
    bool quiet = false, json = false;
};

constexpr const char* ensemble_help = R"(
Runs the scene once per point of a design over the factors, several runs in parallel. Results: probability and
percentile maps, run-out, probability of a hit per building, sensitivity, a report. A factor is any value of a scene:
  --vary material.friction_coefficient=0.2:0.5        uniform between
  --vary release.volume_m3=log:300:1200               log-uniform
  --vary material.viscosity=normal:0.1:0.02           normal, truncated to the key's range; or normal:MEAN:DEV:LOW:HIGH
  --vary release.volume_m3=triangular:400:600:900     low, mode, high
  --vary solver.kernel=spiky,cubic_spline             one of a list
or [[factor]] in a plan file (docs/ensembles.md). Designs:
  latin_hypercube, monte_carlo, sobol   --runs points; percentiles and rank correlation
  grid                                  every combination of --levels values per factor, or of a list's entries
  saltelli                              first-order and total Sobol indices; factors + 2 runs per block
  morris                                elementary effects; factors + 1 runs per trajectory
Run 17 is the same on any machine. The same command resumes where an earlier one stopped, mpirun -n N distributes runs
over ranks, and --shard i/n with talus ensemble merge does so without MPI, with the same results.
--fast-runs 500 adds runs of the depth-averaged model, some beside each run of particles: means and probabilities of a
hit come with a smaller standard error (two_models.csv); maps and percentiles are of particles alone.

Exit codes: as talus run. A run that fails is listed with its fault, and the ensemble continues; 3: no run was complete.
)";

/// The plan file, then the options over it.
Result<ensemble::EnsemblePlan> read_arguments(const EnsembleArguments& arguments) {
    ensemble::EnsemblePlan plan;
    if (!arguments.plan.empty()) {
        TALUS_ASSIGN(plan, ensemble::read_plan(arguments.plan));
    }
    for (const std::string& factor : arguments.factors) {
        TALUS_TRY(add_factor(plan, factor));
    }
    if (arguments.design) {
        const auto design = stats::design_of(*arguments.design);
        if (!design)
            return Error{fmt::format("--design {} is refused; it must be one of {}", *arguments.design,
                                     fmt::join(stats::design_names(), ", "))};
        plan.design = *design;
    }
    plan.runs = arguments.runs.value_or(plan.runs);
    plan.fast_runs = arguments.fast_runs.value_or(plan.fast_runs);
    plan.levels = arguments.levels.value_or(plan.levels);
    plan.seed = arguments.seed.value_or(plan.seed);
    TALUS_TRY(set_evaluation(plan, arguments.evaluation));
    return plan;
}

/// "2/8" -> shard 1 (counted from 0) of 8.
Result<std::pair<std::size_t, std::size_t>> parse_shard(const std::string& text) {
    if (text.empty()) return std::pair<std::size_t, std::size_t>{0, 1};
    std::size_t shard = 0, count = 0;
    const char* const end = text.data() + text.size();
    const auto [slash, first] = std::from_chars(text.data(), end, shard);
    if (first == std::errc() && slash != end && *slash == '/') {
        const auto [last, second] = std::from_chars(slash + 1, end, count);
        if (second == std::errc() && last == end && shard >= 1 && shard <= count) return std::pair{shard - 1, count};
    }
    return Error{fmt::format("--shard {} is refused; it must be i/n with i from 1 to n, such as 3/8", text)};
}

/// The runs of the depth-averaged model, in a folder of their own within that of the ensemble.
struct FastPart {
    ensemble::FastModel model;
    fs::path path;
    nlohmann::ordered_json definition;
};

/// None where the plan has no fast runs. Errors: as fast_ensemble.
Result<std::optional<FastPart>> fast_part(const SceneInput& source, const ensemble::PlannedRuns& runs,
                                          const fs::path& path) {
    if (runs.plan().fast_runs == 0) return std::optional<FastPart>();
    TALUS_ASSIGN(auto model, fast_ensemble(runs, source.source, source.scene));
    auto definition = ensemble_definition(model.runs, model.source, *model.scene, source.name);
    definition["kind"] = "fast part of an ensemble";
    return std::optional(FastPart{std::move(model), path / "fast", std::move(definition)});
}

struct Folders {
    std::optional<ensemble::EnsembleFolder> own, fast;
};

/// Errors: as EnsembleFolder::open.
Status open_folders(const fs::path& path, const nlohmann::ordered_json& definition, const std::optional<FastPart>& fast,
                    Folders& folders) {
    TALUS_ASSIGN(auto own, ensemble::EnsembleFolder::open(path, definition));
    folders.own.emplace(std::move(own));
    if (!fast) return {};
    TALUS_ASSIGN(auto within, ensemble::EnsembleFolder::open(fast->path, fast->definition));
    folders.fast.emplace(std::move(within));
    return {};
}

/// The runs of the scene, then those of the depth-averaged model, if there are any.
Result<ensemble::EnsembleOutcome> run_both(const ensemble::PlannedRuns& runs, const run::SceneSource& source,
                                           const std::optional<FastPart>& fast, const Folders& folders,
                                           const ensemble::EnsembleOptions& options, ThrottledProgress& reporter) {
    TALUS_ASSIGN(ensemble::EnsembleOutcome outcome, run_ensemble(runs, source, *folders.own, options));
    if (outcome.interrupted || !fast) return outcome;
    reporter.say("runs of the depth-averaged model");
    TALUS_ASSIGN(const ensemble::EnsembleOutcome more,
                 run_ensemble(fast->model.runs, fast->model.source, *folders.fast, options));
    outcome.interrupted = more.interrupted;
    outcome.done += more.done;
    outcome.failed += more.failed;
    return outcome;
}

/// Evaluates the runs of the folder and writes the results into it.
int write_results(const SceneInput& source, const ensemble::PlannedRuns& runs, const ensemble::EnsembleFolder& folder,
                  const std::optional<FastPart>& fast, bool quiet, bool json, ThrottledProgress& reporter) {
    reporter.say("evaluating the runs, writing maps, tables and report");
    Result<ensemble::Reduction> reduction =
        reduce({folder.path()}, runs.count(), folder.plan(), runs.plan().thresholds,
               report::intensity_guideline(source.scene.spec.outputs.intensity_guideline));
    if (!reduction) return fail(exit_code::failure, reduction.error().message);
    if (reduction->complete == 0) {
        reporter.clear();
        const std::string fault = reduction->runs.empty() ? "none was run" : reduction->runs.front().fault;
        return fail(exit_code::fault,
                    fmt::format("no run of {} is complete, so there is nothing to evaluate; the first: {}",
                                folder.path().string(), fault));
    }
    ensemble::EnsembleResult result = summarise(source.scene, runs, *std::move(reduction));
    if (fast) {
        auto both =
            compare_models(result.reduction.runs, result.measures,
                           ensemble::EnsembleFolder::join(fast->path, fast->definition), fast->model.runs.count());
        if (!both) return fail(exit_code::failure, both.error().message);
        result.two_models = *std::move(both);
    }
    const Status written = write_ensemble(result, folder.path());
    reporter.clear();
    if (!written) return fail(exit_code::failure, written.error().message);
    if (json) {
        return print_result(ensemble_json(result, folder.path()) + "\n");
    }
    return quiet ? exit_code::success : print_result(ensemble_text(result, folder.path()));
}

/// Sets the number of simultaneous runs.
Status set_parallel_runs(const EnsembleArguments& arguments, const ensemble::PlannedRuns& runs, int ranks,
                         ensemble::EnsembleOptions& options) {
    const std::size_t share = runs.count() / options.shard_count;
    TALUS_ASSIGN(const SharedThreads shared, share_threads(arguments.threads, static_cast<int>(share), ranks));
    options.runs_at_once = shared.runs_at_once;
    options.threads_per_run = shared.threads_per_run;
    return {};
}

int ensemble_command(const EnsembleArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    if (Status s = Ranks::check(); !s) return fail(exit_code::bad_input, s.error().message);
    const Ranks ranks;
    // All ranks find the same faults in the input; one of them reports it.
    const auto refuse = [&](const Error& error) {
        return ranks.first() ? fail(exit_code::bad_input, error.message) : exit_code::bad_input;
    };
    Result<ensemble::EnsemblePlan> plan = read_arguments(arguments);
    if (!plan) return refuse(plan.error());
    const auto shard = parse_shard(arguments.shard);
    if (!shard) return refuse(shard.error());
    const Result<SceneInput> source = open_scene(arguments.scene, arguments.overrides, arguments.layers, watch);
    if (!source) return refuse(source.error());
    const Result<ensemble::PlannedRuns> runs = ensemble::PlannedRuns::make(*plan, source->source, source->scene);
    if (!runs) return refuse(runs.error());
    const auto definition = ensemble_definition(*runs, source->source, source->scene, source->name);

    const fs::path path =
        arguments.output.empty() ? default_output(source->short_name + "_ensemble") : fs::path(arguments.output);
    const auto fast = fast_part(*source, *runs, path);
    if (!fast) return refuse(fast.error());
    if (*fast && shard->second > 1) {
        return refuse(
            Error{fmt::format("--shard {} is refused; with fast runs an ensemble is one folder, whose runs "
                              "mpirun distributes",
                              arguments.shard)});
    }
    Folders folders;
    if (ranks.first()) {
        const Status opened = open_folders(path, definition, *fast, folders);
        if (!ranks.hear_first(opened.ok())) return fail(exit_code::bad_input, opened.error().message);
    } else {
        if (!ranks.hear_first(false)) return exit_code::bad_input;
        folders.own.emplace(ensemble::EnsembleFolder::join(path, definition));
        if (*fast) folders.fast.emplace(ensemble::EnsembleFolder::join((*fast)->path, (*fast)->definition));
    }

    ThrottledProgress reporter(arguments.quiet || !ranks.first(), arguments.json && ranks.first());
    ensemble::EnsembleOptions options;
    options.shard_count = shard->second * static_cast<std::size_t>(ranks.count());
    options.shard = shard->first + shard->second * static_cast<std::size_t>(ranks.rank());
    options.retry_failed = arguments.retry_failed;
    options.stop_requested = &watch.stop_requested();
    options.on_progress = [&](const ensemble::EnsembleProgress& progress) {
        reporter.report([&] { return progress_text(progress); }, [&] { return progress_json(progress); });
    };
    options.on_refused = [&](const std::string& why) { reporter.note(why); };
    if (Status s = set_parallel_runs(arguments, *runs, ranks.count(), options); !s) {
        return fail(exit_code::bad_input, s.error().message);
    }

    const auto outcome = run_both(*runs, source->source, *fast, folders, options, reporter);
    reporter.clear();
    if (!outcome) (void)fail(exit_code::failure, outcome.error().message);
    const long broken = ranks.sum(outcome ? 0 : 1);
    const long interrupted = ranks.sum(outcome && outcome->interrupted ? 1 : 0);
    const long done = ranks.sum(outcome ? static_cast<long>(outcome->done + outcome->failed) : 0);
    if (broken > 0) return exit_code::failure;
    if (!ranks.first()) return interrupted > 0 ? exit_code::interrupted : exit_code::success;
    if (interrupted > 0) {
        return fail(exit_code::interrupted,
                    fmt::format("interrupted with {} runs complete in {}; the same command resumes from there", done,
                                path.string()));
    }
    if (shard->second > 1) {
        if (arguments.json) return print_result(fmt::format("{{\"event\":\"shard\",\"runs_done\":{}}}\n", done));
        if (arguments.quiet) return exit_code::success;
        return print_result(fmt::format("shard {} is complete: {} runs in {}; talus ensemble merge combines shards\n",
                                        arguments.shard, done, path.string()));
    }
    return write_results(*source, *runs, *folders.own, *fast, arguments.quiet, arguments.json, reporter);
}

int merge_command(const MergeArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    if (arguments.output.empty() && arguments.folders.size() > 1) {
        return fail(exit_code::bad_input, "several folders are given; name the output folder with --output");
    }
    const Result<nlohmann::ordered_json> definition = ensemble::read_definition(arguments.folders.front());
    if (!definition) return fail(exit_code::bad_input, definition.error().message);
    for (const std::string& folder : arguments.folders) {
        const auto other = ensemble::read_definition(folder);
        if (!other) return fail(exit_code::bad_input, other.error().message);
        if (const std::string differs = ensemble::difference(*other, *definition); !differs.empty()) {
            return fail(exit_code::bad_input, fmt::format("{}: does not belong to the ensemble of {} ({})", folder,
                                                          arguments.folders.front(), differs));
        }
    }
    Result<ensemble::EnsemblePlan> plan = ensemble::plan_of(*definition);
    if (!plan) return fail(exit_code::bad_input, plan.error().message);
    if (Status s = set_evaluation(*plan, arguments.evaluation); !s) {
        return fail(exit_code::bad_input, s.error().message);
    }
    const std::string scene = arguments.scene.empty() ? definition->value("scene", "") : arguments.scene;
    const Result<SceneInput> source =
        open_scene(scene, definition->value("overrides", std::vector<std::string>()), "", watch);
    if (!source)
        return fail(exit_code::bad_input,
                    source.error().message + (arguments.scene.empty() ? "; give its present path with --scene" : ""));
    const Result<ensemble::PlannedRuns> runs = ensemble::PlannedRuns::make(*plan, source->source, source->scene);
    if (!runs) return fail(exit_code::bad_input, runs.error().message);
    const auto made = ensemble_definition(*runs, source->source, source->scene, source->name);
    if (const std::string differs = ensemble::difference(*definition, made); !differs.empty()) {
        return fail(exit_code::bad_input,
                    fmt::format("{}: has changed since this ensemble was run ({})", scene, differs));
    }

    const fs::path path = arguments.output.empty() ? arguments.folders.front() : arguments.output;
    const Result<ensemble::EnsembleFolder> folder = ensemble::EnsembleFolder::open(path, *definition);
    if (!folder) return fail(exit_code::bad_input, folder.error().message);
    for (const std::string& from : arguments.folders) {
        if (Status s = take_runs(from, *folder, runs->count()); !s)
            return fail(exit_code::bad_input, s.error().message);
    }
    const auto fast = fast_part(*source, *runs, path);
    if (!fast) return fail(exit_code::bad_input, fast.error().message);
    if (*fast) {
        const auto fast_folder = ensemble::EnsembleFolder::open((*fast)->path, (*fast)->definition);
        if (!fast_folder) return fail(exit_code::bad_input, fast_folder.error().message);
        for (const std::string& from : arguments.folders) {
            if (Status s = take_runs(fs::path(from) / "fast", *fast_folder, (*fast)->model.runs.count()); !s)
                return fail(exit_code::bad_input, s.error().message);
        }
    }
    ThrottledProgress reporter(arguments.quiet, arguments.json);
    return write_results(*source, *runs, *folder, *fast, arguments.quiet, arguments.json, reporter);
}

}  // namespace

void add_ensemble(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app =
        program.add_subcommand("ensemble", "run a scene many times with varied values: probability maps, sensitivity");
    const auto ensemble = std::make_shared<EnsembleArguments>();
    app->require_subcommand(0, 1);
    app->add_option("scene", ensemble->scene, "scene file; default: the built-in scene")->type_name("SCENE");
    app->add_option("-o,--output", ensemble->output, "folder; default: talus_out/<scene name>_ensemble")
        ->type_name("DIR");
    app->add_option("--plan", ensemble->plan, "plan file with factors, design and thresholds; options override it")
        ->type_name("FILE");
    app->add_option("--vary", ensemble->factors, "a factor; may be repeated")
        ->type_name("SECTION.KEY=DISTRIBUTION")
        ->allow_extra_args(false);
    app->add_option("--design", ensemble->design, "default: latin_hypercube")->type_name("NAME");
    app->add_option("--runs", ensemble->runs, "maximum number of runs; default: 64")->type_name("N");
    app->add_option("--fast-runs", ensemble->fast_runs,
                    "runs of the depth-averaged model beside those of particles, for means of both; default: none")
        ->type_name("N");
    app->add_option("--levels", ensemble->levels, "values per factor of a grid; default: 5")->type_name("N");
    app->add_option("--seed", ensemble->seed, "of the design; default: 1")->type_name("N");
    add_evaluation(*app, ensemble->evaluation);
    add_overrides(*app, ensemble->overrides);
    add_backend(*app, ensemble->overrides);
    add_layers(*app, ensemble->layers, false);
    add_data_folder(*app, ensemble->data);
    add_thread_options(*app, ensemble->threads, "runs", "all cores; 1 per rank");
    app->add_option("--shard", ensemble->shard, "only every n-th run, from the i-th; each shard in its own folder")
        ->type_name("I/N");
    app->add_flag("--retry-failed", ensemble->retry_failed, "repeat runs that failed in an earlier call");
    CLI::Option* quiet = app->add_flag("--quiet", ensemble->quiet, "print only errors");
    app->add_flag("--json", ensemble->json, "progress and result as one JSON object per line on stdout")
        ->excludes(quiet);
    app->footer(ensemble_help);

    CLI::App* merge_app =
        app->add_subcommand("merge", "combine shards, or evaluate with other thresholds or another return period");
    const auto merge = std::make_shared<MergeArguments>();
    merge_app->add_option("folders", merge->folders, "folders of an ensemble or its shards")
        ->required()
        ->type_name("DIR");
    merge_app->add_option("-o,--output", merge->output, "output folder; default: the only folder given")
        ->type_name("DIR");
    merge_app->add_option("--scene", merge->scene, "present path of the scene; default: the path of the runs")
        ->type_name("SCENE");
    add_evaluation(*merge_app, merge->evaluation);
    add_data_folder(*merge_app, merge->data);
    CLI::Option* merge_quiet = merge_app->add_flag("--quiet", merge->quiet, "print only errors");
    merge_app->add_flag("--json", merge->json, "the result as one JSON object on stdout")->excludes(merge_quiet);
    merge_app->footer("");

    commands.push_back({merge_app, [merge] { return merge_command(*merge); }});
    commands.push_back({app, [ensemble] { return ensemble_command(*ensemble); }});
}

}  // namespace talus::cli
