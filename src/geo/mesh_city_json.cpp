#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/try.hpp"
#include "geo/json_text.hpp"
#include "geo/mesh_faces.hpp"

namespace talus::geo {
namespace {

using nlohmann::json;

const json& member(const json& object, const char* key) {
    static const json nothing;
    if (!object.is_object()) return nothing;
    const auto found = object.find(key);
    return found == object.end() ? nothing : *found;
}

bool is_triple(const json& value) {
    return value.is_array() && value.size() == 3 && value[0].is_number() && value[1].is_number() &&
           value[2].is_number();
}

/// A value in a message; nested values are only named.
std::string brief(const json& value) {
    if (value.is_structured()) return value.is_array() ? "a list" : "an object";
    return value.dump(-1, ' ', false, json::error_handler_t::replace).substr(0, 40);
}

class CityReader {
  public:
    CityReader(std::string file, const json& city) : file_(std::move(file)), city_(city) {}

    Status check(const Crs& terrain_crs) {
        if (member(city_, "type") != "CityJSON") {
            return Error{file_ + ": is no CityJSON file; its \"type\" must be \"CityJSON\""};
        }
        const json& version = member(city_, "version");
        if (!version.is_null() && version != "1.0" && version != "1.1" && version != "2.0") {
            return Error{
                fmt::format("{}: version is {}; it must be \"1.0\", \"1.1\" or \"2.0\"", file_, brief(version))};
        }
        return check_mesh_epsg(file_, epsg(), terrain_crs);
    }

    /// 0: none is stated; -1: one without a code.
    [[nodiscard]] int epsg() const {
        const json& system = member(member(city_, "metadata"), "referenceSystem");
        if (!system.is_string()) return 0;
        const std::string name = system;  // .../def/crs/EPSG/0/7415, urn:ogc:def:crs:EPSG::28992
        const std::size_t digits = name.find_last_not_of("0123456789");
        const int code = std::atoi(name.c_str() + (digits == std::string::npos ? 0 : digits + 1));
        return code > 0 ? code : -1;
    }

    Status read_vertices() {
        const json& transform = member(city_, "transform");
        double scale[3] = {1, 1, 1}, shift[3] = {0, 0, 0};
        if (!transform.is_null()) {
            const json &by = member(transform, "scale"), &to = member(transform, "translate");
            if (!is_triple(by) || !is_triple(to)) {
                return Error{file_ + ": transform: needs scale and translate of three numbers each"};
            }
            for (std::size_t k = 0; k < 3; ++k) {
                scale[k] = by[k];
                shift[k] = to[k];
            }
        }
        const json& list = member(city_, "vertices");
        if (!list.is_array()) return Error{file_ + ": has no list of vertices"};
        vertices_.reserve(list.size());
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (!is_triple(list[i])) return Error{fmt::format("{}: vertices[{}]: must be three numbers", file_, i)};
            double p[3];
            for (std::size_t k = 0; k < 3; ++k) p[k] = list[i][k].get<double>() * scale[k] + shift[k];
            if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
                return Error{fmt::format("{}: vertices[{}]: is not finite", file_, i)};
            }
            vertices_.push_back({p[0], p[1], p[2]});
        }
        return {};
    }

    Result<std::vector<MeshBuilding>> read_buildings() {
        const json& objects = member(city_, "CityObjects");
        if (!objects.is_object()) return Error{file_ + ": has no CityObjects"};
        std::map<std::string, std::vector<MeshFace>> faces;  // by building
        for (const auto& [id, object] : objects.items()) {
            const json& type = member(object, "type");
            const bool part = type == "BuildingPart";
            if (!part && type != "Building") continue;
            std::string owner = id;
            const json& parents = member(object, "parents");
            if (part && parents.is_array() && !parents.empty() && parents[0].is_string()) owner = parents[0];
            TALUS_TRY(read_geometry(id, object, faces[owner]));
        }
        std::vector<MeshBuilding> buildings;
        for (const auto& [id, own] : faces) {
            if (own.empty()) continue;  // its parts are under another name, or it has no geometry
            MeshBuilding building;
            building.name = id;
            for (const auto& [key, value] : member(member(objects, id.c_str()), "attributes").items()) {
                if (value.is_string()) building.attributes[key] = value.get<std::string>();
                if (value.is_number()) building.attributes[key] = value.dump();
            }
            auto roofs = find_roofs(own);
            if (!roofs) return Error{fmt::format("{}: \"{}\" {}", file_, id, roofs.error().message)};
            building.roofs = std::move(*roofs);
            buildings.push_back(std::move(building));
        }
        if (buildings.empty()) return Error{file_ + ": has no Building with a geometry"};
        return buildings;
    }

