#include "interrupt.hpp"

#include <chrono>
#include <pthread.h>
#include <signal.h>
#include <system_error>
#include <unistd.h>

#include "exit_code.hpp"

namespace talus::cli {
namespace {

constexpr int wake_signal = SIGUSR1;  // tells the waiting thread that the watch is over

sigset_t watched_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, wake_signal);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        // nohup and background jobs of scripts ignore some of them on purpose; that is preserved.
        struct sigaction current {};
        const bool ignored = sigaction(number, nullptr, &current) == 0 && current.sa_handler == SIG_IGN;
        if (!ignored) sigaddset(&signals, number);
    }
    return signals;
}

}  // namespace

InterruptWatch::InterruptWatch() {
    const sigset_t signals = watched_signals();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    thread_ = std::thread([this] { watch(); });
}

InterruptWatch::~InterruptWatch() {
    done_ = true;
    pthread_kill(thread_.native_handle(), wake_signal);
    thread_.join();
}

void InterruptWatch::remove_at_once(const std::filesystem::path& folder) {
    const auto lock = hold();
    folders_.push_back(folder);
}

void InterruptWatch::watch() {
    const sigset_t signals = watched_signals();
    int number = 0;
    while (sigwait(&signals, &number) == 0 && !done_) {
        if (number == wake_signal) continue;
        if (stop_requested_.exchange(true)) end_at_once();
        stop_requested_.notify_all();
    }
}

void InterruptWatch::end_at_once() {
    std::unique_lock lock(mutex_, std::defer_lock);
    (void)lock.try_lock_for(std::chrono::seconds(2));
    for (const auto& folder : folders_) {
        // The main thread may still be writing into it: a file created during the removal needs another attempt.
        for (int attempt = 0; attempt < 5; ++attempt) {
            std::error_code error;
            std::filesystem::remove_all(folder, error);
            if (!error) break;
        }
    }
    _exit(exit_code::interrupted);
}

}  // namespace talus::cli
