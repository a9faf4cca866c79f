#include "design/design.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "command.hpp"
#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "ensemble/ensemble.hpp"
#include "ensemble_text.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "ranks.hpp"
#include "run_cost.hpp"
#include "sample_options.hpp"
#include "scene_input.hpp"
#include "thread_options.hpp"
#include "throttled_progress.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

struct DesignArguments {
    std::string scene, output, barrier;
    SampleOptions sample;
    std::string of = "runs", confirm = "none";
    std::vector<std::string> lines, overrides;
    double share = 0.05, low = 1, high = 10, step = 0.5;
    std::optional<double> boulder, slope;
    std::string data;
    ThreadOptions threads;
    bool retry_failed = false, quiet = false, json = false;
};

constexpr const char* help = R"(
Finds the least height of a barrier of the scene for which at most a stated share of the runs of an ensemble, or of
their volume, passes: over the crest, through openings or round an end. Every height has the same draws. With it come
what the barrier holds, run-up and filling, velocity and thickness of the flow that comes to its line without it, and
force and pressure from the runs beside the loads of published methods. Factors are those of talus ensemble:
  talus design valley/scene.toml --barrier "gully barrier" --vary material.friction_coefficient=0.15:0.3 --runs 32
Other lines for the same barrier, as places in the scene's reference system or a file with a line:
  --line "upper=824235,825765 824263,825755" --line lower=lower.geojson

The same command resumes where an earlier one stopped; mpirun -n N distributes the runs, with the same results.
docs/design.md has an example.

Exit codes: as talus run; 3: too few runs were complete.
)";

Result<design::DesignRequest> read_arguments(const DesignArguments& arguments, const SceneInput& source) {
    design::DesignRequest request;
    TALUS_ASSIGN(request.plan, read_sample(arguments.sample, 32, "set solver.model and --confirm instead"));
    request.source = source.source;
    request.scene_name = source.name;
    request.folder =
        arguments.output.empty() ? default_output(source.short_name + "_design") : fs::path(arguments.output);
    request.barrier = arguments.barrier;
    request.lines = arguments.lines;
    request.share = arguments.share;
    request.of_volume = arguments.of == "volume";
    request.low = arguments.low;
    request.high = arguments.high;
    request.step = arguments.step;
    request.confirm = arguments.confirm == "particles";
    request.boulder_diameter = arguments.boulder;
    request.deposition_slope = arguments.slope;
    return request;
}

/// Says what is to be computed at most, and how long that takes, before it starts.
void tell_cost(const design::Design& planned, const DesignArguments& arguments, const SharedThreads& shared, int ranks,
               const InterruptWatch& watch, ThrottledProgress& reporter) {
    const std::size_t missing = planned.missing_runs();
    if (arguments.quiet || missing == 0) return;
    const double each = seconds_of_run(*planned.scene, watch);
    const double wall = each * static_cast<double>(missing) / (shared.runs_at_once * ranks);
    if (arguments.json) {
        const nlohmann::ordered_json json = {{"event", "cost"},
                                             {"runs_at_most", planned.most_runs()},
                                             {"runs_missing", missing},
                                             {"wall_time_s", number_or_null<nlohmann::ordered_json>(wall)}};
        (void)print(json.dump() + "\n");
        return;
    }
    reporter.note(fmt::format(
        "at most {} runs to make: {} for each of {} heights and without the barrier, on {} line{}{}{}", missing,
        planned.runs->count(), planned.most_runs() / planned.lines.size() / planned.runs->count() - 1,
        planned.lines.size(), planned.lines.size() == 1 ? "" : "s", left_text("; at most about {} in all", wall),
        planned.request.confirm ? "; then up to 5 with particles on each line" : ""));
}

