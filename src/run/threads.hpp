#pragma once

#include <optional>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace talus::run {

/// The threads of one piece of work: all parallel computation takes place within one of these, so that several in a
/// program do not slow each other down.
class Threads {
  public:
    /// As many as the processor has for a `wanted` of 0.
    explicit Threads(int wanted = 0);

    [[nodiscard]] int count() const { return count_; }
    /// Executes the work on these threads, including the caller's, and returns its result.
    template <class Work>
    decltype(auto) execute(Work&& work) const {
        return arena_.execute(work);
    }

  private:
    int count_;
    // More threads than the processor has need more than an arena. The smallest of several such limits applies to the
    // whole program, so none is set for fewer threads: it would slow all other computation.
    std::optional<tbb::global_control> limit_;
    mutable tbb::task_arena arena_;
};

}  // namespace talus::run
