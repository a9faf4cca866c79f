#pragma once

#include <filesystem>
#include <string_view>

#include "core/result.hpp"

namespace talus::products {

/// Writes a whole file. A full disk may be reported only when the file is closed, so that is checked too. Errors name
/// the file and the cause; an incomplete file is deleted.
[[nodiscard]] Status write_text_file(const std::filesystem::path& file, std::string_view text);

/// The same under a temporary name first, so that the file is either as before or complete, also if the process is
/// killed.
[[nodiscard]] Status replace_text_file(const std::filesystem::path& file, std::string_view text);

/// Whether replace_text_file can have left a file of this name behind when its process was killed.
[[nodiscard]] bool is_unfinished_file(const std::filesystem::path& file);

}  // namespace talus::products