/// Runs the parts as the search asks for them. Each rank makes its share of a part; all then read the same files and
/// come to the same next height.
class PartsRunner {
  public:
    PartsRunner(const design::Design& planned, const DesignArguments& arguments, const SharedThreads& shared,
                const Ranks& ranks, const InterruptWatch& watch, ThrottledProgress& reporter)
        : planned_(planned),
          arguments_(arguments),
          shared_(shared),
          ranks_(ranks),
          watch_(watch),
          reporter_(reporter) {}

    Result<bool> operator()(const design::Part& part) {
        const Status opened = ranks_.first() ? open_part(part) : Status();
        if (!ranks_.hear_first(opened.ok())) {
            return opened.ok() ? Error{"the first rank could not open the folder"} : opened.error();
        }
        ensemble::EnsembleOptions options;
        options.shard = static_cast<std::size_t>(ranks_.rank());
        options.shard_count = static_cast<std::size_t>(ranks_.count());
        options.runs_at_once = shared_.runs_at_once;
        options.threads_per_run = shared_.threads_per_run;
        options.retry_failed = arguments_.retry_failed;
        options.stop_requested = &watch_.stop_requested();
        options.on_progress = [&](const ensemble::EnsembleProgress& now) { report(now); };
        options.on_refused = [&](const std::string& why) { reporter_.note(why); };
        const auto outcome = run_part(planned_, part, options);
        reporter_.clear();
        const long broken = ranks_.sum(outcome ? 0 : 1);
        const long interrupted = ranks_.sum(outcome && outcome->interrupted ? 1 : 0);
        if (!outcome) return outcome.error();
        if (broken > 0) return Error{"another rank could not make its runs"};
        done_ += outcome->done + outcome->failed;
        return interrupted == 0;
    }

  private:
    /// Of all parts together; each of the ranks tells of its own share.
    void report(const ensemble::EnsembleProgress& now) {
        ensemble::EnsembleProgress all = now;
        all.done = done_ + now.done;
        all.count = std::max(planned_.most_runs() / static_cast<std::size_t>(ranks_.count()), all.done);
        all.share_done = std::min(1.0, (static_cast<double>(done_) + now.share_done * static_cast<double>(now.count)) /
                                           static_cast<double>(all.count));
        const double rate = now.runs_per_minute / 60;
        all.wall_remaining = rate > 0 ? (1 - all.share_done) * static_cast<double>(all.count) / rate : std::nan("");
        reporter_.report([&] { return progress_text(all); }, [&] { return progress_json(all); });
    }

    const design::Design& planned_;
    const DesignArguments& arguments_;
    const SharedThreads& shared_;
    const Ranks& ranks_;
    const InterruptWatch& watch_;
    ThrottledProgress& reporter_;
    std::size_t done_ = 0;
};

std::string result_text(const design::DesignResult& result) {
    std::string text = fmt::format("{:<24}{:>14}{:>14}{:>14}{:>14}{:>14}\n", "line", "least height", "runs pass",
                                   "volume passes", "holds, m3", "m/s at 95 %");
    for (const design::LineResult& line : result.lines) {
        const design::Trial& shown = line.shown();
        text += fmt::format("{:<24}{:>14}{:>13.1f}%{:>13.1f}%{:>14.0f}{:>14.1f}\n", line.line.name.substr(0, 23),
                            line.found ? fmt::format("{:g} m", shown.height) : fmt::format("over {:g} m", shown.height),
                            100 * shown.passing_runs, 100 * shown.passing_volume, line.level.volume, line.speed.p95);
        for (const std::string& odd : line.not_monotone) text += "  not monotone: " + odd + "\n";
    }
    text += "A licensed engineer checks and signs.\n";
    return text + fmt::format("\n{}\n", (result.design->request.folder / "design.html").string());
}

