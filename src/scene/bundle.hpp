#pragma once

#include <filesystem>

#include "core/result.hpp"
#include "geo/zip_archive.hpp"
#include "scene/scene.hpp"

/// A scene and all its files in one ZIP archive, for another machine or another person.
namespace talus::scene {

/// Whether the name of a scene stands for such an archive: it ends in .zip.
[[nodiscard]] bool is_bundle(const std::filesystem::path& scene);

/// What was packed.
struct Packed {
    std::size_t files = 0;    ///< beside scene.toml
    std::uint64_t bytes = 0;  ///< of them, on disk
};

/// Packs the scene file as scene.toml, and every file that it names as data/NAME; files of one name, from different
/// folders, as data/2/NAME. The scene's text stays, but for these paths. Loads the scene first. Errors: as load_scene,
/// a path that is no file or may lead to others (/vsicurl/, virtual rasters), a variant that names files, cannot be
/// written.
[[nodiscard]] Result<Packed> write_bundle(const std::filesystem::path& scene_file,
                                          const std::filesystem::path& archive);

/// Unpacks an archive into `folder` and returns its scene file: the only .toml file at the top of it, or of its only
/// folder. Errors: as unpack_zip; no scene, several; a scene that names a file outside the archive.
[[nodiscard]] Result<std::filesystem::path> unpack_bundle(const std::filesystem::path& archive,
                                                          const std::filesystem::path& folder,
                                                          const geo::ZipLimits& limits = {});

}  // namespace talus::scene
