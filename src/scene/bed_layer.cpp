#include "scene/bed_layer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace talus::scene {
namespace {

terrain::BedMaterial material_of(const params::BedSpec& spec) {
    return {spec.name,
            spec.law,
            spec.growth_rate.value_or(0),
            spec.critical_shear_stress,
            spec.erosion_rate,
            spec.erosion_depth_per_shear};
}

/// `depth_at`: m at a world plan position; no layer where it is not above 0.
template <class DepthAt, class Visit>
void visit_cells(const terrain::Terrain& terrain, const Extent& extent, const DepthAt& depth_at, const Visit& visit) {
    const Grid<float>& elevation = terrain.elevation();
    const GridGeometry& g = elevation.geometry;
    const auto nearest = [&](double along, int cells) {
        return static_cast<int>(std::clamp(std::floor(along / g.cell), 0.0, cells - 1.0));
    };
    const int first_column = nearest(extent.x_min - g.x_min, g.columns);
    const int last_column = nearest(extent.x_max - g.x_min, g.columns);
    const int last_row = nearest(extent.y_max - g.y_min, g.rows);
    for (int row = nearest(extent.y_min - g.y_min, g.rows); row <= last_row; ++row) {
        for (int column = first_column; column <= last_column; ++column) {
            const std::size_t cell = g.index(column, row);
            const double depth = std::isnan(elevation.values[cell]) ? 0 : depth_at(g.centre(column, row));
            if (depth > 0) visit(cell, depth);
        }
    }
}

}  // namespace

void for_each_cell(const BedLayer& layer, const terrain::Terrain& terrain,
                   const std::function<void(std::size_t cell, double depth)>& visit) {
    const Grid<float>* raster = layer.depth_raster.get();
    const auto depth_at = [&](const PlanPoint& p, double depth) -> double {
        return raster != nullptr ? value_at(*raster, p) : depth;
    };
    if (layer.parts.empty()) {
        const Extent extent = raster != nullptr ? raster->geometry.extent() : terrain.elevation().geometry.extent();
        const double depth = layer.spec.depth.value_or(0);
        visit_cells(
            terrain, extent, [&](const PlanPoint& p) { return depth_at(p, depth); }, visit);
    }
    for (const BedLayer::Part& part : layer.parts) {
        const auto inside = [&](const PlanPoint& p) { return contains(part.polygon, p) ? depth_at(p, part.depth) : 0; };
        visit_cells(terrain, extent_of(part.polygon), inside, visit);
    }
}

BedAmount amount_of(const BedLayer& layer, const terrain::Terrain& terrain) {
    const double cell_area = terrain.cell() * terrain.cell();
    BedAmount amount;
    for_each_cell(layer, terrain, [&](std::size_t, double depth) {
        amount.area += cell_area;
        amount.volume += depth * cell_area;
        amount.deepest = std::max(amount.deepest, depth);
    });
    return amount;
}

terrain::Bed lay_bed(const std::vector<BedLayer>& layers, const terrain::Terrain& terrain) {
    terrain::Bed bed;
    if (layers.empty()) return bed;
    const std::size_t cells = terrain.elevation().values.size();
    bed.material_at.assign(cells, 0);
    bed.depth.assign(cells, 0);
    bed.eroded.assign(cells, 0);
    for (const BedLayer& layer : layers) {
        bed.materials.push_back(material_of(layer.spec));
        const auto material = static_cast<std::uint8_t>(bed.materials.size());
        for_each_cell(layer, terrain, [&](std::size_t cell, double depth) {
            bed.material_at[cell] = material;
            bed.depth[cell] = static_cast<float>(depth);
        });
    }
    return bed;
}

}  // namespace talus::scene
