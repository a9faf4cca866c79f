#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace talus {

/// Seconds of wall time since it was made.
class StopWatch {
  public:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A part of some work, and the wall time that it took.
struct Phase {
    std::string name;
    double seconds = 0;
};

/// Times the parts of some work. Parts may run beside each other: their times then add up to more than passed.
class PhaseTimes {
  public:
    /// Parts are listed in the order in which they are named.
    explicit PhaseTimes(std::vector<Phase> phases = {}) : phases_(std::move(phases)) {}

    /// Returns what `work` does, and adds its time to a part. From any thread.
    template <class Work>
    auto time(std::string_view name, const Work& work) {
        const StopWatch watch;
        auto done = work();
        add(name, watch.seconds());
        return done;
    }
    void add(std::string_view name, double seconds) {
        const std::lock_guard lock(mutex_);
        for (Phase& phase : phases_) {
            if (phase.name != name) continue;
            phase.seconds += seconds;
            return;
        }
        phases_.push_back({std::string(name), seconds});
    }
    [[nodiscard]] std::vector<Phase> all() const {
        const std::lock_guard lock(mutex_);
        return phases_;
    }

  private:
    mutable std::mutex mutex_;
    std::vector<Phase> phases_;
};

}  // namespace talus
