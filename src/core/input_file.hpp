#pragma once

#include <filesystem>

#include "core/result.hpp"

namespace talus {

/// Refuses a pipe, a socket or a device, which the program could wait for or read from without end.
[[nodiscard]] inline Status check_input_file(const std::filesystem::path& file) {
    std::error_code failed;
    const std::filesystem::file_status status = std::filesystem::status(file, failed);
    if (!exists(status) || is_regular_file(status) || is_directory(status)) return {};
    return Error{file.string() + ": is a pipe, a socket or a device; it must be a file"};
}

}  // namespace talus
