#pragma once

#include <benchmark/benchmark.h>

namespace talus::benchmarks {

/// The numbers of particles: one for a quick look that everything runs, one whose data fit into caches, one beyond.
inline void sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->Arg(2000)->Arg(20000)->Arg(300000)->Unit(benchmark::kMillisecond);
}

}  // namespace talus::benchmarks
