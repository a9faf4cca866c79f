#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/result.hpp"

/// The program's commands, one per file. Each declares its options beside what it does.
namespace talus {

struct Command {
    CLI::App* app;             ///< declared; whether it was called
    std::function<int()> run;  ///< returns an exit code; has said on stderr, in one line, what went wrong
};

// Each adds its command to `program`, and to `commands` with its subcommands before it.
void add_run(CLI::App& program, std::vector<Command>& commands);
void add_serve(CLI::App& program, std::vector<Command>& commands);
void add_replay(CLI::App& program, std::vector<Command>& commands);
void add_scene(CLI::App& program, std::vector<Command>& commands);
void add_validate(CLI::App& program, std::vector<Command>& commands);
void add_ensemble(CLI::App& program, std::vector<Command>& commands);
void add_calibrate(CLI::App& program, std::vector<Command>& commands);
void add_bench(CLI::App& program, std::vector<Command>& commands);

// What several commands share.
void add_overrides(CLI::App& command,
                   std::vector<std::string>& overrides);     ///< --set SECTION.KEY=VALUE, --variant NAME
void add_data_folder(CLI::App& command, std::string& data);  ///< --data DIR

/// Prints "talus: error: MESSAGE" as exactly one line on stderr and returns `code`.
int fail(int code, const std::string& message);

/// Whether `file` (empty: none) can be written as far as one sees beforehand: it must not come up after half an hour.
[[nodiscard]] Status check_output_file(const std::string& file);

/// Makes `${TALUS_DATA}` in scene paths mean `folder`. Call before any thread starts.
void set_data_folder(const std::string& folder);

}  // namespace talus
