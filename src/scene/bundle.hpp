#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "geo/foreign.hpp"
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

/// A file of an archive that was written again (geo/foreign.hpp), with what belonged to it in the archive.
struct OriginalInput {
    std::string file;               ///< as the scene names it now
    std::vector<InputFile> before;  ///< of the archive; `role`: "", or what follows the file's own, " (.dbf)"
};

struct Unpacked {
    std::filesystem::path scene;  ///< FOLDER/NAME.toml
    std::vector<OriginalInput> originals;
};

/// Unpacks an archive into `folder`: its scene file, the only .toml file at the top of it or of its only folder, and
/// below data/ the files that it names, read once by a process of their own and written again. Nothing else remains.
/// Errors: as unpack_zip and convert_foreign; no scene, several; a scene that names a file outside the archive; a
/// variant that names one which the scene does not.
[[nodiscard]] Result<Unpacked> unpack_bundle(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                             const geo::ZipLimits& limits = {}, const geo::ForeignReader& reader = {});

/// Names the files of the archive in place of those written again, among the inputs and in the values: a manifest and
/// a journal name what their reader has. Nothing can be loaded by these names.
void name_originals(Scene& scene, const std::vector<OriginalInput>& originals);

/// Overrides of a session that somebody else may have saved: they name no file that the scene, with or without one of
/// its variants, does not name itself. Errors: they do; as parse_scene.
[[nodiscard]] Status check_saved_overrides(const std::filesystem::path& scene_file,
                                           const std::vector<std::string>& overrides);

}  // namespace talus::scene
