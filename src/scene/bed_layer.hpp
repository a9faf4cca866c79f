#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "params/spec.hpp"
#include "terrain/bed.hpp"
#include "terrain/terrain.hpp"

namespace talus::scene {

/// A layer of loose material and its extent.
struct BedLayer {
    struct Part {
        Polygon polygon;   ///< world
        double depth = 0;  ///< m, vertical
        bool operator==(const Part&) const = default;
    };
    params::BedSpec spec;
    std::vector<Part> parts;                          ///< none: the extent of the raster; without a raster, everywhere
    std::shared_ptr<const Grid<float>> depth_raster;  ///< m; nullptr: the depth of the parts, or that of `spec`
};

/// Calls `visit(cell, depth)` for the cells of known ground whose centre is on the layer; m, above 0.
void for_each_cell(const BedLayer& layer, const terrain::Terrain& terrain,
                   const std::function<void(std::size_t cell, double depth)>& visit);

struct BedAmount {
    double area = 0, volume = 0, deepest = 0;  ///< m2 in plan, m3, m
};
[[nodiscard]] BedAmount amount_of(const BedLayer& layer, const terrain::Terrain& terrain);

/// Layers on the cells of the terrain; where several overlap the last one applies. There may be at most
/// Bed::max_materials. Empty, and free of cost, without layers.
[[nodiscard]] terrain::Bed lay_bed(const std::vector<BedLayer>& layers, const terrain::Terrain& terrain);

}  // namespace talus::scene
