#include "thread_options.hpp"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

namespace talus::cli {

void add_thread_options(CLI::App& command, ThreadOptions& options, const char* what, const char* default_threads) {
    command
        .add_option("--threads", options.threads,
                    fmt::format("threads of the machine to use; default: {}", default_threads))
        ->type_name("N")
        ->check(CLI::Range(1, 512));
    command
        .add_option("--parallel-runs", options.parallel_runs,
                    fmt::format("{} computed side by side, which share the threads; default: one on each thread", what))
        ->type_name("N")
        ->check(CLI::Range(1, 512));
}

Result<SharedThreads> share_threads(const ThreadOptions& options, int runs, int ranks) {
    const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const int threads = options.threads.value_or(ranks > 1 ? 1 : cores);
    const int wanted = options.parallel_runs.value_or(threads);
    if (wanted > threads) {
        return Error{
            fmt::format("--parallel-runs = {}: must be from 1 to {}, the number of threads; set --threads for more",
                        wanted, threads)};
    }
    const int at_once = std::max(1, std::min(wanted, runs));
    return SharedThreads{at_once, threads / at_once};
}

}  // namespace talus::cli