  private:
    /// The most detailed geometry of an object.
    Status read_geometry(const std::string& id, const json& object, std::vector<MeshFace>& faces) {
        const json* best = nullptr;
        double best_detail = 0;
        for (const json& geometry : member(object, "geometry")) {
            const json& lod = member(geometry, "lod");
            const double detail = lod.is_string()   ? std::atof(lod.get<std::string>().c_str())
                                  : lod.is_number() ? lod.get<double>()
                                                    : 0;
            if (detail < 1 || detail >= 3 || (best != nullptr && detail <= best_detail)) continue;
            best = &geometry;
            best_detail = detail;
        }
        if (best == nullptr) return {};
        const json& type = member(*best, "type");
        const int depth = type == "Solid"                                        ? 2
                          : type == "MultiSurface" || type == "CompositeSurface" ? 1
                          : type == "MultiSolid" || type == "CompositeSolid"     ? 3
                                                                                 : 0;
        if (depth == 0) {
            return Error{fmt::format("{}: \"{}\": geometry type {} is no surface or solid", file_, id, brief(type))};
        }
        return read_faces(id, member(*best, "boundaries"), depth, faces);
    }

    /// `depth`: number of list levels around the faces.
    Status read_faces(const std::string& id, const json& lists, int depth, std::vector<MeshFace>& faces) {
        if (!lists.is_array()) return Error{fmt::format("{}: \"{}\": its boundaries are no list", file_, id)};
        for (const json& entry : lists) {
            TALUS_TRY(depth > 1 ? read_faces(id, entry, depth - 1, faces) : read_face(id, entry, faces));
        }
        return {};
    }

    Status read_face(const std::string& id, const json& rings, std::vector<MeshFace>& faces) {
        const auto bad = [&](const std::string& what) { return Error{fmt::format("{}: \"{}\": {}", file_, id, what)}; };
        if (!rings.is_array() || rings.empty()) return bad("a face has no rings");
        if (++face_count_ > max_mesh_faces) {
            return bad(fmt::format("with it there are more than {} faces; cut out what the terrain covers or use LoD1",
                                   max_mesh_faces));
        }
        MeshFace face;
        for (const json& indices : rings) {
            if (!indices.is_array() || indices.size() < 3 || indices.size() > max_face_corners) {
                return bad(fmt::format("a ring must have 3 to {} corners", max_face_corners));
            }
            std::vector<WorldPoint>& ring = face.emplace_back();
            for (const json& index : indices) {
                if (!index.is_number_unsigned() || index.get<std::uint64_t>() >= vertices_.size()) {
                    return bad(fmt::format("a ring names vertex {}; there are {}", brief(index), vertices_.size()));
                }
                ring.push_back(vertices_[index.get<std::size_t>()]);
            }
        }
        faces.push_back(std::move(face));
        return {};
    }

    std::string file_;
    const json& city_;
    std::size_t face_count_ = 0;
    std::vector<WorldPoint> vertices_;
};

}  // namespace

Result<int> city_json_epsg(const std::string& file) {
    TALUS_ASSIGN(const std::string text, read_mesh_text(file));
    const Result<json> city = parse_json(text);
    if (!city) return Error{file + ": " + city.error().message};
    return CityReader(file, *city).epsg();
}

Result<std::vector<MeshBuilding>> read_city_json(const std::string& file, const Crs& terrain_crs) {
    TALUS_ASSIGN(const std::string text, read_mesh_text(file));
    const Result<json> city = parse_json(text);
    if (!city) return Error{file + ": " + city.error().message};
    CityReader reader(file, *city);
    TALUS_TRY(reader.check(terrain_crs));
    TALUS_TRY(reader.read_vertices());
    return reader.read_buildings();
}

}  // namespace talus::geo
