#pragma once

#include <optional>

#include <CLI/CLI.hpp>

#include "core/result.hpp"

namespace talus::cli {

/// What --threads and --parallel-runs ask for.
struct ThreadOptions {
    std::optional<int> threads;        ///< of the machine to use; absent: all cores
    std::optional<int> parallel_runs;  ///< absent: as many as threads
};

/// --threads, and --parallel-runs of a command that computes several runs or cases (`what`).
void add_thread_options(CLI::App& command, ThreadOptions& options, const char* what, const char* default_threads);

struct SharedThreads {
    int runs_at_once, threads_per_run;
};

/// Shares threads among at most `runs` runs, at least one. One run on several threads is slower than as many runs on
/// one thread each. Refuses more runs side by side than threads. By default a process has all cores, and one thread
/// where it is one of several `ranks`.
[[nodiscard]] Result<SharedThreads> share_threads(const ThreadOptions& options, int runs, int ranks = 1);

}  // namespace talus::cli
