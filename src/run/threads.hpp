#pragma once

#include <optional>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace talus {

/// The threads that one piece of work has: everything that computes in parallel does so within one of these, so that
/// several in a program do not slow each other.
class Threads {
  public:
    /// As many as the processor has for a `wanted` of 0.
    explicit Threads(int wanted = 0);

    [[nodiscard]] int count() const { return count_; }
    /// Does the work with these threads, of which the caller's is one; what it returns.
    template <class Work>
    decltype(auto) execute(Work&& work) const {
        return arena_.execute(work);
    }

  private:
    int count_;
    // More threads than the processor has take more than an arena. Of several such limits in a program the least holds,
    // for all of it: none is set for fewer threads, which would hold back whatever else computes.
    std::optional<tbb::global_control> limit_;
    mutable tbb::task_arena arena_;
};

}  // namespace talus
