#pragma once

#include <filesystem>
#include <string_view>

#include "core/result.hpp"

namespace talus::products {

/// Writes a whole file. A full disk may be reported only when the file is closed, so that is checked too. Errors name
/// the file and the cause; an incomplete file is deleted.
[[nodiscard]] Status write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace talus::products
