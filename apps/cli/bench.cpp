#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "bench/calibration.hpp"
#include "bench/figure.hpp"
#include "bench/grid.hpp"
#include "bench/measure.hpp"
#include "bench/scenes.hpp"
#include "bench/table.hpp"
#include "command.hpp"
#include "core/temporary_folder.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "products/text_file.hpp"
#include "progress.hpp"
#include "scene/builtin.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

struct BenchArguments {
    std::vector<std::string> scenes, methods;  ///< empty: all
    std::vector<int> particles, threads;       ///< empty: the standard ones; all cores
    bool full = false;                         ///< particles up to a million
    bool depth_averaged = false;               ///< that model alone
    int iterations = 4, repeats = 7;
    std::optional<int> steps, warm_up;  ///< absent: depends on the number of particles
    std::string backend = "cpu";
    bool json = false;           ///< for programs, in place of the table
    std::string json_file, svg;  ///< files to write; empty: none
};

constexpr const char* bench_help = R"(
Steps standard scenes with a fixed number of iterations and all components of a run: terrain, friction, viscosity,
houses, maps, front and impact. Scenes:
  slab         ten layers of debris that slide down a plane of raster terrain towards two houses
  column       a block of debris, at most 24 layers high, that collapses on flat ground beside a house
  sham_tseng   600 m3 on the scar of the built-in scene, with its terrain, houses and flow path
The debris of slab and column grows with the number of particles, that of sham_tseng gets finer.
Methods: stress (the default of a scene) and pair (the published friction per pair of particles).

A row of the table is the median of the repeats:
  ms/step      wall time of a step, observers included; the second table has the share of each stage in it, in %
  ns/p-it      wall time per particle and iteration: ms/step over particles times iterations
  Mp-it/s      particle-iterations per second, in millions
  x real time  simulated seconds per second; the time step is chosen as in a run of the scene
  neighbours   mean number of neighbours of a particle
  relative     particle-iterations per unit of a calibration loop that is timed before and after every repeat: it
               changes with the program, but hardly with the load of the machine
  hash         of the state after the last step: the same for any number of threads

Examples:
  talus bench --scene slab --particles 20000 --threads 1,2
  talus bench --depth-averaged --threads 1,2
  talus bench --full --json-file bench.json   up to a million particles, some minutes and 2 GB of memory

Exit codes:
    0  complete
    1  the machine failed: disk full, out of memory
    2  bad input: nothing was computed
    3  a step could not be trusted; nothing was written
  130  interrupted by Ctrl-C; the table shows the complete rows, no file was written
)";

const std::vector<int> usual_particles = {5000, 20000, 75000}, full_particles = {5000, 20000, 75000, 300000, 1000000};

/// The requested measurements, with defaults filled in.
struct Plan {
    std::vector<std::string> scenes, methods;
    std::vector<int> particles, threads;
    bench::Task task;

    explicit Plan(const BenchArguments& arguments)
        : scenes(arguments.scenes),
          methods(arguments.methods),
          particles(arguments.particles),
          threads(arguments.threads) {
        if (scenes.empty()) scenes = bench::scene_names();
        if (methods.empty()) methods = bench::method_names();
        if (particles.empty()) particles = arguments.full ? full_particles : usual_particles;
        if (threads.empty()) threads = {static_cast<int>(std::max(1U, std::thread::hardware_concurrency()))};
        task.iterations = arguments.iterations;
        task.backend = backend_of(arguments.backend);
        task.length = {arguments.repeats, arguments.steps, arguments.warm_up};
    }

    [[nodiscard]] std::size_t row_count() const {
        return scenes.size() * particles.size() * methods.size() * threads.size();
    }
};

/// The rows completed until the end, a problem, or the user's stop.
struct Outcome {
    std::vector<bench::Row> rows;
    int code = exit_code::success;
    std::string problem;
};

Outcome measure_all(const Plan& plan, const fs::path& builtin_scene, const InterruptWatch& watch,
                    ProgressReporter& progress) {
    bench::Calibration calibration;
    Outcome outcome;
    std::vector<bench::Row>& rows = outcome.rows;
    for (const std::string& scene : plan.scenes) {
        for (const int particles : plan.particles) {
            if (watch.stop_requested()) return outcome;
            const Result<bench::Start> start = bench::make_start(scene, particles, builtin_scene);
            if (!start) return {rows, exit_code::failure, start.error().message};
            for (const std::string& method : plan.methods) {
                for (const int threads : plan.threads) {
                    progress.say(fmt::format("row {} of {}: {} {} {}, {} thread{}", rows.size() + 1, plan.row_count(),
                                             scene, particles, method, threads, threads == 1 ? "" : "s"));
                    bench::Task task = plan.task;
                    task.method = bench::method_of(method);
                    task.threads = threads;
                    Result<bench::Row> row = bench::measure(*start, task, calibration, &watch.stop_requested());
                    if (watch.stop_requested()) return outcome;
                    if (!row) return {rows, exit_code::fault, row.error().message};
                    rows.push_back(*std::move(row));
                }
            }
        }
    }
    return outcome;
}

