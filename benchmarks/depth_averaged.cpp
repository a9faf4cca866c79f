// The depth-averaged model from command to map: ground and debris, a step with what is measured of it, results, and
// files.
#include <algorithm>
#include <cmath>
#include <memory>

#include <benchmark/benchmark.h>

#include "core/temporary_folder.hpp"
#include "products/products.hpp"
#include "run/depth_run.hpp"
#include "sizes.hpp"

namespace talus::benchmarks {
namespace {

/// A valley of 25 degrees with as many cells of 2 m, three times as long as wide, and a slab of debris in its upper
/// part that is still flowing when it is measured.
std::unique_ptr<scene::Scene> valley_scene(std::int64_t cells) {
    constexpr double cell = 2;
    const int rows = std::max(20, static_cast<int>(std::sqrt(static_cast<double>(cells) / 3))), columns = 3 * rows;
    Grid<float> grid(GridGeometry{0, 0, cell, columns, rows});
    const double width = rows * cell, length = columns * cell;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const PlanPoint p = grid.geometry.centre(column, row);
            grid.at(column, row) =
                static_cast<float>(1000 - p.x * std::tan(25 * M_PI / 180) + 20 * std::pow(2 * p.y / width - 1, 2));
        }
    }
    auto scene = std::make_unique<scene::Scene>();
    scene->file = "valley.toml";
    scene->terrain = terrain::Terrain(std::move(grid));
    terrain::Release release;
    release.name = "slab";
    const double x0 = 0.05 * length, x1 = 0.3 * length, y0 = 0.3 * width, y1 = 0.7 * width;
    release.patches.push_back({{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}}, 2});
    release.volume = release_volume(scene->terrain, release);
    scene->releases.push_back(std::move(release));
    scene->flow_path = terrain::FlowPath({{x0, width / 2}, {length - cell, width / 2}}, 0.4 * width);
    params::SolverSpec& solver = scene->spec.solver;
    solver.model = params::ModelChoice::depth_averaged;
    solver.grid_cell = cell;
    solver.thread_count = 0;
    solver.stop_moving_share = 0;
    solver.end_time = 1e9;
    scene->spec.material.friction_coefficient = 0.3;
    return scene;
}

constexpr int grid_steps_before = 30;

void per_cell(benchmark::State& run, const scene::Scene& scene) {
    run.SetItemsProcessed(run.iterations() * static_cast<std::int64_t>(scene.terrain.elevation().geometry.size()));
}

run::DepthRun started(const scene::Scene& scene, const run::RunOptions& options) {
    run::DepthRun run = std::move(*run::DepthRun::start(scene, options));
    for (int step = 0; step < grid_steps_before; ++step) run.advance();
    return run;
}

void grid_seed(benchmark::State& run) {
    const auto scene = valley_scene(run.range(0));
    const run::RunOptions options;
    for (auto _ : run) benchmark::DoNotOptimize(run::DepthRun::start(*scene, options));
    per_cell(run, *scene);
}
BENCHMARK(grid_seed)->Apply(sizes)->UseRealTime();

/// With its inflows, measurements and checks.
void grid_step(benchmark::State& run) {
    const auto scene = valley_scene(run.range(0));
    const run::RunOptions options;
    auto flow = started(*scene, options);
    for (auto _ : run) {
        if (!flow.advance()) run.SkipWithError("the debris has left");
    }
    per_cell(run, *scene);
}
// As many steps for every size: debris leaves the valley in the end.
BENCHMARK(grid_step)->Apply(sizes)->UseRealTime()->Iterations(30);

void grid_finish(benchmark::State& run) {
    const auto scene = valley_scene(run.range(0));
    const run::RunOptions options;
    auto flow = started(*scene, options);
    for (auto _ : run) benchmark::DoNotOptimize(flow.finish());
    per_cell(run, *scene);
}
BENCHMARK(grid_finish)->Apply(sizes)->UseRealTime();

/// Every file of a result: maps, vectors, tables and report.
void grid_products(benchmark::State& run) {
    const auto scene = valley_scene(run.range(0));
    const run::RunOptions options;
    const run::RunResult result = started(*scene, options).finish();
    const TemporaryFolder folder;
    for (auto _ : run) {
        if (!products::write_products(*scene, result, folder.path())) run.SkipWithError("the files were not written");
    }
    per_cell(run, *scene);
}
BENCHMARK(grid_products)->Apply(sizes)->UseRealTime();

}  // namespace
}  // namespace talus::benchmarks
