#pragma once

/// What the program returns; printed by `talus --help`, relied upon by scripts.
namespace talus::exit_code {

inline constexpr int success = 0;
inline constexpr int failure = 1;        ///< the machine: disk full, out of memory
inline constexpr int bad_input = 2;      ///< the command line, the scene or a file it names
inline constexpr int fault = 3;          ///< a step could not be trusted; what was computed until then is written
inline constexpr int case_failed = 4;    ///< talus validate: a case failed
inline constexpr int interrupted = 130;  ///< Ctrl-C or SIGTERM; what was computed until then is written

}  // namespace talus::exit_code
