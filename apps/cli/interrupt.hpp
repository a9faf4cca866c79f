#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

namespace talus::cli {

/// Turns Ctrl-C (SIGINT, SIGTERM, SIGHUP) into a request to stop; a second one removes the temporary folders and ends
/// the program at once. The signals are taken by a thread that waits for them, so no code runs in a signal handler.
/// Create it before any other thread starts: threads inherit the signal mask.
class InterruptWatch {
  public:
    InterruptWatch();
    ~InterruptWatch();
    InterruptWatch(const InterruptWatch&) = delete;
    InterruptWatch& operator=(const InterruptWatch&) = delete;

    [[nodiscard]] const std::atomic<bool>& stop_requested() const { return stop_requested_; }

    /// Asks the run to end, as the first signal does.
    void request_stop() {
        stop_requested_ = true;
        stop_requested_.notify_all();
    }
    /// Sleeps until a stop is requested.
    void wait() const { stop_requested_.wait(false); }
    /// A folder to remove when the program is ended at once.
    void remove_at_once(const std::filesystem::path& folder);
    /// While held, a second signal waits (two seconds at most) before it ends the program: for renames.
    [[nodiscard]] std::unique_lock<std::timed_mutex> hold() { return std::unique_lock(mutex_); }

  private:
    void watch();
    [[noreturn]] void end_at_once();

    std::atomic<bool> stop_requested_{false}, done_{false};
    std::timed_mutex mutex_;  // guards folders_ and what hold() protects
    std::vector<std::filesystem::path> folders_;
    std::thread thread_;
};

}  // namespace talus::cli
