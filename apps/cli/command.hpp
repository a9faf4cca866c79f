#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/result.hpp"
#include "exit_code.hpp"
#include "params/spec.hpp"

/// The program's commands, one per file. Each declares its options next to its code.
namespace talus::cli {

struct Command {
    CLI::App* app;             ///< declared; whether it was called
    std::function<int()> run;  ///< returns an exit code; an error has been printed on stderr in one line
};

// Each adds its command to `program`, and to `commands` with its subcommands before it.
void add_run(CLI::App& program, std::vector<Command>& commands);
void add_compare(CLI::App& program, std::vector<Command>& commands);
void add_serve(CLI::App& program, std::vector<Command>& commands);
void add_start(CLI::App& program, std::vector<Command>& commands);
void add_replay(CLI::App& program, std::vector<Command>& commands);
void add_scene(CLI::App& program, std::vector<Command>& commands);
void add_publish(CLI::App& program, std::vector<Command>& commands);
void add_bundle(CLI::App& program, std::vector<Command>& commands);
void add_validate(CLI::App& program, std::vector<Command>& commands);
void add_ensemble(CLI::App& program, std::vector<Command>& commands);
void add_calibrate(CLI::App& program, std::vector<Command>& commands);
void add_design(CLI::App& program, std::vector<Command>& commands);
void add_risk(CLI::App& program, std::vector<Command>& commands);  ///< and options
void add_bench(CLI::App& program, std::vector<Command>& commands);
void add_manual(CLI::App& program, std::vector<Command>& commands);  ///< and completion; they describe all the others

// Options shared by several commands.
void add_overrides(CLI::App& command,
                   std::vector<std::string>& overrides);     ///< --set SECTION.KEY=VALUE, --variant NAME
void add_data_folder(CLI::App& command, std::string& data);  ///< --data DIR
/// --backend NAME, which this machine must have; as an override. To be called after add_overrides().
void add_backend(CLI::App& command, std::vector<std::string>& overrides);
/// The names that --backend takes; refuses one that this machine does not have.
[[nodiscard]] CLI::Validator usable_backend();
/// The backend of a name that usable_backend() accepts.
[[nodiscard]] params::BackendChoice backend_of(const std::string& name);

/// A flag of earlier versions, or where the name has no dashes a word beside the options: not in --help, and refused
/// with what `now` says.
void add_retired_option(CLI::App& command, const std::string& name, const std::string& now);

/// Prints "talus: error: MESSAGE" as exactly one line on stderr and returns `code`.
int fail(int code, const std::string& message);

/// Prints "talus: note: MESSAGE" on stderr: the work goes on.
void note(const std::string& message);

/// Prints on stdout at once, with escapes for what a reader cannot see. False on a full disk, where the text is lost. A
/// reader that has gone, such as `head`, has read what it wanted: that is no failure.
bool print(const std::string& text);
/// Prints the notes of a scene on stdout; warnings among them stand out on a terminal.
bool print_notes(const std::vector<std::string>& notes);
/// Prints a result and returns `code`, or that of a failure if it is lost: a script must be able to tell.
int print_result(const std::string& text, int code = exit_code::success);

/// Where a result of this name goes if the user names no folder.
[[nodiscard]] std::filesystem::path default_output(const std::string& name);

/// Checks in advance, as far as possible, that `file` (empty: none) can be written: a long run must not fail on it.
[[nodiscard]] Status check_output_file(const std::string& file);

/// Sets `${TALUS_DATA}` in scene paths to `folder`. Call before any thread starts.
void set_data_folder(const std::string& folder);

}  // namespace talus::cli
