#pragma once

#include <cstdint>

#include <benchmark/benchmark.h>

namespace talus::benchmarks {

/// A quick check that everything runs.
inline constexpr std::int64_t smallest_size = 2000;

/// The numbers of particles: the smallest, one whose data fit into caches, one beyond.
inline void sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->Arg(smallest_size)->Arg(20000)->Arg(300000)->Unit(benchmark::kMillisecond);
}

}  // namespace talus::benchmarks
