#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Runs the built program as its users do, with what it printed and returned.
namespace talus::test {

struct ProgramOptions {
    std::filesystem::path folder = ".";         ///< current folder of the program
    std::vector<std::string> environment = {};  ///< "NAME=value", beside the test's own
    std::filesystem::path out = {};             ///< file that stdout goes to in place of ProgramOutcome::out
    bool error_is_terminal = false;             ///< stderr is a pseudo-terminal of 100 columns
    long largest_file = 0;                      ///< bytes that a file may grow to, as on a full disk; 0: no limit
    std::function<void(int process)> while_running = {};  ///< called once when the program has printed `wait_for`
    std::string wait_for = {};                            ///< text on stdout or stderr
};

struct ProgramOutcome {
    int exit_code = -1;  ///< 128 + the signal when one ended it
    std::string out, error;
};

ProgramOutcome run_program(const std::vector<std::string>& arguments, const ProgramOptions& options = {});

/// Lines of a text, without their ends.
std::vector<std::string> lines_of(const std::string& text);

}  // namespace talus::test
