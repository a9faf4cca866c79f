#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "calibrate/calibration.hpp"
#include "calibrate/calibration_products.hpp"
#include "calibrate/recovery.hpp"
#include "calibrate_text.hpp"
#include "command.hpp"
#include "core/try.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "layers.hpp"
#include "products/text_file.hpp"
#include "scene_input.hpp"
#include "thread_options.hpp"
#include "throttled_progress.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

struct CalibrateArguments {
    std::string scene;                 ///< a scene file; empty: the built-in scene
    std::string output;                ///< a folder; empty: talus_out/<scene name>_calibration
    std::vector<std::string> factors;  ///< "section.key=distribution"
    std::string search_with;           ///< "depth_averaged"; empty: the scene's model alone
    std::optional<std::size_t> runs, fast_runs, design, checks;
    std::optional<std::uint64_t> seed;
    std::optional<std::size_t> recover;  ///< number of attempts with known values
    std::vector<std::string> overrides;  ///< "section.key=value"
    std::string layers;                  ///< of --layers; empty: not given
    std::string data;                    ///< value of TALUS_DATA; empty: as in the environment
    ThreadOptions threads;
    bool retry_failed = false, quiet = false, json = false;
};

constexpr const char* calibrate_help = R"(
Finds the values of a scene that explain field observations ([[observation]], [[run_up]], [[deposit_depth]] and others,
each with its uncertainty), and their uncertainty: a space-filling design, emulators of the runs' predictions, further
runs where they help most, the posterior, and runs that check it. Free values are given like the factors of talus
ensemble, as a range or a prior:
  --vary material.friction_coefficient=0.1:0.6        uniform between
  --vary material.viscosity=log:0.01:0.6              log-uniform
  --vary release.volume_m3=normal:600:60              a prior: mean and standard deviation
The folder holds report.html, the runs, intervals, draws from the posterior, the misfit map, and best_fit/scene.toml.
The same command resumes where an earlier one stopped. --recover 10 repeats the calibration ten times with observations
from runs with known values, and counts how often these are recovered within the stated interval, which shows what such
observations can identify (docs/calibration.md).
--search-with depth_averaged searches with that faster model (100 runs, --fast-runs) and confirms with particles (10
runs, --runs): emulators learn the difference between the models from the places where both ran.

Exit codes: as talus run. A run that fails is excluded; 3: no run of the design was complete.
)";

Result<calibrate::CalibrationPlan> read_arguments(const CalibrateArguments& arguments) {
    ensemble::EnsemblePlan factors;
    for (const std::string& factor : arguments.factors) {
        TALUS_TRY(add_factor(factors, factor));
    }
    calibrate::CalibrationPlan plan;
    plan.factors = std::move(factors.factors);
    if (!arguments.search_with.empty()) {
        if (arguments.search_with != "depth_averaged") {
            return Error{fmt::format("--search-with {} is refused; it must be depth_averaged", arguments.search_with)};
        }
        plan.search.runs = calibrate::runs_beside_fast;
        plan.search.fast_runs = arguments.fast_runs.value_or(calibrate::default_fast_runs);
    } else if (arguments.fast_runs) {
        return Error{"--fast-runs is for --search-with depth_averaged, which is not given"};
    }
    plan.search.runs = arguments.runs.value_or(plan.search.runs);
    plan.search.design = arguments.design.value_or(plan.search.design);
    plan.search.checks = arguments.checks.value_or(plan.search.checks);
    plan.search.seed = arguments.seed.value_or(plan.search.seed);
    if (plan.search.design > 0 && plan.search.design + plan.search.checks > plan.search.runs) {
        return Error{fmt::format("--design {} with --checks {} is refused; together they must be at most --runs {}",
                                 plan.search.design, plan.search.checks, plan.search.runs)};
    }
    return plan;
}

int say_interrupted(const fs::path& path) {
    return fail(exit_code::interrupted,
                fmt::format("interrupted; the completed runs are in {}, and the same command resumes from there",
                            path.string()));
}

int run_recovery(const CalibrateArguments& arguments, const calibrate::CalibrationPlan& plan,
                 const ensemble::PlannedRuns& runs, const SceneInput& input, const fs::path& path,
                 calibrate::CalibrationOptions options, ThrottledProgress& reporter) {
    const std::size_t seeds = *arguments.recover;
    std::size_t seed = 0;
    options.on_progress = [&](const calibrate::CalibrationProgress& progress) {
        const std::string where = seed == 0 ? "runs with known values" : fmt::format("seed {} of {}", seed, seeds);
        reporter.report([&] { return where + ", " + progress_text(progress); },
                        [&] { return progress_json(progress); });
    };
    const auto recovery = recover(plan, runs, input.source, input.scene, input.name, path, seeds, options,
                                  [&](std::size_t now) { seed = now + 1; });
    reporter.clear();
    if (!recovery) return fail(exit_code::bad_input, recovery.error().message);
    if (recovery->interrupted) return say_interrupted(path);
    if (Status s = products::write_text_file(path / "recovery.csv", recovery_table(*recovery)); !s) {
        return fail(exit_code::failure, s.error().message);
    }
    if (arguments.json) {
        return print_result(recovery_json(*recovery) + "\n");
    }
    return arguments.quiet ? exit_code::success : print_result(recovery_text(*recovery, path));
}