int bench_grid(const Plan& plan, bool json) {
    bench::Calibration calibration;
    std::vector<bench::GridRow> rows;
    for (const int threads : plan.threads) {
        const Result<bench::GridRow> row = bench::measure_grid(threads, plan.task.length.repeats, calibration);
        if (!row) return fail(exit_code::fault, row.error().message);
        rows.push_back(*row);
    }
    return print_result(json ? bench::grid_rows_json(rows) : bench::grid_table_text(rows));
}

int bench_command(const BenchArguments& arguments) {
    InterruptWatch watch;
    if (arguments.depth_averaged) return bench_grid(Plan(arguments), arguments.json);
    for (const std::string& file : {arguments.json_file, arguments.svg}) {
        if (Status s = check_output_file(file); !s) return fail(exit_code::bad_input, s.error().message);
    }
    const Plan plan(arguments);
    const TemporaryFolder unpacked;
    if (unpacked.path().empty()) return fail(exit_code::failure, "cannot make a temporary folder; set TMPDIR");
    watch.remove_at_once(unpacked.path());
    const bool reads_files = std::count(plan.scenes.begin(), plan.scenes.end(), scene::builtin_scene_name) > 0;
    const Result<fs::path> builtin_scene = reads_files ? scene::unpack_builtin_scene(unpacked.path()) : fs::path();
    if (!builtin_scene) return fail(exit_code::failure, builtin_scene.error().message);

    ProgressReporter progress(progress_style(false, arguments.json));
    Outcome outcome;
    try {
        outcome = measure_all(plan, *builtin_scene, watch, progress);
    } catch (const std::bad_alloc&) {
        outcome = {{}, exit_code::failure, "out of memory; ask for fewer --particles"};
    }
    progress.clear();
    if (outcome.code != exit_code::success) return fail(outcome.code, outcome.problem);
    const int printed = print_result(arguments.json ? bench::rows_json(outcome.rows) : bench::table_text(outcome.rows));
    if (watch.stop_requested()) return exit_code::interrupted;
    Status written;
    if (!arguments.json_file.empty()) {
        written = products::write_text_file(arguments.json_file, bench::table_json(outcome.rows));
    }
    if (written && !arguments.svg.empty())
        written = products::write_text_file(arguments.svg, bench::scaling_svg(outcome.rows));
    return written ? printed : fail(exit_code::failure, written.error().message);
}

}  // namespace

void add_bench(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("bench", "measure the speed of talus on standard scenes");
    const auto bench = std::make_shared<BenchArguments>();
    const auto add_list = [app](const std::string& name, auto& values, const std::string& text) {
        return app->add_option(name, values, text)->delimiter(',')->allow_extra_args(false);
    };
    add_list("--scene", bench->scenes, "scenes to step; default: all")
        ->type_name("NAME,NAME")
        ->check(CLI::IsMember(bench::scene_names()));
    CLI::Option* particles = add_list("--particles", bench->particles, "particles; default: 5000,20000,75000")
                                 ->type_name("N,N")
                                 ->check(CLI::Range(bench::min_particles, bench::max_particles));
    app->add_flag("--full", bench->full, "300000 and 1000000 particles too")->excludes(particles);
    add_list("--method", bench->methods, "how internal friction is solved; default: both")
        ->type_name("NAME,NAME")
        ->check(CLI::IsMember(bench::method_names()));
    app->add_option("--iterations", bench->iterations, "solver iterations of a step; default: 4")
        ->type_name("N")
        ->check(CLI::Range(1, 1000));
    app->add_flag("--depth-averaged", bench->depth_averaged, "the depth-averaged model alone, in cell updates")
        ->excludes(particles);
    add_list("--threads", bench->threads, "numbers of threads; default: all cores")
        ->type_name("N,N")
        ->check(CLI::Range(1, 512));
    app->add_option("--backend", bench->backend, "what computes the steps: cpu, cuda, auto or host; default: cpu")
        ->type_name("NAME")
        ->check(usable_backend());
    app->add_option("--repeats", bench->repeats, "repeats to take the median of; default: 7")
        ->type_name("N")
        ->check(CLI::Range(1, 1000));
    app->add_option("--steps", bench->steps, "steps per repeat; default: 10 to 2, by the number of particles")
        ->type_name("N")
        ->check(CLI::Range(1, 100000));
    app->add_option("--warm-up", bench->warm_up, "steps before the first repeat; default: 10 to 3, likewise")
        ->type_name("N")
        ->check(CLI::Range(0, 100000));
    app->add_flag("--json", bench->json, "the rows as one JSON object per line on stdout, in place of the tables");
    app->add_option("--json-file", bench->json_file, "write the rows as a list of objects")->type_name("FILE");
    add_retired_option(*app, "FILE", "is no option; --json prints JSON lines, and --json-file FILE writes the rows");
    app->add_option("--svg", bench->svg, "draw particle-iterations per second against particles")->type_name("FILE");
    app->footer(bench_help);
    commands.push_back({app, [bench] { return bench_command(*bench); }});
}

}  // namespace talus::cli
