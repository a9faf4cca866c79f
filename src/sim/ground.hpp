#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "terrain/bed.hpp"
#include "terrain/buildings.hpp"
#include "terrain/terrain.hpp"

namespace talus::sim {

/// The surfaces that debris moves over and against, including everything that a run changes: debris entrains its bed,
/// structures fail.
struct Ground {
    Ground() = default;
    explicit Ground(terrain::Terrain terrain_) : terrain(std::move(terrain_)) {}
    /// `range`: see BuildingSolids, the model's support radius.
    Ground(terrain::Terrain terrain_, std::vector<terrain::Building> buildings_, double range, terrain::Bed bed_ = {})
        : terrain(std::move(terrain_)),
          bed(std::move(bed_)),
          buildings(std::move(buildings_)),
          solids(terrain, buildings, range) {}

    terrain::Terrain terrain;
    terrain::Bed bed;
    std::vector<terrain::Building> buildings;
    terrain::BuildingSolids solids;  ///< of the buildings

    /// Lowers a cell of the terrain by a depth of the bed, m.
    void erode(std::size_t cell, double depth) {
        bed.eroded[cell] += static_cast<float>(depth);
        terrain.set_elevation(cell, static_cast<float>(terrain.elevation().values[cell] - depth));
    }
    /// Removes a building's solid; its entry in `buildings` remains. `range`: see BuildingSolids.
    void remove_solid(std::size_t building, double range) {
        buildings[building] = without_solid(std::move(buildings[building]));
        solids = terrain::BuildingSolids(terrain, buildings, range);
    }
};

}  // namespace talus::sim
