// Other stages of a step. Those that a program runs on all cores do so here; the rest runs on one.
#include <benchmark/benchmark.h>

#include "debris.hpp"
#include "observe/observer.hpp"
#include "sim/physics/contact.hpp"
#include "sizes.hpp"

namespace talus::benchmarks {
namespace {

void per_particle(benchmark::State& run, const Debris& debris) {
    run.SetItemsProcessed(run.iterations() * debris.count());
}

void cell_sort(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    cpu::CellSort sort(debris.count());
    cpu::CellGrid grid;
    for (auto _ : run) {
        benchmark::DoNotOptimize(sort.sort(debris.points, debris.count(), debris.model().support_radius, grid).data());
    }
    per_particle(run, debris);
}
BENCHMARK(cell_sort)->Apply(sizes)->UseRealTime();

void neighbour_build(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    cpu::NeighbourLists neighbours(debris.count(), debris.sums);
    for (auto _ : run) {
        neighbours.build(debris.points, debris.grid, static_cast<float>(debris.model().support_radius));
        benchmark::ClobberMemory();
    }
    if (neighbours.of(debris.count() / 2).empty()) run.SkipWithError("no neighbours were found");
    per_particle(run, debris);
}
BENCHMARK(neighbour_build)->Apply(sizes)->UseRealTime();

void sample_all(benchmark::State& run, const Debris& debris, const Model& model) {
    for (auto _ : run) {
        for (std::uint32_t i = 0; i < debris.count(); ++i) {
            benchmark::DoNotOptimize(sample_boundary(model, debris.points.at(i)));
        }
    }
    per_particle(run, debris);
}

void boundary_with_buildings(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    if (debris.model().solids.empty()) run.SkipWithError("there are no buildings");
    sample_all(run, debris, debris.model());
}
BENCHMARK(boundary_with_buildings)->Apply(sizes);

void boundary_of_ground_alone(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    Model bare = debris.model();
    bare.buildings.clear();
    bare.solids = {};
    sample_all(run, debris, bare);
}
BENCHMARK(boundary_of_ground_alone)->Apply(sizes);

void contacts(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    std::vector<ContactMemories<float>> memories(debris.count());
    for (auto _ : run) {
        for (std::uint32_t i = 0; i < debris.count(); ++i) {
            benchmark::DoNotOptimize(resolve_contacts(debris.model(), debris.boundary[i], LocalPoint{},
                                                      debris.displacement.at(i), debris.packed_points[i][3],
                                                      memories[i]));
        }
    }
    per_particle(run, debris);
}
BENCHMARK(contacts)->Apply(sizes);

void swept_test(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    for (auto _ : run) {
        for (std::uint32_t i = 0; i < debris.count(); ++i) {
            benchmark::DoNotOptimize(free_end(debris.model(), debris.points.at(i), debris.displacement.at(i)));
        }
    }
    per_particle(run, debris);
}
BENCHMARK(swept_test)->Apply(sizes);

/// Maps, front and impact, of a state that does not move.
void observe(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    Observer observer(debris.model(), debris.state(), debris.start.flow_path, debris.start.outputs,
                      debris.start.map_cell);
    for (auto _ : run) observer.after_step(debris.model(), debris.state(), 0);
    per_particle(run, debris);
}
BENCHMARK(observe)->Apply(sizes)->UseRealTime();

}  // namespace
}  // namespace talus::benchmarks
