#pragma once

#include <memory>
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
    /// As many others.
    Threads(const Threads& other) : Threads(other.count_) {}
    Threads& operator=(const Threads&) = delete;
    Threads(Threads&&) noexcept = default;
    Threads& operator=(Threads&&) noexcept = default;
    ~Threads() = default;

    [[nodiscard]] int count() const { return count_; }
    /// Executes the work on these threads, including the caller's, and returns its result.
    template <class Work>
    decltype(auto) execute(Work&& work) const {
        return arena_->execute(work);
    }

  private:
    /// Keeps the arena for the next piece of work with as many threads: oneTBB (2021.8) holds on to some 4 KiB per
    /// thread of each arena that ends, and a session has a new run with every restart.
    struct Keep {
        void operator()(tbb::task_arena* arena) const;
    };
    using Arena = std::unique_ptr<tbb::task_arena, Keep>;
    static Arena arena_of(int count);

    int count_;
    // More threads than the processor has need more than an arena. The smallest of several such limits applies to the
    // whole program, so none is set for fewer threads: it would slow all other computation.
    std::optional<tbb::global_control> limit_;
    Arena arena_;
};

}  // namespace talus::run
