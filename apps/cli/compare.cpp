#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.hpp"
#include "core/hash.hpp"
#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "layers.hpp"
#include "products/products.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "progress.hpp"
#include "report/second_opinion.hpp"
#include "run/run_scene.hpp"
#include "run/second_opinion.hpp"
#include "run/variants.hpp"
#include "run/verdict.hpp"
#include "run/words.hpp"
#include "scene/builtin.hpp"
#include "scene_input.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* compare_help = R"(
Runs the scene with particles and with the depth-averaged model, a second opinion that costs seconds. The result folder
holds one page, report.html: where the models differ, the largest differences first; maps of peak depth, speed and
dynamic pressure of both and their differences; the agreement of the affected area, front and run-out, the structures
hit. results.json has the same as data. The folders particles and depth_averaged hold the whole result of each run.
)";

/// Wall time of the depth-averaged run over that of the particles, before it is known: that of the built-in scene.
constexpr double depth_averaged_effort = 0.3;

struct CompareArguments {
    std::string scene, output, layers, data;
    bool force = false, quiet = false, json = false;
    std::optional<int> threads;
    std::vector<std::string> overrides;
};

struct ComparisonJob {
    SceneInput input;         ///< for the particles
    scene::Scene grid_scene;  ///< the same for the depth-averaged model
    fs::path shown;
    products::OutputFolder output;
};

Result<ComparisonJob> open_comparison(const CompareArguments& arguments, InterruptWatch& watch) {
    std::vector<std::string> overrides = arguments.overrides;
    if (arguments.threads) overrides.push_back(fmt::format("solver.thread_count={}", *arguments.threads));
    overrides.emplace_back("solver.model=particles");
    TALUS_ASSIGN(auto input, open_scene(arguments.scene, overrides, arguments.layers, watch));
    std::vector<std::string> of_grid = input.source.overrides;
    of_grid.emplace_back("solver.model=depth_averaged");
    TALUS_ASSIGN(auto grid_scene, scene::load_scene(input.source.file, of_grid));
    name_originals(grid_scene, input.originals);
    leave_out_zoom(input.scene, "talus compare");
    if (input.unpacked) {
        name_unpacked_files(input.scene, input.unpacked->path(), input.name);
        name_unpacked_files(grid_scene, input.unpacked->path(), input.name);
    }
    const fs::path shown =
        arguments.output.empty() ? default_output(input.short_name + "_compared") : fs::path(arguments.output);
    TALUS_ASSIGN(auto output, products::OutputFolder::create(shown, arguments.force));
    watch.remove_at_once(output.path());
    return ComparisonJob{std::move(input), std::move(grid_scene), shown, std::move(output)};
}

Status write_all(ComparisonJob& job, const report::BothModels& models, const run::SecondOpinion& opinion,
                 const report::Json& results, InterruptWatch& watch) {
    const fs::path folder = job.output.path();
    for (const auto& [name, scene, result] :
         {std::tuple{"particles", &models.scene, &models.particles},
          std::tuple{"depth_averaged", &models.grid_scene, &models.depth_averaged}}) {
        std::error_code failed;
        fs::create_directory(folder / name, failed);
        if (failed) return Error{fmt::format("{}: {}", (folder / name).string(), failed.message())};
        TALUS_TRY(products::write_products(*scene, *result, folder / name));
    }
    TALUS_TRY(products::write_results(results, folder / "results.json"));
    TALUS_ASSIGN(const auto page, report::second_opinion_report(models, opinion, results));
    TALUS_TRY(products::write_text_file(folder / "report.html", page));
    const auto lock = watch.hold();
    return job.output.commit();
}

std::string text_of(const report::BothModels& models, const std::vector<std::string>& differences,
                    const fs::path& shown) {
    std::string text = models.scene.spec.scene.title + "\n";
    for (const auto& [name, result] :
         {std::pair{"particles", &models.particles}, {"depth-averaged", &models.depth_averaged}}) {
        const run::RunVerdict verdict = judge(*result);
        if (!verdict.within_limits()) text += fmt::format("  {} {}\n", name, run::uncapitalised(verdict.text()));
        for (const std::string& warning : verdict.warnings()) text += "    " + warning + "\n";
    }
    for (const std::string& sentence : differences) text += "  " + sentence + "\n";
    return text + fmt::format("  particles {:.1f} s, depth-averaged {:.1f} s of wall time\n  report {}\n",
                              models.particles.wall_time, models.depth_averaged.wall_time,
                              (shown / "report.html").string());
}

