#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "commands.hpp"

namespace talus {

int fail(int code, const std::string& message) {
    std::string line = "talus: error: " + message;
    std::replace(line.begin(), line.end(), '\n', ' ');
    (void)std::fputs((line + "\n").c_str(), stderr);
    return code;
}

Status check_output_file(const std::string& file) {
    if (file.empty()) return {};
    const std::filesystem::path parent = std::filesystem::absolute(file).parent_path();
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) return Error{file + ": is a folder, not a file to write"};
    if (!std::filesystem::is_directory(parent, error)) {
        return Error{fmt::format("{}: there is no folder {}", file, parent.string())};
    }
    return {};
}

void set_data_folder(const std::string& folder) {
    setenv("TALUS_DATA", folder.c_str(), 1);
}

}  // namespace talus
