#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "geo/vector.hpp"
#include "params/fields.hpp"
#include "scene/load.hpp"
#include "scene/polygons.hpp"

namespace talus {
namespace {

constexpr float as_elsewhere = std::numeric_limits<float>::quiet_NaN();

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

Result<std::vector<Polygon>> read_outline(const ZoneSpec& spec, const std::string& label, Scene& scene) {
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
    const Result<PolygonLayer> layer = read_polygons(spec.file, spec.layer, scene.crs);
    if (!layer) return layer.error();
    record_input(label, spec.file, scene);
    if (!layer->reprojection.empty()) scene.notes.push_back(label + ": " + layer->reprojection);
    for (const PolygonFeature& feature : layer->features) {
        parts.insert(parts.end(), feature.parts.begin(), feature.parts.end());
    }
    return parts;
}

/// The range that a coefficient may have, also where it comes from a raster.
const Parameter& parameter_of(ZoneRaster raster) {
    return *find_section("zone")->find(raster == ZoneRaster::friction_coefficient ? "friction_coefficient"
                                                                                  : "turbulent_friction_mps2");
}

class ZoneWriter {
  public:
    ZoneWriter(const ZoneSpec& spec, Grid<CoverCell>& cells) : spec_(spec), cells_(cells) {}

    void add(int column, int row) {
        CoverCell& cell = cells_.at(column, row);
        ++count_;
        if (spec_.friction_coefficient) cell.friction_coefficient = static_cast<float>(*spec_.friction_coefficient);
        if (spec_.turbulent_friction)
            cell.inverse_turbulent_friction = static_cast<float>(1 / *spec_.turbulent_friction);
        if (spec_.cohesion) cell.cohesion = static_cast<float>(*spec_.cohesion);
        if (spec_.stem_density > 0) {
            cell.stem_drag =
                static_cast<float>(spec_.stem_drag_coefficient * spec_.stem_density * spec_.stem_diameter / 2);
        }
    }

    /// Adds the cells that the raster says; its coefficients where it holds some.
    Status add_raster(const Grid<float>& raster) {
        const GridGeometry &to = cells_.geometry, &from = raster.geometry;
        for (int row = 0; row < to.rows; ++row) {
            for (int column = 0; column < to.columns; ++column) {
                const PlanPoint p = to.centre(column, row);
                const double c = std::floor((p.x - from.x_min) / from.cell),
                             r = std::floor((p.y - from.y_min) / from.cell);
                if (c < 0 || r < 0 || c >= from.columns || r >= from.rows) continue;
                const float value = raster.at(static_cast<int>(c), static_cast<int>(r));
                if (std::isnan(value) || (spec_.raster_value && value != static_cast<float>(*spec_.raster_value)))
                    continue;
                add(column, row);
                if (spec_.raster_holds == ZoneRaster::zone_number) continue;
                const std::string allowed = problem_with(parameter_of(spec_.raster_holds), double{value});
                if (!allowed.empty()) {
                    return Error{fmt::format("{}: holds {:.6g} at {}; it must be {}", spec_.raster, value,
                                             place_text(p), allowed)};
                }
                if (spec_.raster_holds == ZoneRaster::friction_coefficient) {
                    cells_.at(column, row).friction_coefficient = value;
                } else {
                    cells_.at(column, row).inverse_turbulent_friction = 1 / value;
                }
            }
        }
        return {};
    }

    [[nodiscard]] std::size_t count() const { return count_; }

  private:
    const ZoneSpec& spec_;
    Grid<CoverCell>& cells_;
    std::size_t count_ = 0;
};

Status load_zone(const ParsedScene& parsed, std::size_t index, Grid<CoverCell>& cells, Scene& scene) {
    ZoneSpec& spec = scene.spec.zones[index];
    if (spec.name.empty()) spec.name = fmt::format("zone {}", index + 1);
    const std::string label = fmt::format("zone \"{}\"", spec.name);
    const char* key = !spec.file.empty() ? "file" : !spec.polygon.empty() ? "polygon" : "raster";
    const auto refused = [&](const Error& error) {
        return Error{parsed.at(fmt::format("zone[{}].{}", index, key)) + ": " + error.message};
    };
    ZoneWriter writer(spec, cells);
    if (spec.raster.empty()) {
        const Result<std::vector<Polygon>> parts = read_outline(spec, label, scene);
        if (!parts) return refused(parts.error());
        for (const Polygon& part : *parts) {
            for_each_cell_inside(part, cells.geometry, [&](int column, int row) { writer.add(column, row); });
        }
    } else {
        const Result<Raster> raster = read_value_raster(spec.raster, scene.crs);
        if (!raster) return refused(raster.error());
        record_input(label, spec.raster, scene);
        if (Status s = writer.add_raster(raster->grid); !s) return refused(s.error());
    }
    if (writer.count() == 0) {
        return refused(
            Error{fmt::format("{} covers the centre of no cell of the terrain, {} in cells of {:.6g} m; leave "
                              "it out or redraw it",
                              label, extent_text(cells.geometry.extent()), cells.geometry.cell)});
    }
    const double area = static_cast<double>(writer.count()) * cells.geometry.cell * cells.geometry.cell;
    scene.notes.push_back(fmt::format("{}: {} cells of the terrain, {:.6g} m2 in plan", label, writer.count(), area));
    return {};
}

}  // namespace

Status load_zones(const ParsedScene& parsed, Scene& scene) {
    if (scene.spec.zones.empty()) return {};
    Grid<CoverCell> cells(scene.terrain.elevation().geometry, {as_elsewhere, as_elsewhere, as_elsewhere, 0});
    for (std::size_t index = 0; index < scene.spec.zones.size(); ++index) {
        if (Status s = load_zone(parsed, index, cells, scene); !s) return s;
    }
    scene.cover = GroundCover(cells);
    return {};
}

}  // namespace talus
