#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace talus::cpu {

/// Calls f(first, last) on parts of [0, count) in parallel. Parts must not depend on each other.
template <class F>
void parallel_ranges(std::size_t count, std::size_t grain, const F& f) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) { f(range.begin(), range.end()); });
}

/// Reduces [0, count) with f(first, last, value) -> value and join(a, b) -> value. The parts and the order in which
/// they are joined depend on count and grain alone, so that a floating-point sum is the same on any number of threads.
template <class Value, class F, class Join>
Value reduce_ranges(std::size_t count, std::size_t grain, const Value& identity, const F& f, const Join& join) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, count, grain), identity,
        [&](const tbb::blocked_range<std::size_t>& range, Value value) { return f(range.begin(), range.end(), value); },
        join);
}

}  // namespace talus::cpu
