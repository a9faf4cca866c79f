#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "core/temporary_folder.hpp"
#include "interrupt.hpp"
#include "run/variants.hpp"
#include "scene/bundle.hpp"
#include "scene/scene.hpp"

namespace talus::cli {

/// Of the names of built-in scenes, which stand for a file.
inline const std::string builtin_prefix = "built-in:";

/// The scene file of a command, on disk.
struct SceneFile {
    std::unique_ptr<TemporaryFolder> unpacked;  ///< of the built-in scene or a bundle
    std::filesystem::path file;
    std::string name;                               ///< as in the definition of an ensemble or calibration
    std::string short_name;                         ///< for the default output folder
    std::vector<scene::OriginalInput> originals{};  ///< of a bundle
};

/// `scene` as given: a scene file, a bundle (FILE.zip, or a file in it as journals name it), empty or
/// "built-in:sham_tseng" for the built-in one. Errors: as unpack_bundle().
[[nodiscard]] Result<SceneFile> find_scene(const std::string& scene, InterruptWatch& watch);

/// The scene of a command, on disk and loaded.
struct SceneInput : SceneFile {
    run::SceneSource source;
    scene::Scene scene;
};

/// `scene`: see find_scene(); `layers`: see with_layers(). Errors: as both and load_scene().
[[nodiscard]] Result<SceneInput> open_scene(const std::string& scene, const std::vector<std::string>& overrides,
                                            const std::string& layers, InterruptWatch& watch);

}  // namespace talus::cli
