// A live scenario: its step compared with that of a plain run, and its frames.
#include "twin/live_run.hpp"

#include <cmath>
#include <map>
#include <memory>

#include <benchmark/benchmark.h>

#include "run/run.hpp"
#include "sizes.hpp"
#include "twin/scenario.hpp"

namespace talus::benchmarks {
namespace {

/// A plane of 20 degrees, 1600 m long, with 2400 m2 of it released, 2 m thick: it keeps sliding.
std::shared_ptr<const scene::Scene> plane_scene(std::int64_t particles) {
    Grid<float> grid(GridGeometry{0, 0, 4, 400, 100});
    for (int row = 0; row < grid.geometry.rows; ++row) {
        for (int column = 0; column < grid.geometry.columns; ++column) {
            grid.at(column, row) = static_cast<float>(600 - 4 * column * std::tan(M_PI / 9));
        }
    }
    scene::Scene scene;
    scene.file = "plane.toml";
    scene.terrain = terrain::Terrain(std::move(grid));
    terrain::Release release;
    release.name = "slab";
    release.patches.push_back({{{{40, 180}, {100, 180}, {100, 220}, {40, 220}}, {}}, 2});
    release.volume = release_volume(scene.terrain, release);
    scene.releases.push_back(std::move(release));
    scene.flow_path = terrain::FlowPath({{20, 200}, {1580, 200}}, 60);
    scene.spec.solver.target_particle_count = static_cast<int>(particles);
    scene.spec.solver.stop_moving_share = 0;
    scene.spec.solver.end_time = 1e9;
    scene.spec.material.friction_coefficient = 0.3;
    return std::make_shared<const scene::Scene>(std::move(scene));
}

constexpr int steps_before = 100;

/// Moving debris, created once per number of particles.
twin::Scenario& scenario_of(std::int64_t particles) {
    static std::map<std::int64_t, std::unique_ptr<twin::Scenario>> made;
    auto& scenario = made[particles];
    if (!scenario) {
        scenario = std::move(*twin::Scenario::open(plane_scene(particles)));
        for (int step = 0; step < steps_before; ++step) scenario->advance();
    }
    return *scenario;
}

void live_step(benchmark::State& run) {
    const auto scenario = std::move(*twin::Scenario::open(plane_scene(run.range(0))));
    for (int step = 0; step < steps_before; ++step) scenario->advance();
    for (auto _ : run) scenario->advance();
}
BENCHMARK(live_step)->Apply(sizes)->UseRealTime();

/// The same step of the same debris in a plain run.
void plain_step(benchmark::State& run) {
    const auto plain = std::move(*run::Run::start(*plane_scene(run.range(0))));
    for (int k = 0; k < steps_before; ++k) (void)plain->advance();
    for (auto _ : run) benchmark::DoNotOptimize(plain->advance());
}
BENCHMARK(plain_step)->Apply(sizes)->UseRealTime();

/// The current frame, for which the steps wait.
void live_frame_made(benchmark::State& run) {
    const twin::Scenario& scenario = scenario_of(run.range(0));
    for (auto _ : run) benchmark::DoNotOptimize(scenario.run().frame(1, 0));
}
BENCHMARK(live_frame_made)->Apply(sizes)->UseRealTime();

/// The same as sent: compressed, by another thread.
void live_frame(benchmark::State& run) {
    const twin::Scenario& scenario = scenario_of(run.range(0));
    const twin::FramePtr frame = scenario.run().frame(1, 0);
    std::size_t bytes = 0;
    for (auto _ : run) bytes = twin::encode(*frame, 0).size();
    run.counters["bytes"] = static_cast<double>(bytes);
    run.counters["bytes_per_particle"] = static_cast<double>(bytes) / static_cast<double>(run.range(0));
}
BENCHMARK(live_frame)->Apply(sizes)->UseRealTime();

/// A wall of 60 m added in moving debris, and removed again.
void live_barrier(benchmark::State& run) {
    twin::Scenario& scenario = scenario_of(run.range(0));
    for (auto _ : run) {
        const auto done = scenario.apply(
            {{"action", "put_barrier"}, {"line", {{90, 170}, {90, 230}}}, {"height_m", 4}, {"thickness_m", 2}},
            "benchmark");
        if (!done) return run.SkipWithError(done.error().message.c_str());
        (void)scenario.apply({{"action", "undo"}}, "benchmark");
    }
}
BENCHMARK(live_barrier)->Apply(sizes)->UseRealTime();

/// A release of 240 m2, drawn and undone.
void live_release(benchmark::State& run) {
    twin::Scenario& scenario = scenario_of(run.range(0));
    for (auto _ : run) {
        const auto done = scenario.apply({{"action", "put_release"},
                                          {"polygon", {{400, 190}, {412, 190}, {412, 210}, {400, 210}}},
                                          {"thickness_m", 2}},
                                         "benchmark");
        if (!done) return run.SkipWithError(done.error().message.c_str());
        (void)scenario.apply({{"action", "undo"}}, "benchmark");
    }
}
BENCHMARK(live_release)->Apply(sizes)->UseRealTime();

}  // namespace
}  // namespace talus::benchmarks
