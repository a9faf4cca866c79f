#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "geo/mesh.hpp"

/// Shared by the readers of meshes.
namespace talus::geo {

inline constexpr std::size_t max_mesh_faces = 30'000;  ///< of a file; walls are compared with each other
inline constexpr std::size_t max_face_corners = 1'000;
inline constexpr std::size_t max_mesh_bytes = 256U << 20U;

/// A face by its rings, the outer one first, world.
using MeshFace = std::vector<std::vector<WorldPoint>>;

/// The whole file. Errors: not there, larger than max_mesh_bytes.
[[nodiscard]] Result<std::string> read_mesh_text(const std::string& file);

/// Turns the faces that are neither upright nor at the foot into roofs. Errors: there is none; an outline that crosses
/// itself seen from above.
[[nodiscard]] Result<std::vector<RoofFace>> find_roofs(const std::vector<MeshFace>& faces);

[[nodiscard]] Result<std::vector<MeshBuilding>> read_obj(const std::string& file);
[[nodiscard]] Result<std::vector<MeshBuilding>> read_gltf(const std::string& file,
                                                          std::vector<std::string>& more_files);
[[nodiscard]] Result<std::vector<MeshBuilding>> read_city_json(const std::string& file, const Crs& terrain_crs);
[[nodiscard]] Result<int> city_json_epsg(const std::string& file);
/// Error: the mesh states another system than the terrain's.
[[nodiscard]] Status check_mesh_epsg(const std::string& file, int epsg, const Crs& terrain_crs);

}  // namespace talus::geo
