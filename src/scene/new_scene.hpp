#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace talus {

/// What `talus scene new` is given. At most one of thickness and volume; neither: an attribute of the polygons named
/// thickness_m or thickness, otherwise 2 m, which the scene then lists as an assumption.
struct NewSceneOptions {
    std::filesystem::path dem;
    std::filesystem::path release;
    std::filesystem::path buildings;  ///< empty: none
    std::optional<double> thickness;  ///< m, normal to the slope
    std::optional<double> volume;     ///< m3
    std::optional<int> target_particle_count;
    std::filesystem::path folder;  ///< made; must not exist
};

struct NewScene {
    std::filesystem::path file;      ///< FOLDER/scene.toml
    std::vector<std::string> notes;  ///< what was chosen, assumed and done to the inputs
};

/// Loads and checks the inputs, chooses the extent (where debris could run, see reach.hpp) and writes a commented scene
/// that names the inputs relative to the new folder. Errors: as load_scene, folder already there, cannot be written;
/// nothing is left behind then.
[[nodiscard]] Result<NewScene> write_new_scene(const NewSceneOptions& options);

}  // namespace talus
