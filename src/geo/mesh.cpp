#include "geo/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include <fmt/format.h>

#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "geo/foreign_data.hpp"
#include "geo/mesh_faces.hpp"
#include "terrain/barrier.hpp"

namespace talus::geo {
namespace {

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// `name` in lower case.
bool is_gltf(const std::string& name) {
    return ends_with(name, ".gltf") || ends_with(name, ".glb");
}

/// A mesh that was converted.
bool is_roofs(const std::string& name) {
    return ends_with(name, ".roofs.json");
}

/// Newell's: twice the area along each axis, right for faces that are not quite plane.
Vec3<double> normal_of(const std::vector<WorldPoint>& ring) {
    Vec3<double> sum;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const WorldPoint &a = ring[k], &b = ring[(k + 1) % ring.size()];
        sum += {(a.y - b.y) * (a.z - ring[0].z + b.z - ring[0].z), (a.z - b.z) * (a.x - ring[0].x + b.x - ring[0].x),
                (a.x - b.x) * (a.y - ring[0].y + b.y - ring[0].y)};
    }
    return sum;
}

Ring plan_of(const std::vector<WorldPoint>& ring) {
    Ring plan;
    for (const WorldPoint& p : ring) {
        if (plan.empty() || plan.back().x != p.x || plan.back().y != p.y) plan.push_back({p.x, p.y});
    }
    while (plan.size() > 1 && plan.front().x == plan.back().x && plan.front().y == plan.back().y) plan.pop_back();
    return plan;
}

Result<ForeignMesh> read_roofs(const std::string& file) {
    TALUS_ASSIGN(const std::string text, read_mesh_text(file));
    auto mesh = read_foreign_mesh(text);
    if (!mesh) return Error{file + ": " + mesh.error().message};
    return mesh;
}

}  // namespace

bool is_mesh_file(const std::string& file) {
    const std::string name = lower_case(file);
    return ends_with(name, ".obj") || is_gltf(name) || ends_with(name, ".city.json") || ends_with(name, ".cityjson") ||
           is_roofs(name);
}

Result<std::string> read_mesh_text(const std::string& file) {
    std::error_code code;
    if (!std::filesystem::is_regular_file(file, code)) return Error{file + ": no such file"};
    const auto size = std::filesystem::file_size(file, code);
    if (code || size > max_mesh_bytes) {
        return Error{fmt::format("{}: is larger than {} MB; cut out the part that the terrain covers", file,
                                 max_mesh_bytes >> 20U)};
    }
    std::ifstream in(file, std::ios::binary);
    std::string text(size, '\0');
    in.read(text.data(), static_cast<std::streamsize>(size));
    if (!in) return Error{file + ": cannot be read to its end"};
    return text;
}

Result<std::vector<RoofFace>> find_roofs(const std::vector<MeshFace>& faces) {
    constexpr double upright = 0.05;  // cosine; steeper than 87 degrees
    constexpr double foot = 0.05;     // share of the building's height
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const MeshFace& face : faces) {
        for (const WorldPoint& p : face.front()) {
            lowest = std::min(lowest, p.z);
            highest = std::max(highest, p.z);
        }
    }
    std::vector<RoofFace> roofs;
    for (const MeshFace& face : faces) {
        const Vec3<double> normal = normal_of(face.front());
        double z = 0;
        for (const WorldPoint& p : face.front()) z += p.z / static_cast<double>(face.front().size());
        if (std::abs(normal.z) <= upright * length(normal) || z <= lowest + foot * (highest - lowest)) continue;
        RoofFace roof{{plan_of(face.front()), {}}, z};
        if (roof.outline.outer.size() < 3 || plan_area(roof.outline) < 1e-4) continue;
        for (std::size_t k = 1; k < face.size(); ++k) {
            Ring hole = plan_of(face[k]);
            if (hole.size() >= 3) roof.outline.holes.push_back(std::move(hole));
        }
        if (terrain::meets_itself(roof.outline.outer)) {
            const PlanPoint& p = roof.outline.outer.front();
            return Error{fmt::format("the outline of the face at ({:.1f}, {:.1f}) crosses itself", p.x, p.y)};
        }
        roofs.push_back(std::move(roof));
    }
    if (roofs.empty()) return Error{"has no roof: all faces are upright or lie at its foot"};
    return roofs;
}

Status check_mesh_epsg(const std::string& file, int epsg, const Crs& terrain_crs) {
    if (epsg == 0 || terrain_crs.epsg == 0 || epsg == terrain_crs.epsg) return {};
    return Error{
        fmt::format("{}: metadata.referenceSystem is EPSG:{}, the terrain's is EPSG:{}; bring the file into it "
                    "(cjio FILE crs_reproject {})",
                    file, std::max(0, epsg), terrain_crs.epsg, terrain_crs.epsg)};
}

Result<int> mesh_epsg(const std::string& file) {
    const std::string name = lower_case(file);
    if (is_roofs(name)) {
        TALUS_ASSIGN(const auto mesh, read_roofs(file));
        return mesh.epsg;
    }
    if (ends_with(name, ".obj") || is_gltf(name)) return 0;
    return city_json_epsg(file);
}

Result<std::vector<MeshBuilding>> read_mesh_buildings(const std::string& file, const Crs& terrain_crs,
                                                      std::vector<std::string>& more_files) {
    const std::string name = lower_case(file);
    if (is_gltf(name)) return read_gltf(file, more_files);
    if (is_roofs(name)) {
        TALUS_ASSIGN(auto mesh, read_roofs(file));
        TALUS_TRY(check_mesh_epsg(file, mesh.epsg, terrain_crs));
        return Result<std::vector<MeshBuilding>>(std::move(mesh.buildings));
    }
    return ends_with(name, ".obj") ? read_obj(file) : read_city_json(file, terrain_crs);
}

}  // namespace talus::geo
