#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace talus::simd {

/// Tells the thread sanitizer what it cannot see in an uninstrumented TBB: a task comes after what the caller did
/// before, and what the caller does next comes after every task. Empty in other builds.
class TaskOrder {
  public:
#if defined(__SANITIZE_THREAD__)
    void enter() {
        __tsan_acquire(this);
    }
    void leave() {
        __tsan_release(this);
    }
#else
    void enter() {}
    void leave() {}
#endif
};

/// Calls f(first, last) on parts of [0, count) in parallel. Parts must not depend on each other.
template <class F>
void parallel_ranges(std::size_t count, std::size_t grain, const F& f) {
    TaskOrder order;
    order.leave();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          order.enter();
                          f(range.begin(), range.end());
                          order.leave();
                      });
    order.enter();
}

/// Reduces [0, count) with f(first, last, value) -> value and join(a, b) -> value. The parts and the order in which
/// they are joined depend on count and grain alone, so that a floating-point sum is the same on any number of threads.
template <class Value, class F, class Join>
Value reduce_ranges(std::size_t count, std::size_t grain, const Value& identity, const F& f, const Join& join) {
    TaskOrder order;
    order.leave();
    const Value result = tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, count, grain), identity,
        [&](const tbb::blocked_range<std::size_t>& range, Value value) {
            order.enter();
            value = f(range.begin(), range.end(), value);
            order.leave();
            return value;
        },
        [&](const Value& a, const Value& b) {
            order.enter();
            const Value joined = join(a, b);
            order.leave();
            return joined;
        });
    order.enter();
    return result;
}

}  // namespace talus::simd
