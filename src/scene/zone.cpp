#include "scene/zone.hpp"

#include <limits>

#include "scene/polygons.hpp"

namespace talus::scene {
namespace {

constexpr float as_elsewhere = std::numeric_limits<float>::quiet_NaN();

/// `value`: of the zone's raster in that cell.
void lay(const params::ZoneSpec& spec, float value, terrain::CoverCell& cell) {
    if (spec.friction_coefficient) cell.friction_coefficient = static_cast<float>(*spec.friction_coefficient);
    if (spec.turbulent_friction) cell.inverse_turbulent_friction = static_cast<float>(1 / *spec.turbulent_friction);
    if (spec.laminar_viscosity) cell.laminar_viscosity = static_cast<float>(*spec.laminar_viscosity);
    if (spec.cohesion) cell.cohesion = static_cast<float>(*spec.cohesion);
    if (spec.stem_density > 0) {
        cell.stem_drag = static_cast<float>(spec.stem_drag_coefficient * spec.stem_density * spec.stem_diameter / 2);
    }
    if (spec.raster_holds == params::ZoneRaster::friction_coefficient) cell.friction_coefficient = value;
    if (spec.raster_holds == params::ZoneRaster::turbulent_friction) cell.inverse_turbulent_friction = 1 / value;
}

}  // namespace

void for_each_cell(const Zone& zone, const GridGeometry& terrain,
                   const std::function<void(std::size_t cell, float value)>& visit) {
    if (zone.cells != nullptr) {
        for (std::size_t k = 0; k < zone.cells->cell.size(); ++k) visit(zone.cells->cell[k], zone.cells->value[k]);
        return;
    }
    for (const Polygon& part : zone.outline) {
        for_each_cell_inside(part, terrain,
                             [&](int column, int row) { visit(terrain.index(column, row), as_elsewhere); });
    }
}

double area_of(const Zone& zone, const GridGeometry& terrain) {
    double area = 0;
    for_each_cell(zone, terrain, [&](std::size_t, float) { area += terrain.cell * terrain.cell; });
    return area;
}

ZonesOnTerrain zones_on_terrain(const std::vector<Zone>& zones, const terrain::Terrain& terrain) {
    ZonesOnTerrain result;
    if (zones.empty()) return result;
    Grid<terrain::CoverCell> cells(terrain.elevation().geometry, {as_elsewhere, as_elsewhere, as_elsewhere, 0});
    result.zone_at.assign(cells.values.size(), 0);
    std::uint16_t number = 0;
    for (const Zone& zone : zones) {
        ++number;
        for_each_cell(zone, cells.geometry, [&](std::size_t cell, float value) {
            lay(zone.spec, value, cells.values[cell]);
            result.zone_at[cell] = number;
        });
    }
    result.cover = terrain::GroundCover(cells);
    return result;
}

}  // namespace talus::scene