int run_calibration(const CalibrateArguments& arguments, const calibrate::CalibrationPlan& plan,
                    const ensemble::PlannedRuns& runs, const SceneInput& input, const fs::path& path,
                    calibrate::CalibrationOptions options, ThrottledProgress& reporter) {
    const std::vector<ensemble::ObservedValue> observed = ensemble::observed_values(input.scene);
    const auto folder = ensemble::EnsembleFolder::open(
        path, calibration_definition("calibration", plan, runs, input.source, input.scene, observed, input.name));
    if (!folder) return fail(exit_code::bad_input, folder.error().message);
    options.on_progress = [&](const calibrate::CalibrationProgress& progress) {
        reporter.report([&] { return progress_text(progress); }, [&] { return progress_json(progress); });
    };
    const auto made = calibrate::calibrate(plan, runs, input.source, input.scene, observed, *folder, options);
    reporter.clear();
    if (!made) return fail(exit_code::failure, made.error().message);
    if (!made->fault.empty()) return fail(exit_code::fault, made->fault);
    if (made->result.interrupted) return say_interrupted(path);
    reporter.say("writing tables and report");
    const Status written = write_calibration(*made, input.source, input.unpacked != nullptr, path);
    reporter.clear();
    if (!written) return fail(exit_code::failure, written.error().message);
    if (arguments.json) {
        return print_result(calibration_line(*made, path) + "\n");
    }
    return arguments.quiet ? exit_code::success : print_result(calibration_text(*made, path));
}

int calibrate_command(const CalibrateArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    Result<calibrate::CalibrationPlan> plan = read_arguments(arguments);
    if (!plan) return fail(exit_code::bad_input, plan.error().message);
    const Result<SceneInput> input = open_scene(arguments.scene, arguments.overrides, arguments.layers, watch);
    if (!input) return fail(exit_code::bad_input, input.error().message);
    const Result<ensemble::PlannedRuns> runs = plan_calibration(*plan, input->source, input->scene);
    if (!runs) return fail(exit_code::bad_input, runs.error().message);
    if (plan->search.fast_runs > 0) {
        auto fast = plan_fast_model(*plan, input->source, input->scene);
        if (!fast) return fail(exit_code::bad_input, fast.error().message);
        plan->fast.emplace(*std::move(fast));
    }
    const std::string ending = arguments.recover ? "_recovery" : "_calibration";
    const fs::path path =
        arguments.output.empty() ? default_output(input->short_name + ending) : fs::path(arguments.output);

    calibrate::CalibrationOptions options;
    const Result<SharedThreads> shared = share_threads(arguments.threads, static_cast<int>(plan->search.at_once));
    if (!shared) return fail(exit_code::bad_input, shared.error().message);
    options.runs_at_once = shared->runs_at_once;
    options.threads_per_run = shared->threads_per_run;
    options.retry_failed = arguments.retry_failed;
    options.stop_requested = &watch.stop_requested();
    ThrottledProgress reporter(arguments.quiet, arguments.json);
    options.on_refused = [&](const std::string& why) { reporter.note(why); };
    return arguments.recover ? run_recovery(arguments, *plan, *runs, *input, path, options, reporter)
                             : run_calibration(arguments, *plan, *runs, *input, path, options, reporter);
}

}  // namespace

void add_calibrate(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand(
        "calibrate", "find the values of a scene that explain field observations, with their uncertainty");
    const auto arguments = std::make_shared<CalibrateArguments>();
    app->add_option("scene", arguments->scene, "scene file; default: the built-in scene")->type_name("SCENE");
    app->add_option("-o,--output", arguments->output, "folder; default: talus_out/<scene name>_calibration")
        ->type_name("DIR");
    app->add_option("--vary", arguments->factors, "a free value with its range or prior; may be repeated")
        ->type_name("SECTION.KEY=DISTRIBUTION")
        ->allow_extra_args(false);
    app->add_option("--runs", arguments->runs, "maximum number of runs; default: 100, with --search-with 10")
        ->type_name("N");
    app->add_option("--search-with", arguments->search_with,
                    "a faster model for most of the search; --runs are then those of particles")
        ->type_name("depth_averaged");
    app->add_option("--fast-runs", arguments->fast_runs, "maximum number of runs of that model; default: 100")
        ->type_name("N");
    app->add_option("--design", arguments->design, "runs of the design; default: ten per factor")
        ->type_name("N")
        ->check(CLI::Range(3, 2000));
    app->add_option("--checks", arguments->checks, "runs that check the result; default: 10")
        ->type_name("N")
        ->check(CLI::Range(0, 1000));
    app->add_option("--seed", arguments->seed, "of the design and the chains; default: 1")->type_name("N");
    app->add_option("--recover", arguments->recover, "repeat N times with observations from runs with known values")
        ->type_name("N")
        ->check(CLI::Range(1, 1000));
    add_overrides(*app, arguments->overrides);
    add_backend(*app, arguments->overrides);
    add_layers(*app, arguments->layers, false);
    add_data_folder(*app, arguments->data);
    add_thread_options(*app, arguments->threads, "runs", "all cores");
    app->add_flag("--retry-failed", arguments->retry_failed, "repeat runs that failed in an earlier call");
    CLI::Option* quiet = app->add_flag("--quiet", arguments->quiet, "print only errors");
    app->add_flag("--json", arguments->json, "progress and result as one JSON object per line on stdout")
        ->excludes(quiet);
    app->footer(calibrate_help);
    commands.push_back({app, [arguments] { return calibrate_command(*arguments); }});
}

}  // namespace talus::cli
