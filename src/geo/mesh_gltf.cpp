#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/gltf_file.hpp"
#include "geo/mesh_faces.hpp"

namespace talus::geo {
namespace {

using nlohmann::json;

/// Columns of a 4 x 4 matrix, as glTF writes them; its last row is taken to be 0 0 0 1.
using Matrix = std::array<double, 16>;
constexpr Matrix identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix result{};
    for (std::size_t column = 0; column < 4; ++column) {
        for (std::size_t row = 0; row < 4; ++row) {
            for (std::size_t k = 0; k < 4; ++k) result[4 * column + row] += a[4 * k + row] * b[4 * column + k];
        }
    }
    return result;
}

/// Whether `value` is absent, or a list of as many finite numbers, which are then in `numbers`.
template <std::size_t N>
bool read_numbers(const json& value, std::array<double, N>& numbers) {
    if (value.is_null()) return true;
    if (!value.is_array() || value.size() != N) return false;
    for (std::size_t k = 0; k < N; ++k) {
        if (!value[k].is_number() || !std::isfinite(value[k].get<double>())) return false;
        numbers[k] = value[k];
    }
    return true;
}

/// The transformation of a node to its parent; none if it is not given as numbers.
std::optional<Matrix> placement_of(const json& node) {
    Matrix matrix = identity;
    if (!gltf_member(node, "matrix").is_null()) {
        if (!read_numbers(gltf_member(node, "matrix"), matrix)) return std::nullopt;
        return matrix;
    }
    std::array<double, 3> move{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> turn{0, 0, 0, 1};
    if (!read_numbers(gltf_member(node, "translation"), move) || !read_numbers(gltf_member(node, "scale"), scale) ||
        !read_numbers(gltf_member(node, "rotation"), turn)) {
        return std::nullopt;
    }
    const double x = turn[0], y = turn[1], z = turn[2], w = turn[3];
    const Matrix turned{1 - 2 * (y * y + z * z),
                        2 * (x * y + z * w),
                        2 * (x * z - y * w),
                        0,
                        2 * (x * y - z * w),
                        1 - 2 * (x * x + z * z),
                        2 * (y * z + x * w),
                        0,
                        2 * (x * z + y * w),
                        2 * (y * z - x * w),
                        1 - 2 * (x * x + y * y),
                        0,
                        move[0],
                        move[1],
                        move[2],
                        1};
    matrix = turned;
    for (std::size_t k = 0; k < 12; ++k) matrix[k] *= scale[k / 4];
    return matrix;
}

class GltfReader {
  public:
    GltfReader(std::string file, const GltfFile& gltf) : file_(std::move(file)), gltf_(gltf) {}

    Result<std::vector<MeshBuilding>> read() {
        TALUS_TRY(find_roots());
        while (!open_.empty()) {
            const Placed placed = open_.back();
            open_.pop_back();
            TALUS_TRY(read_node(placed));
        }
        if (buildings_.empty()) return Error{file_ + ": has no node with a mesh of triangles"};
        return std::move(buildings_);
    }

  private:
    struct Placed {
        std::size_t node;
        Matrix above;
    };

    [[nodiscard]] Error at_node(std::size_t node, const std::string& what) const {
        return Error{fmt::format("{}: nodes[{}]: {}", file_, node, what)};
    }

    /// The nodes of a list, to be read in its order.
    Status open_nodes(const json& list, const Matrix& above, const std::string& owner) {
        if (list.is_null()) return {};
        if (!list.is_array()) return Error{fmt::format("{}: {}: its nodes are no list", file_, owner)};
        for (std::size_t k = list.size(); k-- > 0;) {
            std::size_t node = 0;
            if (!gltf_size(list[k], node) || node >= seen_.size()) {
                return Error{
                    fmt::format("{}: {}: names a node that is not there; there are {}", file_, owner, seen_.size())};
            }
            open_.push_back({node, above});
        }
        return {};
    }

    /// The nodes of the scene that the file shows; without scenes, those without a parent.
    Status find_roots() {
        const json& nodes = gltf_member(gltf_.root(), "nodes");
        seen_.assign(nodes.is_array() ? nodes.size() : 0, false);
        std::size_t shown = 0;
        const json& said = gltf_member(gltf_.root(), "scene");
        if (!said.is_null() && (!gltf_size(said, shown) || gltf_.entry("scenes", shown) == nullptr)) {
            return Error{file_ + ": scene: names a scene that is not there"};
        }
        if (const json* scene = gltf_.entry("scenes", shown)) {
            return open_nodes(gltf_member(*scene, "nodes"), identity, fmt::format("scenes[{}]", shown));
        }
        std::vector<bool> below(seen_.size());
        for (std::size_t k = 0; k < seen_.size(); ++k) {
            const json& children = gltf_member(nodes[k], "children");
            for (std::size_t c = 0; children.is_array() && c < children.size(); ++c) {
                std::size_t child = 0;
                if (gltf_size(children[c], child) && child < below.size()) below[child] = true;
            }
        }
        for (std::size_t k = seen_.size(); k-- > 0;) {
            if (!below[k]) open_.push_back({k, identity});
        }
        return {};
    }

    Status read_node(const Placed& placed) {
        if (seen_[placed.node]) return at_node(placed.node, "is below two others, or below itself");
        seen_[placed.node] = true;
        const json& node = *gltf_.entry("nodes", placed.node);
        const std::optional<Matrix> own = placement_of(node);
        if (!own) return at_node(placed.node, "its matrix, translation, rotation or scale is not of finite numbers");
        const Matrix matrix = product(placed.above, *own);
        TALUS_TRY(open_nodes(gltf_member(node, "children"), matrix, fmt::format("nodes[{}]", placed.node)));
        const json& mesh = gltf_member(node, "mesh");
        if (mesh.is_null()) return {};
        std::size_t index = 0;
        const json* shape = gltf_size(mesh, index) ? gltf_.entry("meshes", index) : nullptr;
        if (shape == nullptr) return at_node(placed.node, "names a mesh that is not there");
        std::vector<MeshFace> faces;
        const json& primitives = gltf_member(*shape, "primitives");
        for (std::size_t k = 0; primitives.is_array() && k < primitives.size(); ++k) {
            const std::string at = fmt::format("{}: meshes[{}].primitives[{}]", file_, index, k);
            TALUS_TRY(read_primitive(primitives[k], matrix, at, faces));
        }
        return close_building(node, *shape, faces);
    }

    Status read_primitive(const json& primitive, const Matrix& matrix, const std::string& at,
                          std::vector<MeshFace>& faces) {
        if (!gltf_member(gltf_member(primitive, "extensions"), "KHR_draco_mesh_compression").is_null()) {
            return Error{at +
                         ": is compressed with Draco (KHR_draco_mesh_compression), which is not supported; write "
                         "it without"};
        }
        std::size_t mode = 4, place = 0;
        const json& said = gltf_member(primitive, "mode");
        if (!said.is_null() && (!gltf_size(said, mode) || mode > 6)) return Error{at + ": its mode must be 0 to 6"};
        if (mode < 4) return {};  // points and lines
        if (!gltf_size(gltf_member(gltf_member(primitive, "attributes"), "POSITION"), place)) {
            return Error{at + ": has no POSITION"};
        }
        TALUS_ASSIGN(const GltfAccessor positions, gltf_.accessor(place));
        if (positions.width != 3) return Error{at + ": its POSITION must be of three numbers per vertex"};
        std::optional<GltfAccessor> indices;
        if (const json& list = gltf_member(primitive, "indices"); !list.is_null()) {
            if (!gltf_size(list, place)) return Error{at + ": its indices name no accessor"};
            TALUS_ASSIGN(GltfAccessor read, gltf_.accessor(place));
            if (!read.holds_indices()) return Error{at + ": its indices must be whole numbers, not negative"};
            indices = read;
        }
        const std::size_t corners = indices ? indices->count : positions.count;
        const std::size_t count = mode == 4 ? corners / 3 : corners < 3 ? 0 : corners - 2;
        if (count > max_mesh_faces - face_count_) {
            return Error{
                fmt::format("{}: with it there are more than {} faces; simplify the mesh or cut out what the "
                            "terrain covers",
                            at, max_mesh_faces)};
        }
        face_count_ += count;
        for (std::size_t face = 0; face < count; ++face) {
            // Triangles, a strip of them, a fan. Their orientation does not matter.
            const std::size_t first = mode == 4 ? 3 * face : mode == 5 ? face : 0;
            const std::size_t next = mode == 6 ? face + 1 : first + 1;
            std::vector<WorldPoint> ring;
            for (const std::size_t corner : {first, next, next + 1}) {
                const std::size_t vertex = indices ? static_cast<std::size_t>(indices->at(corner, 0)) : corner;
                if (vertex >= positions.count) {
                    return Error{fmt::format("{}: names vertex {}; there are {}", at, vertex, positions.count)};
                }
                ring.push_back(world_point(positions, vertex, matrix));
                if (!std::isfinite(ring.back().x) || !std::isfinite(ring.back().y) || !std::isfinite(ring.back().z)) {
                    return Error{fmt::format("{}: vertex {} is not finite", at, vertex)};
                }
            }
            faces.push_back({std::move(ring)});
        }
        return {};
    }

    /// glTF's y points upward and its z towards the viewer: x is east, -z north.
    static WorldPoint world_point(const GltfAccessor& positions, std::size_t vertex, const Matrix& m) {
        const double x = positions.at(vertex, 0), y = positions.at(vertex, 1), z = positions.at(vertex, 2);
        const auto row = [&](std::size_t r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
        return {row(0), -row(2), row(1)};
    }

    Status close_building(const json& node, const json& mesh, const std::vector<MeshFace>& faces) {
        if (faces.empty()) return {};
        MeshBuilding building;
        building.name = fmt::format("building {}", buildings_.size() + 1);
        for (const json* named : {&mesh, &node}) {
            const json& name = gltf_member(*named, "name");
            if (name.is_string() && !name.get_ref<const std::string&>().empty()) building.name = name;
            const json& extras = gltf_member(*named, "extras");
            if (!extras.is_object()) continue;
            for (const auto& [key, value] : extras.items()) {
                if (value.is_string()) building.attributes[key] = value.get<std::string>();
                if (value.is_number()) building.attributes[key] = value.dump();
            }
        }
        auto roofs = find_roofs(faces);
        if (!roofs) return Error{fmt::format("{}: \"{}\" {}", file_, building.name, roofs.error().message)};
        building.roofs = std::move(*roofs);
        buildings_.push_back(std::move(building));
        return {};
    }

    std::string file_;
    const GltfFile& gltf_;
    std::vector<bool> seen_;    ///< by node
    std::vector<Placed> open_;  ///< nodes still to be read, the next one last
    std::size_t face_count_ = 0;
    std::vector<MeshBuilding> buildings_;
};

}  // namespace

Result<std::vector<MeshBuilding>> read_gltf(const std::string& file, std::vector<std::string>& more_files) {
    TALUS_ASSIGN(const GltfFile gltf, GltfFile::open(file));
    more_files = gltf.buffer_files();
    return GltfReader(file, gltf).read();
}

}  // namespace talus::geo
