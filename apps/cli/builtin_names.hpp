#pragma once

#include <filesystem>

#include "scene/scene.hpp"

namespace talus {

/// Names the files of the built-in scene, which lie in the temporary folder `unpacked`, as "built-in:NAME/FILE": paths
/// that are soon gone would mean nothing to the reader of a manifest.
void name_builtin_files(Scene& scene, const std::filesystem::path& unpacked);

}  // namespace talus
