#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command.hpp"
#include "core/try.hpp"
#include "ensemble/ensemble.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "ranks.hpp"
#include "risk/risk_products.hpp"
#include "risk/study.hpp"
#include "risk_text.hpp"
#include "run_cost.hpp"
#include "sample_options.hpp"
#include "scene_input.hpp"
#include "thread_options.hpp"
#include "throttled_progress.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

struct RiskArguments {
    std::string scene;   ///< a scene file; empty: the built-in scene
    std::string output;  ///< a folder
    SampleOptions sample;
    std::vector<std::string> options;  ///< of talus options: those wanted; none: all
    std::vector<std::string> overrides;
    std::string data;
    ThreadOptions threads;
    bool compare = false;  ///< talus options
    bool retry_failed = false, quiet = false, json = false;
};

constexpr const char* risk_help = R"(
Runs an ensemble for each [[risk_scenario]] of the scene, a class of events with how often it comes, and counts what it
does to every [[exposure]]: buildings with value and persons, roads with traffic. Results, per building and in all:
annual probability of impact, expected loss and deaths, individual risk, F-N curve against published criteria, a map of
individual risk; with intervals of 95 %, every assumption and what is left out. Factors are those of talus ensemble:
  talus risk valley/scene.toml --vary material.friction_coefficient=0.15:0.3 --runs 64 -o valley_risk
Nothing is computed from a frequency, a number of persons or a curve that the scene does not state. With an option in
force: --set scene.option=NAME; all of them side by side: talus options. docs/risk.md has an example.

The same command resumes where an earlier one stopped; mpirun -n N distributes the runs, with the same results.

Exit codes: as talus run; 3: too few runs were complete.
)";

constexpr const char* options_help = R"(
Runs the ensembles of talus risk for the ground as it is and for each [[option]] of the scene: barriers, zones and removed
buildings that are built, or not, together. Run n has the same draws for every option, so that a difference is that of the
measures. Results: hazard, impact on each building and risk side by side, differences with intervals of 95 %, cost of a
year against risk averted. Without [[risk_scenario]] all numbers are per event.

The same command resumes where an earlier one stopped; mpirun -n N distributes the runs, with the same results.

Exit codes: as talus run; 3: too few runs were complete.
)";

Result<ensemble::EnsemblePlan> read_arguments(const RiskArguments& arguments) {
    TALUS_ASSIGN(ensemble::EnsemblePlan plan,
                 read_sample(arguments.sample, ensemble::EnsemblePlan().runs, "set solver.model instead"));
    if (plan.return_period) {
        return Error{arguments.sample.plan +
                     ": ensemble.return_period_years is refused; each [[risk_scenario]] of the scene has its own"};
    }
    return plan;
}

