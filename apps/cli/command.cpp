#include "command.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "core/visible_text.hpp"
#include "scene/warning.hpp"
#include "sim/backend_choice.hpp"

namespace talus::cli {

int fail(int code, const std::string& message) {
    std::string line = "talus: error: " + visible(message);
    std::replace(line.begin(), line.end(), '\n', ' ');
    (void)std::fputs((line + "\n").c_str(), stderr);
    return code;
}

void note(const std::string& message) {
    (void)std::fputs(("talus: note: " + visible(message) + "\n").c_str(), stderr);
}

bool print(const std::string& text) {
    if (std::fputs(visible(text).c_str(), stdout) >= 0 && std::fflush(stdout) == 0) return true;
    return errno == EPIPE;
}

bool print_notes(const std::vector<std::string>& notes) {
    const char* const terminal = std::getenv("TERM");
    const bool colours = isatty(STDOUT_FILENO) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb" &&
                         std::getenv("NO_COLOR") == nullptr;
    for (const std::string& note : notes) {
        if (!scene::warning_in(note)) {
            if (!print("note: " + note + "\n")) return false;
        } else if (!colours) {
            if (!print(note + "\n")) return false;
        } else if (std::fputs(("\033[1;31m" + visible(note) + "\033[0m\n").c_str(), stdout) < 0) {
            return errno == EPIPE;
        }
    }
    return true;
}

int print_result(const std::string& text, int code) {
    return print(text) ? code : fail(exit_code::failure, "cannot write to standard output");
}

std::filesystem::path default_output(const std::string& name) {
    return std::filesystem::path("talus_out") / name;
}

Status check_output_file(const std::string& file) {
    if (file.empty()) return {};
    const std::filesystem::path parent = std::filesystem::absolute(file).parent_path();
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) return Error{file + ": is a folder, not a file"};
    if (!std::filesystem::is_directory(parent, error)) {
        return Error{fmt::format("{}: there is no folder {}", file, parent.string())};
    }
    return {};
}

void add_overrides(CLI::App& command, std::vector<std::string>& overrides) {
    command.add_option("--set", overrides, "set a value of the scene; may be repeated")
        ->type_name("SECTION.KEY=VALUE")
        ->allow_extra_args(false);
    // Declared after --set, which would replace the list, but inserted before its values: explicit values take
    // precedence.
    command
        .add_option_function<std::string>(
            "--variant",
            [&overrides](const std::string& name) { overrides.insert(overrides.begin(), "variant=" + name); },
            "take the values of the scene's [[variant]] of that name; --set overrides them")
        ->type_name("NAME");
}

void add_retired_option(CLI::App& command, const std::string& name, const std::string& now) {
    const auto hide = [](CLI::Option* option) { return option->group(""); };
    if (name.starts_with("-")) {
        hide(command.add_flag_callback(name, [name, now] { throw CLI::ValidationError(name, now); }));
    } else {
        hide(command.add_option(name))->each([now](const std::string& word) { throw CLI::ValidationError(word, now); });
    }
}

void add_data_folder(CLI::App& command, std::string& data) {
    command.add_option("--data", data, "folder for ${TALUS_DATA} in the paths of a scene")->type_name("DIR");
}

CLI::Validator usable_backend() {
    const auto problem = [](const std::string& name) -> std::string {
        std::string names;
        for (const params::BackendChoice choice : sim::backend_choices) {
            names += (names.empty() ? "" : ", ") + std::string(sim::backend_name(choice));
            if (sim::backend_name(choice) != name) continue;
            const Status usable = sim::check_backend(choice);
            return usable ? std::string() : usable.error().message;
        }
        return fmt::format("\"{}\" is refused; there are {}", name, names);
    };
    return CLI::Validator(problem, "");
}

params::BackendChoice backend_of(const std::string& name) {
    return *std::find_if(sim::backend_choices.begin(), sim::backend_choices.end(),
                         [&](params::BackendChoice choice) { return sim::backend_name(choice) == name; });
}

void add_backend(CLI::App& command, std::vector<std::string>& overrides) {
    command
        .add_option_function<std::string>(
            "--backend", [&overrides](const std::string& name) { overrides.push_back("solver.backend=" + name); },
            "what moves the particles: cpu, cuda (a graphics card), auto, or host (the card's code on the processor); "
            "default: as in the scene, else cpu")
        ->type_name("NAME")
        ->check(usable_backend());
}

void set_data_folder(const std::string& folder) {
    setenv("TALUS_DATA", folder.c_str(), 1);
}

}  // namespace talus::cli
