#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/vector.hpp"
#include "params/fields.hpp"
#include "scene/known_ground.hpp"
#include "scene/load.hpp"
#include "scene/polygons.hpp"

namespace talus::scene {
namespace {

/// "x y, x y, x y".
std::optional<Polygon> parse_polygon(const std::string& text) {
    Polygon polygon;
    std::istringstream corners(text);
    for (std::string corner; std::getline(corners, corner, ',');) {
        std::istringstream numbers(corner);
        PlanPoint p;
        std::string more;
        if (!(numbers >> p.x >> p.y) || numbers >> more) return std::nullopt;
        polygon.outer.push_back(p);
    }
    if (polygon.outer.size() < 3 || !(plan_area(polygon) > 0)) return std::nullopt;
    return polygon;
}

Result<std::vector<Polygon>> read_outline(const params::ZoneSpec& spec, const std::string& label, Scene& scene) {
    std::vector<Polygon> parts;
    if (!spec.polygon.empty()) {
        const std::optional<Polygon> polygon = parse_polygon(spec.polygon);
        if (!polygon) {
            return Error{
                fmt::format("\"{}\" is refused; it must be three corners or more that span an area, \"x y, x y, "
                            "x y\" (m)",
                            one_line(spec.polygon, 200))};
        }
        parts.push_back(*polygon);
        return parts;
    }
    TALUS_ASSIGN(const geo::PolygonLayer layer, load_polygons(label, spec.file, spec.layer, scene));
    for (const geo::PolygonFeature& feature : layer.features) {
        parts.insert(parts.end(), feature.parts.begin(), feature.parts.end());
    }
    return parts;
}

/// The key whose range a coefficient has, also where it comes from a raster.
const params::Parameter& key_of(params::ZoneRaster raster) {
    return params::parameter_of("zone", raster == params::ZoneRaster::friction_coefficient ? "friction_coefficient"
                                                                                           : "turbulent_friction_mps2");
}

/// The cells of the terrain that the raster covers, with its values. Errors: a coefficient out of range.
Result<ZoneCells> read_cells(const params::ZoneSpec& spec, const Grid<float>& raster, const GridGeometry& terrain) {
    ZoneCells cells;
    const GridGeometry& from = raster.geometry;
    for (int row = 0; row < terrain.rows; ++row) {
        for (int column = 0; column < terrain.columns; ++column) {
            const PlanPoint p = terrain.centre(column, row);
            const double c = std::floor((p.x - from.x_min) / from.cell), r = std::floor((p.y - from.y_min) / from.cell);
            if (c < 0 || r < 0 || c >= from.columns || r >= from.rows) continue;
            const float value = raster.at(static_cast<int>(c), static_cast<int>(r));
            if (std::isnan(value) || (spec.raster_value && value != static_cast<float>(*spec.raster_value))) continue;
            cells.cell.push_back(terrain.index(column, row));
            cells.value.push_back(value);
            if (spec.raster_holds == params::ZoneRaster::zone_number) continue;
            const std::string allowed = problem_with(key_of(spec.raster_holds), double{value});
            if (!allowed.empty()) {
                return Error{
                    fmt::format("{}: holds {:.6g} at {}; it must be {}", spec.raster, value, place_text(p), allowed)};
            }
        }
    }
    return cells;
}

Status load_zone(const ParsedScene& parsed, std::size_t index, Scene& scene) {
    params::ZoneSpec& spec = scene.spec.zones[index];
    if (spec.name.empty()) spec.name = fmt::format("zone {}", index + 1);
    const std::string label = fmt::format("zone \"{}\"", spec.name);
    const char* key = !spec.file.empty() ? "file" : !spec.polygon.empty() ? "polygon" : "raster";
    const auto refused = [&](const Error& error) {
        return Error{parsed.at(fmt::format("zone[{}].{}", index, key)) + ": " + error.message};
    };
    const GridGeometry& terrain = scene.terrain.elevation().geometry;
    Zone zone;
    zone.spec = spec;
    if (spec.raster.empty()) {
        Result<std::vector<Polygon>> parts = read_outline(spec, label, scene);
        if (!parts) return refused(parts.error());
        zone.outline = std::move(*parts);
    } else {
        const Result<geo::Raster> raster = read_value_raster(spec.raster, scene.crs);
        if (!raster) return refused(raster.error());
        record_input(label, spec.raster, scene);
        Result<ZoneCells> cells = read_cells(spec, raster->grid, terrain);
        if (!cells) return refused(cells.error());
        zone.cells = std::make_shared<const ZoneCells>(std::move(*cells));
    }
    const double area = area_of(zone, terrain);
    if (!(area > 0)) {
        return refused(Error{label + " " + covers_no_cell(scene.terrain) + "; leave it out or redraw it"});
    }
    scene.notes.push_back(fmt::format("{}: {:.0f} cells of the terrain, {:.6g} m2 in plan", label,
                                      area / (terrain.cell * terrain.cell), area));
    scene.zones.push_back(std::move(zone));
    return {};
}

}  // namespace

Status load_zones(const ParsedScene& parsed, Scene& scene) {
    for (std::size_t index = 0; index < scene.spec.zones.size(); ++index) {
        TALUS_TRY(load_zone(parsed, index, scene));
    }
    ZonesOnTerrain on_terrain = zones_on_terrain(scene.zones, scene.terrain);
    scene.cover = std::move(on_terrain.cover);
    scene.zone_at = std::move(on_terrain.zone_at);
    return {};
}

}  // namespace talus::scene