/// The options that are compared, the base first.
Result<std::vector<std::string>> wanted_options(const RiskArguments& arguments, const scene::Scene& scene) {
    if (!arguments.compare) return std::vector{scene.spec.scene.option};
    std::vector<std::string> all, names = {""};
    all.reserve(scene.spec.options.size());
    for (const params::OptionSpec& option : scene.spec.options) all.push_back(option.name);
    if (all.empty()) return Error{scene.file.string() + ": [[option]] is missing; there is nothing to compare"};
    for (const std::string& name : arguments.options.empty() ? all : arguments.options) {
        if (std::find(all.begin(), all.end(), name) == all.end()) {
            return Error{fmt::format("--option {}: there is no such option; options of the scene: {}", name,
                                     fmt::join(all, ", "))};
        }
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    return names;
}

/// Runs of the study that no earlier call has made.
std::size_t missing_runs(const risk::Study& study) {
    std::size_t missing = 0;
    for (const risk::Part& part : study.parts) {
        const auto folder = ensemble::EnsembleFolder::join(part.folder, *part.definition);
        std::error_code error;
        for (std::size_t run = 0; run < part.runs->count(); ++run)
            missing += fs::exists(folder.run_file(run), error) ? 0 : 1;
    }
    return missing;
}

/// Says what is to be computed, and how long that takes, before it starts.
void tell_cost(const risk::Study& study, const RiskArguments& arguments, const SharedThreads& shared, int ranks,
               const InterruptWatch& watch, ThrottledProgress& reporter) {
    const std::size_t missing = missing_runs(study);
    if (arguments.quiet || missing == 0) return;
    const double each = seconds_of_run(*study.parts.front().scene, watch);
    const double wall = each * static_cast<double>(missing) / (shared.runs_at_once * ranks);
    if (arguments.json) {
        (void)print(cost_json(study, missing, wall) + "\n");
    } else {
        reporter.note(cost_text(study, missing, wall));
    }
}

/// Runs every ensemble of the study, one after the other.
class StudyRunner {
  public:
    StudyRunner(const risk::Study& study, const RiskArguments& arguments, const SharedThreads& shared,
                const Ranks& ranks, const InterruptWatch& watch, ThrottledProgress& reporter)
        : study_(study), arguments_(arguments), shared_(shared), ranks_(ranks), watch_(watch), reporter_(reporter) {}

    /// An exit code.
    int run() {
        for (const risk::Part& part : study_.parts) {
            if (const int code = run(part); code != exit_code::success) return code;
        }
        return exit_code::success;
    }

  private:
    int run(const risk::Part& part) {
        std::optional<ensemble::EnsembleFolder> folder;
        if (ranks_.first()) {
            std::error_code error;
            fs::create_directories(part.folder.parent_path(), error);  // opening says what is wrong with it
            auto opened = ensemble::EnsembleFolder::open(part.folder, *part.definition);
            if (!ranks_.hear_first(opened.ok())) return fail(exit_code::bad_input, opened.error().message);
            folder.emplace(*std::move(opened));
        } else {
            if (!ranks_.hear_first(false)) return exit_code::bad_input;
            folder.emplace(ensemble::EnsembleFolder::join(part.folder, *part.definition));
        }
        ensemble::EnsembleOptions options;
        options.shard = static_cast<std::size_t>(ranks_.rank());
        options.shard_count = static_cast<std::size_t>(ranks_.count());
        options.runs_at_once = shared_.runs_at_once;
        options.threads_per_run = shared_.threads_per_run;
        options.retry_failed = arguments_.retry_failed;
        options.stop_requested = &watch_.stop_requested();
        options.on_progress = [&](const ensemble::EnsembleProgress& now) { report(now); };
        options.on_run = [&](const ensemble::RunRecord&) { ++computed_; };
        options.on_refused = [&](const std::string& why) { reporter_.note(why); };
        const auto outcome = run_ensemble(*part.runs, part.source, *folder, options);
        reporter_.clear();
        if (!outcome) (void)fail(exit_code::failure, outcome.error().message);
        if (outcome) done_ += outcome->done + outcome->failed;
        const long broken = ranks_.sum(outcome ? 0 : 1);
        const long interrupted = ranks_.sum(outcome && outcome->interrupted ? 1 : 0);
        if (broken > 0) return exit_code::failure;
        if (interrupted == 0) return exit_code::success;
        return ranks_.first() ? fail(exit_code::interrupted,
                                     "interrupted; the same command resumes from the runs that are complete")
                              : exit_code::interrupted;
    }

    /// Of all ensembles together; each of the ranks tells of its own share.
    void report(const ensemble::EnsembleProgress& now) {
        const double count = static_cast<double>(study_.run_count()) / ranks_.count();
        ensemble::EnsembleProgress all = now;
        all.done = done_ + now.done;
        all.count = study_.run_count() / static_cast<std::size_t>(ranks_.count());
        all.share_done =
            std::min(1.0, (static_cast<double>(done_) + now.share_done * static_cast<double>(now.count)) / count);
        const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
        const double rate = static_cast<double>(computed_) / elapsed;  // runs per second
        all.runs_per_minute = 60 * rate;
        all.wall_remaining = computed_ > 0 ? (1 - all.share_done) * count / rate : std::nan("");
        reporter_.report([&] { return progress_text(all); }, [&] { return progress_json(all); });
    }

    using Clock = std::chrono::steady_clock;
    const risk::Study& study_;
    const RiskArguments& arguments_;
    const SharedThreads& shared_;
    const Ranks& ranks_;
    const InterruptWatch& watch_;
    ThrottledProgress& reporter_;
    std::size_t done_ = 0;      // runs of the ensembles before
    std::size_t computed_ = 0;  // runs of this call
    Clock::time_point start_ = Clock::now();
};

int risk_command(const RiskArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    if (Status s = Ranks::check(); !s) return fail(exit_code::bad_input, s.error().message);
    const Ranks ranks;
    // All ranks find the same faults in the input; one of them reports it.
    const auto refuse = [&](const Error& error) {
        return ranks.first() ? fail(exit_code::bad_input, error.message) : exit_code::bad_input;
    };
    const auto plan = read_arguments(arguments);
    if (!plan) return refuse(plan.error());
    const Result<SceneInput> source = open_scene(arguments.scene, arguments.overrides, "", watch);
    if (!source) return refuse(source.error());
    const auto options = wanted_options(arguments, source->scene);
    if (!options) return refuse(options.error());
    const fs::path path = arguments.output.empty()
                              ? default_output(source->short_name + (arguments.compare ? "_options" : "_risk"))
                              : fs::path(arguments.output);
    const auto study = risk::plan_study({*plan, source->source, source->name, *options, path, !arguments.compare});
    if (!study) return refuse(study.error());
    const auto shared =
        share_threads(arguments.threads, static_cast<int>(study->parts.front().runs->count()), ranks.count());
    if (!shared) return refuse(shared.error());

    ThrottledProgress reporter(arguments.quiet || !ranks.first(), arguments.json && ranks.first());
    if (ranks.first()) tell_cost(*study, arguments, *shared, ranks.count(), watch, reporter);
    const int code = StudyRunner(*study, arguments, *shared, ranks, watch, reporter).run();
    if (code != exit_code::success || !ranks.first()) return code;
    reporter.say("evaluating the runs, writing maps, tables and report");
    const auto result = risk::summarise(*study);
    if (!result) return fail(exit_code::fault, result.error().message);
    const Status written = write_study(*result, path);
    reporter.clear();
    if (!written) return fail(exit_code::failure, written.error().message);
    if (arguments.json) return print_result(risk_json(*result, path) + "\n");
    return arguments.quiet ? exit_code::success : print_result(risk_text(*result, path));
}

void add_command(CLI::App& program, std::vector<Command>& commands, bool compare) {
    CLI::App* app = program.add_subcommand(
        compare ? "options" : "risk", compare ? "compare options of measures: hazard, risk and cost side by side"
                                              : "count what is at risk: annual loss, individual and societal risk");
    const auto a = std::make_shared<RiskArguments>();
    a->compare = compare;
    app->add_option("scene", a->scene, "scene file; default: the built-in scene")->type_name("SCENE");
    app->add_option("-o,--output", a->output,
                    fmt::format("folder; default: talus_out/<scene name>_{}", compare ? "options" : "risk"))
        ->type_name("DIR");
    if (compare) {
        app->add_option("--option", a->options, "an option to compare; may be repeated; default: all")
            ->type_name("NAME")
            ->allow_extra_args(false);
    }
    add_sample_options(*app, a->sample, "runs of each class of events; default: 64");
    add_overrides(*app, a->overrides);
    add_backend(*app, a->overrides);
    add_data_folder(*app, a->data);
    add_thread_options(*app, a->threads, "runs", "all cores; 1 per rank");
    app->add_flag("--retry-failed", a->retry_failed, "repeat runs that failed in an earlier call");
    CLI::Option* quiet = app->add_flag("--quiet", a->quiet, "print only errors");
    app->add_flag("--json", a->json, "cost, progress and result as one JSON object per line on stdout")
        ->excludes(quiet);
    app->footer(compare ? options_help : risk_help);
    commands.push_back({app, [a] { return risk_command(*a); }});
}

}  // namespace

void add_risk(CLI::App& program, std::vector<Command>& commands) {
    add_command(program, commands, true);
    add_command(program, commands, false);
}

}  // namespace talus::cli
