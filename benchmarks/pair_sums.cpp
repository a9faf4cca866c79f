// The sums over neighbours, one after the other, on one thread: where nearly all of a step's time goes.
#include <benchmark/benchmark.h>

#include "debris.hpp"
#include "sim/physics/friction.hpp"
#include "sizes.hpp"

namespace talus::benchmarks {
namespace {

/// Calls sum(debris, i) for every particle; particles per second.
template <class Sum>
void sum_all(benchmark::State& run, const Sum& sum) {
    Debris& debris = debris_of(run.range(0));
    for (auto _ : run) {
        for (std::uint32_t i = 0; i < debris.count(); ++i) benchmark::DoNotOptimize(sum(debris, i));
    }
    run.SetItemsProcessed(run.iterations() * debris.count());
}

void density(benchmark::State& run) {
    sum_all(run, [](Debris& d, std::size_t i) {
        return d.sums.density(d.scale, d.neighbours.pairs_of(i), d.packed_points, i);
    });
}
BENCHMARK(density)->Apply(sizes);

void density_and_divergence(benchmark::State& run) {
    sum_all(run, [](Debris& d, std::size_t i) {
        return d.sums.density_and_divergence(d.scale, d.neighbours.pairs_of(i), d.packed_points, d.packed_vectors, i);
    });
}
BENCHMARK(density_and_divergence)->Apply(sizes);

void deformation(benchmark::State& run) {
    sum_all(run,
            [](Debris& d, std::size_t i) { return d.sums.deformation(d.neighbours.pairs_of(i), d.packed_vectors, i); });
}
BENCHMARK(deformation)->Apply(sizes);

void stress_correction(benchmark::State& run) {
    sum_all(run, [](Debris& d, std::size_t i) {
        return d.sums.stress_correction(d.neighbours.pairs_of(i), d.stress_rows, d.stress_rest, i);
    });
}
BENCHMARK(stress_correction)->Apply(sizes);

void scalar_correction(benchmark::State& run) {
    sum_all(run, [](Debris& d, std::size_t i) {
        return d.sums.scalar_correction(d.neighbours.pairs_of(i), d.packed_points, i);
    });
}
BENCHMARK(scalar_correction)->Apply(sizes);

void pair_correction(benchmark::State& run) {
    const auto cap =
        static_cast<float>(pair_friction_cap(debris_of(run.range(0)).model().internal_friction_coefficient));
    sum_all(run, [cap](Debris& d, std::size_t i) {
        return d.sums.pair_correction(d.scale, d.neighbours.pairs_of(i), d.packed_points, d.packed_vectors, cap, i);
    });
}
BENCHMARK(pair_correction)->Apply(sizes);

void velocity_difference(benchmark::State& run) {
    sum_all(run, [](Debris& d, std::size_t i) {
        return d.sums.velocity_difference(d.scale, d.neighbours.pairs_of(i), d.packed_points, d.packed_vectors, i);
    });
}
BENCHMARK(velocity_difference)->Apply(sizes);

/// Of every particle, the near ones in its own cell: what the neighbour build calls, mostly on rows of three cells.
void select_near(benchmark::State& run) {
    const Debris& debris = debris_of(run.range(0));
    const cpu::Coordinates points{debris.points.x.data(), debris.points.y.data(), debris.points.z.data()};
    const auto radius = static_cast<float>(debris.model().support_radius);
    std::vector<std::uint32_t> found(debris.count() + VectorArray::padding);
    for (auto _ : run) {
        for (std::size_t cell = 0; cell < debris.grid.cell_count(); ++cell) {
            const std::uint32_t first = debris.grid.start[cell], last = debris.grid.start[cell + 1];
            for (std::uint32_t i = first; i < last; ++i) {
                benchmark::DoNotOptimize(
                    debris.sums.select_near(points, first, last, debris.points.at(i), radius * radius, found.data()));
            }
        }
    }
    run.SetItemsProcessed(run.iterations() * debris.count());
}
BENCHMARK(select_near)->Apply(sizes);

}  // namespace
}  // namespace talus::benchmarks
