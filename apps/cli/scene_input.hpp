#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "core/temporary_folder.hpp"
#include "interrupt.hpp"
#include "run/variants.hpp"
#include "scene/scene.hpp"

namespace talus::cli {

/// Of the names of built-in scenes, which stand for a file.
inline const std::string builtin_prefix = "built-in:";

/// The scene of a command, on disk and loaded.
struct SceneInput {
    std::unique_ptr<TemporaryFolder> unpacked;  ///< of the built-in scene
    run::SceneSource source;
    std::string name;        ///< as in the definition of an ensemble or calibration
    std::string short_name;  ///< for the default output folder
    scene::Scene scene;
};

/// `scene` as given, empty or "built-in:sham_tseng" for the built-in one; `layers`: see with_layers(). Errors: as
/// with_layers() and load_scene().
[[nodiscard]] Result<SceneInput> open_scene(const std::string& scene, const std::vector<std::string>& overrides,
                                            const std::string& layers, InterruptWatch& watch);

}  // namespace talus::cli