std::string json_of(const report::BothModels& models, const report::Json& results, const fs::path& output) {
    const auto run = [](const run::RunResult& result) {
        return report::Json{
            {"status", products::status_text(result.status)},
            {"verdict", verdict_json(judge(result))},
            {"hash", to_hex(result.hash)},
            {"wall_time_s", result.wall_time},
            {"run_out_along_flow_m", number_or_null<report::Json>(result.observation.run_out.along_flow)}};
    };
    const report::Json event = {{"event", "result"},
                                {"output", output.string()},
                                {"agreement", results["agreement"]},
                                {"differences", results["differences"]},
                                {"particles", run(models.particles)},
                                {"depth_averaged", run(models.depth_averaged)}};
    return event.dump(-1, ' ', false, report::Json::error_handler_t::replace) + "\n";
}

int compare_command(const CompareArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    ProgressReporter progress(progress_style(arguments.quiet, arguments.json));
    auto job = open_comparison(arguments, watch);
    if (!job) return fail(exit_code::bad_input, job.error().message);
    if (!arguments.quiet && !arguments.json) {
        for (const std::string& note : job->grid_scene.notes) (void)print(fmt::format("note: {}\n", note));
    }
    run::RunOptions options;
    options.stop_requested = &watch.stop_requested();
    run::SeriesClock clock({{.name = "depth-averaged", .overrides = {}, .effort = depth_averaged_effort}});
    options.on_progress = [&](const run::Progress& now) {
        run::SeriesProgress both = clock.at(now);
        if (both.run == 1) both.name = "particles";
        progress.report(now, both);
    };
    auto particles = run_scene(job->input.scene, options);
    progress.clear();
    if (!particles) return fail(exit_code::bad_input, particles.error().message);
    clock.base_ended(*particles);
    auto grid = run_scene(job->grid_scene, options);
    progress.clear();
    if (!grid) return fail(exit_code::bad_input, grid.error().message);
    take_one_path(job->input.scene, *particles, job->grid_scene, *grid);

    progress.say("writing maps, tables and reports");
    const report::BothModels models{job->input.scene, *particles, job->grid_scene, *grid};
    const run::SecondOpinion opinion = second_opinion(job->input.scene, *particles, *grid);
    const report::Json results = second_opinion_results(models, opinion);
    const Status written = write_all(*job, models, opinion, results, watch);
    progress.clear();
    if (!written) return fail(exit_code::failure, written.error().message);

    std::string summary;
    if (arguments.json) {
        summary = json_of(models, results, job->output.final_path());
    } else if (!arguments.quiet) {
        summary = text_of(models, differences(models, opinion), job->shown);
    }
    const auto any = [&](run::RunStatus status) { return particles->status == status || grid->status == status; };
    const int printed =
        print_result(summary, any(run::RunStatus::interrupted) ? exit_code::interrupted : exit_code::success);
    if (!any(run::RunStatus::fault)) return printed;
    const run::RunResult& faulty = particles->status == run::RunStatus::fault ? *particles : *grid;
    return fail(exit_code::fault, fmt::format("{}; the results so far are in {}, marked partial", faulty.stop_reason,
                                              job->shown.string()));
}

}  // namespace

void add_compare(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("compare", "run a scene with both models and write where they differ");
    const auto compare = std::make_shared<CompareArguments>();
    app->add_option("scene", compare->scene, "scene file; default: the built-in scene")->type_name("SCENE");
    app->add_option("-o,--output", compare->output, "result folder; default: talus_out/<scene name>_compared")
        ->type_name("DIR");
    app->add_flag("--force", compare->force, "replace the result folder if it exists");
    app->add_option("--threads", compare->threads, "number of threads; default: all cores; does not affect the result")
        ->type_name("N");
    add_overrides(*app, compare->overrides);
    add_layers(*app, compare->layers, false);
    add_data_folder(*app, compare->data);
    CLI::Option* quiet = app->add_flag("--quiet", compare->quiet, "print only errors");
    app->add_flag("--json", compare->json, "progress and result as one JSON object per line on stdout")
        ->excludes(quiet);
    app->footer(compare_help);
    commands.push_back({app, [compare] { return compare_command(*compare); }});
}

}  // namespace talus::cli
