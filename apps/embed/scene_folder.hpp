#pragma once

#include <filesystem>

#include "core/result.hpp"
#include "talus.h"

namespace talus::embed {

/// Writes a scene from arrays into `folder`, which is created if absent and must be empty, and returns its scene file.
/// Errors name what is missing or wrong in the arrays; then the folder is as before.
[[nodiscard]] Result<std::filesystem::path> write_scene_folder(const talus_arrays& arrays,
                                                               const std::filesystem::path& folder);

}  // namespace talus::embed
