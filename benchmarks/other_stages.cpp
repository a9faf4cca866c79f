// Finding neighbours and observing, on all cores as in a step; boundaries, one particle after the other on one thread.
#include <benchmark/benchmark.h>

#include "debris.hpp"
#include "observe/observer.hpp"
#include "sim/physics/contact.hpp"
#include "sizes.hpp"
#include "terrain/map_cell.hpp"

namespace talus::benchmarks {
namespace {

void per_particle(benchmark::State& run, const Debris& debris) {
    run.SetItemsProcessed(run.iterations() * debris.state().count);
}

/// What sorts debris by cell, and its grid.
struct Sorted {
    explicit Sorted(const Debris& debris)
        : sort(debris.state().count),
          by_cell(sort.sort(debris.state().position, debris.state().count, debris.model().support_radius, grid)) {}

    sim::cpu::CellSort sort;
    sim::cpu::CellGrid grid;
    std::span<const std::uint32_t> by_cell;
};

void cell_sort(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    Sorted sorted(debris);
    for (auto _ : run) {
        benchmark::DoNotOptimize(
            sorted.sort.sort(debris.state().position, debris.state().count, debris.model().support_radius, sorted.grid)
                .data());
    }
    per_particle(run, debris);
}
BENCHMARK(cell_sort)->Apply(sizes)->UseRealTime();

void find_neighbours(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    const Sorted sorted(debris);
    sim::cpu::NeighbourSearch search(debris.state().count);
    for (auto _ : run) {
        benchmark::DoNotOptimize(search
                                     .find(debris.state().position, sorted.by_cell, debris.state().asleep, sorted.grid,
                                           static_cast<float>(debris.model().support_radius))
                                     .awake);
    }
    per_particle(run, debris);
}
BENCHMARK(find_neighbours)->Apply(sizes)->UseRealTime();

void write_neighbours(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    const Sorted sorted(debris);
    sim::cpu::NeighbourSearch search(debris.state().count);
    sim::cpu::NeighbourLists lists(debris.state().count);
    (void)search.find(debris.state().position, sorted.by_cell, debris.state().asleep, sorted.grid,
                      static_cast<float>(debris.model().support_radius));
    for (auto _ : run) {
        search.write(lists);
        benchmark::ClobberMemory();
    }
    if (lists.count_of(debris.state().count / 2) == 0) run.SkipWithError("no neighbours were found");
    per_particle(run, debris);
}
BENCHMARK(write_neighbours)->Apply(sizes)->UseRealTime();

/// Maps, front and impact, of a state that does not move.
void observe(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    observe::Observer observer(
        debris.model(), debris.ground(), debris.state(), debris.start.flow_path, debris.start.outputs,
        terrain::default_map_cell(debris.ground().terrain.cell(), debris.model().particle_spacing));
    for (auto _ : run) observer.after_step(debris.model(), debris.ground(), debris.state(), 0);
    per_particle(run, debris);
}
BENCHMARK(observe)->Apply(sizes)->UseRealTime();

void sample_all(benchmark::State& run, const Debris& debris, const sim::Ground& ground) {
    const sim::State& state = debris.state();
    for (auto _ : run) {
        for (std::uint32_t i = 0; i < state.count; ++i) {
            benchmark::DoNotOptimize(sample_boundary(debris.model(), ground, state.position.at(i)));
        }
    }
    per_particle(run, debris);
}

void boundary_with_buildings(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    if (debris.ground().solids.empty()) run.SkipWithError("there are no buildings");
    sample_all(run, debris, debris.ground());
}
BENCHMARK(boundary_with_buildings)->Apply(sizes);

void boundary_of_ground_alone(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    sample_all(run, debris, sim::Ground(debris.ground().terrain));
}
BENCHMARK(boundary_of_ground_alone)->Apply(sizes);

/// Contact with ground and walls; each time as in the first iteration of a step.
void contacts_one_by_one(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    const sim::State& state = debris.state();
    const auto dt = static_cast<float>(state.time_step);
    std::vector<sim::Boundary<float>> boundary(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i)
        boundary[i] = sample_boundary(debris.model(), debris.ground(), state.position.at(i));
    for (auto _ : run) {
        for (std::uint32_t i = 0; i < state.count; ++i) {
            sim::ContactMemories<float> memories;
            benchmark::DoNotOptimize(resolve_contacts(debris.model(), boundary[i], LocalPoint{},
                                                      state.velocity.at(i) * dt, state.multiplier[i],
                                                      sim::uniform_grip<float>(debris.model()), memories));
        }
    }
    per_particle(run, debris);
}
BENCHMARK(contacts_one_by_one)->Apply(sizes);

void free_end_one_by_one(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    const sim::State& state = debris.state();
    const auto dt = static_cast<float>(state.time_step);
    for (auto _ : run) {
        for (std::uint32_t i = 0; i < state.count; ++i) {
            benchmark::DoNotOptimize(
                free_end(debris.model(), debris.ground(), state.position.at(i), state.velocity.at(i) * dt));
        }
    }
    per_particle(run, debris);
}
BENCHMARK(free_end_one_by_one)->Apply(sizes);

}  // namespace
}  // namespace talus::benchmarks
