#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace talus::scene {

/// Arguments of `talus scene new`. At most one of thickness and volume; neither: an attribute of the polygons named
/// thickness_m or thickness, otherwise 2 m, which the scene then lists as an assumption. A raster of thickness has its
/// own.
struct NewSceneOptions {
    std::filesystem::path dem;
    std::filesystem::path release;           ///< polygons; this
    std::filesystem::path thickness_raster;  ///< or a raster of thickness, m
    std::filesystem::path buildings;         ///< polygons or a mesh; empty: none
    std::filesystem::path orthophoto;        ///< empty: none
    bool local = false;                      ///< the terrain has local coordinates and states no reference system
    std::string title;                       ///< empty: that of the folder
    std::optional<double> thickness;         ///< m, normal to the slope
    std::optional<double> volume;            ///< m3
    std::optional<int> target_particle_count;
    std::filesystem::path folder;  ///< made; must not exist
    bool folder_exists = false;    ///< it does, and holds the inputs
};

struct NewScene {
    std::filesystem::path file;      ///< FOLDER/scene.toml
    std::vector<std::string> notes;  ///< choices, assumptions and changes of the inputs
    std::string summary;             ///< as `talus scene check` prints it, without the notes
};

/// Loads and checks the inputs, chooses the extent (where debris could run, see reach.hpp) and writes a commented scene
/// that names the inputs relative to the new folder. Errors: as load_scene, folder exists, cannot be written; then
/// nothing remains.
[[nodiscard]] Result<NewScene> write_new_scene(const NewSceneOptions& options);

}  // namespace talus::scene