int design_command(const DesignArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    if (Status s = Ranks::check(); !s) return fail(exit_code::bad_input, s.error().message);
    const Ranks ranks;
    // All ranks find the same faults; one of them reports it.
    const auto refuse = [&](int code, const std::string& why) { return ranks.first() ? fail(code, why) : code; };
    const Result<SceneInput> source = open_scene(arguments.scene, arguments.overrides, "", watch);
    if (!source) return refuse(exit_code::bad_input, source.error().message);
    const auto request = read_arguments(arguments, *source);
    if (!request) return refuse(exit_code::bad_input, request.error().message);
    const auto planned = design::plan_design(*request);
    if (!planned) return refuse(exit_code::bad_input, planned.error().message);
    const auto shared = share_threads(arguments.threads, static_cast<int>(planned->runs->count()), ranks.count());
    if (!shared) return refuse(exit_code::bad_input, shared.error().message);

    ThrottledProgress reporter(arguments.quiet || !ranks.first(), arguments.json && ranks.first());
    if (ranks.first()) tell_cost(*planned, arguments, *shared, ranks.count(), watch, reporter);
    const auto result = search(*planned, PartsRunner(*planned, arguments, *shared, ranks, watch, reporter));
    reporter.clear();
    if (!result) return refuse(exit_code::fault, result.error().message);
    if (!*result) {
        return refuse(exit_code::interrupted, "interrupted; the same command resumes from the runs that are complete");
    }
    if (!ranks.first()) return exit_code::success;
    if (const Status written = write_design(**result); !written)
        return fail(exit_code::failure, written.error().message);
    if (arguments.json) {
        nlohmann::ordered_json json = {{"event", "result"}, {"folder", request->folder.string()}};
        json.update(design_results(**result));
        return print_result(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    }
    return arguments.quiet ? exit_code::success : print_result(result_text(**result));
}

}  // namespace

void add_design(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("design", "how high a barrier must be, what it holds and what it must bear");
    const auto a = std::make_shared<DesignArguments>();
    app->add_option("scene", a->scene, "scene file; default: the built-in scene")->type_name("SCENE");
    app->add_option("--barrier", a->barrier, "the barrier of the scene that is designed")
        ->required()
        ->type_name("NAME");
    app->add_option("-o,--output", a->output, "folder; default: talus_out/<scene name>_design")->type_name("DIR");
    app->add_option("--share", a->share, "that may pass, 0 to below 1; default: 0.05")->type_name("SHARE");
    app->add_option("--of", a->of, "of the runs or of their volume; default: runs")
        ->check(CLI::IsMember({"runs", "volume"}))
        ->type_name("WHAT");
    app->add_option("--min-height", a->low, "least height tried; default: 1")->type_name("M");
    app->add_option("--max-height", a->high, "greatest height tried; default: 10")->type_name("M");
    app->add_option("--height-step", a->step, "default: 0.5")->type_name("M");
    app->add_option("--line", a->lines, "another line for the barrier: NAME=x,y x,y ... or NAME=FILE; may be repeated")
        ->type_name("LINE")
        ->allow_extra_args(false);
    app->add_option("--confirm", a->confirm, "repeat the deciding runs with particles; default: none")
        ->check(CLI::IsMember({"particles", "none"}))
        ->type_name("MODEL");
    app->add_option("--boulder-diameter", a->boulder, "of the boulder that hits; without it there is no such load")
        ->type_name("M");
    app->add_option("--deposition-slope", a->slope, "of debris held behind; default: half the ground's slope")
        ->type_name("DEGREES");
    add_sample_options(*app, a->sample, "runs of each height; default: 32");
    add_overrides(*app, a->overrides);
    add_backend(*app, a->overrides);
    add_data_folder(*app, a->data);
    add_thread_options(*app, a->threads, "runs", "all cores; 1 per rank");
    app->add_flag("--retry-failed", a->retry_failed, "repeat runs that failed in an earlier call");
    CLI::Option* quiet = app->add_flag("--quiet", a->quiet, "print only errors");
    app->add_flag("--json", a->json, "cost, progress and result as one JSON object per line on stdout")
        ->excludes(quiet);
    app->footer(help);
    commands.push_back({app, [a] { return design_command(*a); }});
}

}  // namespace talus::cli
