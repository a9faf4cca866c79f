#include "geo/foreign_data.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"
#include "core/visible_text.hpp"
#include "geo/json_text.hpp"
#include "geo/mesh_faces.hpp"

namespace talus::geo {
namespace {

using nlohmann::json;

constexpr std::size_t longest_attribute = 4000;

std::string dumped(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

json number_or_null(const std::optional<double>& number) {
    // JSON has no other numbers than finite ones; a nodata value may be any.
    return number ? json(fmt::format("{}", *number)) : json();
}

json ring_of(const Ring& ring) {
    json points = json::array();
    for (const PlanPoint& p : ring) {
        points.push_back(p.x);
        points.push_back(p.y);
    }
    return points;
}

Result<Ring> read_ring(const json& points) {
    if (!points.is_array() || points.size() % 2 != 0 || points.size() < 6 || points.size() > 2 * max_face_corners) {
        return Error{"a ring is no list of 3 to 1000 points"};
    }
    Ring ring;
    for (std::size_t k = 0; k < points.size(); k += 2) {
        if (!points[k].is_number() || !points[k + 1].is_number()) return Error{"a coordinate is no number"};
        const PlanPoint p{points[k].get<double>(), points[k + 1].get<double>()};
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) return Error{"a coordinate is not finite"};
        ring.push_back(p);
    }
    return ring;
}

Result<RoofFace> read_roof(const json& written) {
    if (!written.is_object() || !written.contains("z") || !written["z"].is_number() || !written.contains("rings") ||
        !written["rings"].is_array() || written["rings"].empty()) {
        return Error{"a roof has no z and rings"};
    }
    RoofFace roof;
    roof.elevation = written["z"].get<double>();
    if (!std::isfinite(roof.elevation)) return Error{"an elevation is not finite"};
    for (const json& points : written["rings"]) {
        TALUS_ASSIGN(Ring ring, read_ring(points));
        if (roof.outline.outer.empty()) {
            roof.outline.outer = std::move(ring);
        } else {
            roof.outline.holes.push_back(std::move(ring));
        }
    }
    return roof;
}

Result<MeshBuilding> read_building(const json& written, std::size_t& faces) {
    if (!written.is_object() || !written.contains("roofs") || !written["roofs"].is_array() ||
        written["roofs"].empty()) {
        return Error{"a building has no roofs"};
    }
    MeshBuilding building;
    if (const auto name = written.find("name"); name != written.end() && name->is_string()) building.name = *name;
    if (const auto list = written.find("attributes"); list != written.end() && list->is_object()) {
        for (const auto& [key, value] : list->items()) {
            if (value.is_string()) building.attributes[key] = value.get<std::string>();
        }
    }
    for (const json& roof : written["roofs"]) {
        if (++faces > max_mesh_faces) return Error{fmt::format("has more than {} faces", max_mesh_faces)};
        TALUS_ASSIGN(RoofFace face, read_roof(roof));
        building.roofs.push_back(std::move(face));
    }
    return building;
}

}  // namespace

bool names_files(const std::string& wkt) {
    std::string upper = wkt;
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
    // WKT2; +nadgrids, +geoidgrids, +grids of PROJ, PROJ4_GRIDS of WKT1.
    return upper.find("PARAMETERFILE") != std::string::npos || upper.find("GRIDS") != std::string::npos;
}

std::string to_text(const ForeignMesh& mesh) {
    json buildings = json::array();
    for (const MeshBuilding& building : mesh.buildings) {
        json roofs = json::array();
        for (const RoofFace& roof : building.roofs) {
            json rings = json::array({ring_of(roof.outline.outer)});
            for (const Ring& hole : roof.outline.holes) rings.push_back(ring_of(hole));
            roofs.push_back({{"z", roof.elevation}, {"rings", std::move(rings)}});
        }
        buildings.push_back(
            {{"name", building.name}, {"attributes", building.attributes}, {"roofs", std::move(roofs)}});
    }
    return dumped({{"talus_roofs", 1}, {"epsg", mesh.epsg}, {"buildings", std::move(buildings)}}) + "\n";
}

Result<ForeignMesh> read_foreign_mesh(const std::string& text) {
    TALUS_ASSIGN(const json written, parse_json(text));
    if (!written.is_object() || written.value("talus_roofs", json()) != 1 || !written.contains("buildings") ||
        !written["buildings"].is_array()) {
        return Error{"is no list of roofs"};
    }
    ForeignMesh mesh;
    if (const json epsg = written.value("epsg", json(0)); epsg.is_number_integer()) mesh.epsg = epsg.get<int>();
    std::size_t faces = 0;
    for (const json& building : written["buildings"]) {
        TALUS_ASSIGN(MeshBuilding one, read_building(building, faces));
        mesh.buildings.push_back(std::move(one));
    }
    if (mesh.buildings.empty()) return Error{"holds no building"};
    return mesh;
}

void ForeignOutput::header(const std::string& text) {
    put(text.data(), text.size());
    put("\n", 1);
}

void ForeignOutput::error(const std::string& sentence) {
    header(dumped({{"error", sentence}}));
}

void ForeignOutput::raster(const ForeignRaster& raster) {
    json bands = json::array();
    for (const ForeignRaster::Band& band : raster.bands) {
        bands.push_back({{"type", GDALGetDataTypeName(band.type)},
                         {"nodata", number_or_null(band.nodata)},
                         {"scale", number_or_null(band.scale)},
                         {"offset", number_or_null(band.offset)},
                         {"unit", band.unit},
                         {"colour", band.colour}});
    }
    json place;
    for (std::size_t k = 0; raster.place && k < 6; ++k) place.push_back(number_or_null((*raster.place)[k]));
    header(dumped({{"raster",
                    {{"columns", raster.columns},
                     {"rows", raster.rows},
                     {"bands", bands},
                     {"place", place},
                     {"control_points", raster.control_points},
                     {"crs", raster.crs}}}}));
}

void ForeignOutput::layers(const std::vector<ForeignLayer>& layers) {
    json list = json::array();
    for (const ForeignLayer& layer : layers) {
        json fields = json::array();
        for (const Field& field : layer.fields) fields.push_back({{"name", field.name}, {"text", field.is_text}});
        list.push_back({{"name", layer.name}, {"crs", layer.crs}, {"geojson", layer.of_geojson}, {"fields", fields}});
        if (!layer.symbols.empty()) list.back()["symbols"] = to_json(layer.symbols);
    }
    header(dumped({{"layers", list}}));
}

void ForeignOutput::mesh(const ForeignMesh& mesh, const std::vector<std::string>& parts) {
    header(dumped({{"mesh", parts}}));
    const std::string text = to_text(mesh);
    put(text.data(), text.size());
}

void ForeignOutput::geometry(const OGRGeometry& geometry) {
    const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
    value(static_cast<std::uint32_t>(type));
    const auto points = [&](const OGRSimpleCurve& curve) {
        value(static_cast<std::uint32_t>(curve.getNumPoints()));
        for (int k = 0; k < curve.getNumPoints(); ++k) {
            value(curve.getX(k));
            value(curve.getY(k));
        }
    };
    if (type == wkbPoint) {
        value(geometry.toPoint()->getX());
        value(geometry.toPoint()->getY());
    } else if (type == wkbLineString) {
        points(*geometry.toLineString());
    } else if (type == wkbPolygon) {
        const OGRPolygon& polygon = *geometry.toPolygon();
        const bool none = polygon.getExteriorRing() == nullptr;
        value(static_cast<std::uint32_t>(none ? 0 : polygon.getNumInteriorRings() + 1));
        if (!none) points(*polygon.getExteriorRing());
        for (int k = 0; !none && k < polygon.getNumInteriorRings(); ++k) points(*polygon.getInteriorRing(k));
    } else {
        const OGRGeometryCollection& all = *geometry.toGeometryCollection();
        value(static_cast<std::uint32_t>(all.getNumGeometries()));
        for (const OGRGeometry* part : all) this->geometry(*part);
    }
}

void ForeignOutput::feature(const OGRGeometry* geometry, const std::vector<Attribute>& values) {
    value(std::uint8_t{1});
    if (geometry == nullptr || geometry->IsEmpty() != 0) {
        value(std::uint32_t{0});
    } else {
        this->geometry(*geometry);
    }
    for (const Attribute& attribute : values) {
        const auto* text = std::get_if<std::string>(&attribute);
        value(static_cast<std::uint8_t>(attribute.index()));
        if (const auto* number = std::get_if<double>(&attribute)) value(*number);
        if (text == nullptr) continue;
        const auto size = static_cast<std::uint32_t>(std::min(text->size(), longest_attribute));
        value(size);
        put(text->data(), size);
    }
}

}  // namespace talus::geo
