#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace talus {

/// A program to run beside this one.
struct ChildProcess {
    std::filesystem::path program;
    std::vector<std::string> arguments;
    std::filesystem::path folder;  ///< its current folder; empty: that of this program
    int niceness = 0;              ///< added to that of this program
    // What it may take; 0: no limit of its own.
    std::uint64_t memory = 0;                             ///< bytes of address space
    std::chrono::seconds processor_time{0}, patience{0};  ///< of all its threads; by the clock
    std::uint64_t largest_file = 0;                       ///< bytes of a file that it writes
    /// A file that takes its standard output, made anew; empty: on_line does.
    std::filesystem::path output = {};
    /// Asked several times a second: whether it shall end. It is then told so by SIGTERM, again later, and by SIGKILL
    /// at last, or by that alone.
    std::function<bool()> shall_end = {};
    bool end_at_once = false;                              ///< by SIGKILL alone
    std::function<void(const std::string&)> on_line = {};  ///< lines on its standard output, from the caller's thread
};

struct ChildOutcome {
    int exit_code = -1;       ///< -1: it was ended by a signal
    int signal = 0;           ///< 0: none
    bool too_slow = false;    ///< it ran out of its time and was ended
    std::string stderr_tail;  ///< the end of what it wrote to standard error

    [[nodiscard]] bool success() const { return exit_code == 0; }
};

/// Runs it to its end, in a group of its own that Ctrl-C does not reach, with nothing open but the three standard
/// files. It is asked to end when the calling thread ends, however that happens. Error: it cannot be started.
[[nodiscard]] Result<ChildOutcome> run_child(const ChildProcess& child);

/// Whether there is a process of this number.
[[nodiscard]] bool process_lives(long number);

}  // namespace talus
