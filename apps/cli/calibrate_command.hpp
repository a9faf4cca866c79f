#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace talus {

struct CalibrateArguments {
    std::string scene;                 ///< a scene file; empty: the built-in scene
    std::string output;                ///< a folder; empty: talus_out/<scene name>_calibration
    std::vector<std::string> factors;  ///< "section.key=distribution"
    std::optional<std::size_t> runs, design, checks;
    std::optional<std::uint64_t> seed;
    std::optional<std::size_t> recover;  ///< so many times with known values
    std::vector<std::string> overrides;  ///< "section.key=value"
    std::string data;                    ///< value of TALUS_DATA; empty: as in the environment
    std::optional<int> threads;
    bool retry_failed = false, quiet = false, json = false;
};

/// Declares `talus calibrate`.
CLI::App* add_calibrate(CLI::App& app, CalibrateArguments& arguments);

/// Returns an exit code; has said on stderr, in one line, what went wrong.
int calibrate_command(const CalibrateArguments& arguments);

}  // namespace talus
