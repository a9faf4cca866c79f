#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "params/spec.hpp"
#include "terrain/ground_cover.hpp"
#include "terrain/terrain.hpp"

namespace talus::scene {

/// The raster of a zone on the cells of the terrain.
struct ZoneCells {
    std::vector<std::size_t> cell;  ///< index into the terrain's grid
    std::vector<float> value;       ///< of the raster there; see ZoneSpec::raster_holds
};

/// Ground with its own resistance.
struct Zone {
    params::ZoneSpec spec;
    std::vector<Polygon> outline;            ///< world; of a zone without cells
    std::shared_ptr<const ZoneCells> cells;  ///< nullptr: the zone is where its outline is
};

/// Calls `visit(cell, value)` for the cells of the terrain that belong to the zone, those whose centre is inside. The
/// value is the raster's, NaN without one.
void for_each_cell(const Zone& zone, const GridGeometry& terrain,
                   const std::function<void(std::size_t cell, float value)>& visit);

/// Plan area of a zone's cells, m2.
[[nodiscard]] double area_of(const Zone& zone, const GridGeometry& terrain);

/// Zones on the cells of the terrain. Where they overlap, the values of the later one apply.
struct ZonesOnTerrain {
    terrain::GroundCover cover;
    std::vector<std::uint16_t> zone_at;  ///< by cell of the terrain: 1 + the last zone there; 0: none
};

/// Empty, and free of cost, without zones.
[[nodiscard]] ZonesOnTerrain zones_on_terrain(const std::vector<Zone>& zones, const terrain::Terrain& terrain);

}  // namespace talus::scene
