#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

/// A face of a roof seen from above, taken to be level at its mean elevation.
struct RoofFace {
    Polygon outline;       ///< world plan coordinates
    double elevation = 0;  ///< m
};

/// A building of a mesh: solid below its roof faces.
struct MeshBuilding {
    std::string name;
    std::map<std::string, std::string> attributes;
    std::vector<RoofFace> roofs;
};

/// Whether a file name is that of a mesh: .obj, .gltf, .glb, .city.json, .cityjson, .roofs.json.
[[nodiscard]] bool is_mesh_file(const std::string& file);

/// Reads the buildings of a CityJSON file (1.0 to 2.0; Building and BuildingPart, their most detailed geometry, LoD1 or
/// LoD2), of a Wavefront OBJ (an object or group each; coordinates in the terrain's reference system, z upward) or of a
/// glTF 2.0 (a node with a mesh each; x east, y upward, -z north, in metres of the terrain's reference system), or of
/// .roofs.json, as which a mesh that came from somebody else is kept (foreign.hpp). Every
/// face that is neither upright nor at the building's foot becomes a roof face. `more_files` receives the other files
/// that were read. Errors, with the object or line: not readable, not such a file, indices out of range, numbers that
/// are not finite, another reference system than `terrain_crs`, a building without a roof, too many faces.
[[nodiscard]] Result<std::vector<MeshBuilding>> read_mesh_buildings(const std::string& file, const Crs& terrain_crs,
                                                                    std::vector<std::string>& more_files);

/// EPSG code of the reference system that a mesh states; 0: it states none.
[[nodiscard]] Result<int> mesh_epsg(const std::string& file);

}  // namespace talus::geo
