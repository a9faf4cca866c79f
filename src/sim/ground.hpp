#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "terrain/bed.hpp"
#include "terrain/buildings.hpp"
#include "terrain/terrain.hpp"

namespace talus {

/// The surfaces that debris moves over and against, including everything that a run changes: debris entrains its bed,
/// structures fail.
struct Ground {
    Ground() = default;
    explicit Ground(Terrain terrain_) : terrain(std::move(terrain_)) {}
    /// `range`: see BuildingSolids, the model's support radius.
    Ground(Terrain terrain_, std::vector<Building> buildings_, double range, Bed bed_ = {})
        : terrain(std::move(terrain_)),
          bed(std::move(bed_)),
          buildings(std::move(buildings_)),
          solids(terrain, buildings, range) {}

    Terrain terrain;
    Bed bed;
    std::vector<Building> buildings;
    BuildingSolids solids;  ///< of the buildings

    /// Lowers a cell of the terrain by a depth of the bed, m.
    void erode(std::size_t cell, double depth) {
        bed.eroded[cell] += static_cast<float>(depth);
        terrain.set_elevation(cell, static_cast<float>(terrain.elevation().values[cell] - depth));
    }
    /// Removes a building's solid; its entry in `buildings` remains. `range`: see BuildingSolids.
    void remove_solid(std::size_t building, double range) {
        buildings[building] = without_solid(std::move(buildings[building]));
        solids = BuildingSolids(terrain, buildings, range);
    }
};

}  // namespace talus
