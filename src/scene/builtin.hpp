#pragma once

#include <filesystem>
#include <string_view>

#include "core/result.hpp"

namespace talus {

/// Name of the scene that the program carries inside itself: scenes/<name> of the sources.
inline constexpr std::string_view builtin_scene_name = "sham_tseng";

/// Writes the files of the built-in scene into `folder`, which is made if absent, and returns its scene file.
/// Files of the same name are replaced. Errors: the folder cannot be made, a file cannot be written.
[[nodiscard]] Result<std::filesystem::path> unpack_builtin_scene(const std::filesystem::path& folder);

}  // namespace talus
