#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "bench/calibration.hpp"
#include "bench/figure.hpp"
#include "bench/measure.hpp"
#include "bench/scenes.hpp"
#include "bench/table.hpp"
#include "commands.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "products/text_file.hpp"
#include "progress.hpp"
#include "scene/builtin.hpp"
#include "temporary_folder.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

const std::vector<int> usual_particles = {5000, 20000, 75000}, full_particles = {5000, 20000, 75000, 300000, 1000000};

/// What was asked for, with the defaults filled in.
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
        task.length = {arguments.repeats, arguments.steps, arguments.warm_up};
    }

    [[nodiscard]] std::size_t row_count() const {
        return scenes.size() * particles.size() * methods.size() * threads.size();
    }
};

/// The rows that were complete until the end, a problem, or the user's stop.
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

}  // namespace

int bench_command(const BenchArguments& arguments) {
    InterruptWatch watch;
    for (const std::string& file : {arguments.json, arguments.svg}) {
        if (Status s = check_output_file(file); !s) return fail(exit_code::bad_input, s.error().message);
    }
    const Plan plan(arguments);
    const TemporaryFolder unpacked;
    if (unpacked.path().empty()) return fail(exit_code::failure, "cannot make a temporary folder; set TMPDIR");
    watch.remove_at_once(unpacked.path());
    const bool reads_files = std::count(plan.scenes.begin(), plan.scenes.end(), builtin_scene_name) > 0;
    const Result<fs::path> builtin_scene = reads_files ? unpack_builtin_scene(unpacked.path()) : fs::path();
    if (!builtin_scene) return fail(exit_code::failure, builtin_scene.error().message);

    ProgressReporter progress(progress_style(false, false));
    Outcome outcome;
    try {
        outcome = measure_all(plan, *builtin_scene, watch, progress);
    } catch (const std::bad_alloc&) {
        outcome = {{}, exit_code::failure, "out of memory; ask for fewer --particles"};
    }
    progress.clear();
    if (outcome.code != exit_code::success) return fail(outcome.code, outcome.problem);
    (void)std::fputs(bench::table_text(outcome.rows).c_str(), stdout);
    if (watch.stop_requested()) return exit_code::interrupted;
    Status written;
    if (!arguments.json.empty()) written = write_text_file(arguments.json, bench::table_json(outcome.rows));
    if (written && !arguments.svg.empty()) written = write_text_file(arguments.svg, bench::scaling_svg(outcome.rows));
    return written ? exit_code::success : fail(exit_code::failure, written.error().message);
}

}  // namespace talus
