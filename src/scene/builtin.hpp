#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "scene/scene.hpp"

namespace talus::scene {

/// Name of the scene that the program carries inside itself: scenes/<name> of the sources.
inline constexpr std::string_view builtin_scene_name = "sham_tseng";

/// Writes the files of the built-in scene into `folder`, which is created if absent, and returns its scene file. Files
/// of the same name are replaced. Errors: the folder cannot be created, a file cannot be written.
[[nodiscard]] Result<std::filesystem::path> unpack_builtin_scene(const std::filesystem::path& folder);

/// Names all files of a scene that was unpacked into `folder` NAME/...: paths into a temporary folder would mean
/// nothing to the reader of a manifest or a journal. `name`: "built-in:sham_tseng", or that of a bundle.
void name_unpacked_files(Scene& scene, const std::filesystem::path& folder, const std::string& name);

/// The built-in scene, unpacked into `folder`, which is not needed afterwards, with its files named as above.
[[nodiscard]] Result<Scene> load_builtin_scene(const std::filesystem::path& folder,
                                               const std::vector<std::string>& overrides = {});

}  // namespace talus::scene
