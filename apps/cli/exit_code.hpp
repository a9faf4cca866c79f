#pragma once

/// Exit codes of the program; printed by `talus --help`, used by scripts.
namespace talus::cli::exit_code {

inline constexpr int success = 0;
inline constexpr int failure = 1;        ///< the machine: disk full, out of memory
inline constexpr int bad_input = 2;      ///< the command line, the scene or a file it names
inline constexpr int fault = 3;          ///< a step could not be trusted; results until then are written
inline constexpr int case_failed = 4;    ///< talus validate: a case failed
inline constexpr int interrupted = 130;  ///< Ctrl-C or SIGTERM; results until then are written

}  // namespace talus::cli::exit_code
