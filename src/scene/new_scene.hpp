#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"

namespace talus::scene {

/// Arguments of `talus scene new`. Of polygons, at most one of thickness and volume; neither: their attribute
/// thickness_m or thickness, in any case. A raster of thickness has its own. A file may be in an archive, and name its
/// layer (geo/file_name.hpp).
struct NewSceneOptions {
    std::filesystem::path dem;
    std::string dem_layer;                   ///< of a file with several rasters; empty: not named
    std::filesystem::path release;           ///< polygons; this
    std::string release_layer;               ///< empty: not named
    std::string release_feature;             ///< "12", the number that GIS programs show, or "NAME=VALUE"; empty: all
    std::filesystem::path thickness_raster;  ///< or a raster of thickness, m
    std::filesystem::path buildings;         ///< polygons or a mesh; empty: none
    std::filesystem::path orthophoto;        ///< empty: none
    bool local = false;                      ///< the terrain has local coordinates and states no reference system
    std::string title;                       ///< empty: that of the folder
    std::optional<double> thickness;         ///< m, normal to the slope
    std::optional<double> volume;            ///< m3
    std::optional<Extent> extent;            ///< of the terrain, in its CRS; absent: chosen
    std::optional<double> cell;              ///< m; a copy of the terrain is made on cells of this size
    std::optional<int> target_particle_count;
    std::filesystem::path folder;  ///< made; must not exist
    bool folder_exists = false;    ///< it does, and holds the inputs
};

struct NewScene {
    std::filesystem::path file;      ///< FOLDER/scene.toml
    std::vector<std::string> notes;  ///< choices, assumptions and changes of the inputs
    std::string summary;             ///< as `talus scene check` prints it, without the notes
};

/// Loads and checks the inputs, chooses the extent (where debris could run, see new_terrain.hpp) and writes a commented
/// scene that names the inputs relative to the new folder; what is chosen or coarsened of them is written beside it.
/// Errors: as load_scene, no thickness, folder exists, cannot be written; then nothing remains.
[[nodiscard]] Result<NewScene> write_new_scene(const NewSceneOptions& options);

}  // namespace talus::scene
