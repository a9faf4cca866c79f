#pragma once

#include <filesystem>
#include <string_view>

#include "core/result.hpp"

namespace talus {

/// Writes a whole file. A full disk shows at the latest when the file is closed, so that is checked too.
/// Errors name the file and the cause; what was written of it is deleted.
[[nodiscard]] Status write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace talus
