#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "terrain/bed.hpp"
#include "terrain/buildings.hpp"
#include "terrain/terrain.hpp"

namespace talus {

/// What debris runs over and against, and all of it that a run changes: debris picks up its bed, structures fail.
struct Ground {
    Ground() = default;
    explicit Ground(Terrain terrain_) : terrain(std::move(terrain_)) {}
    /// `range`: as of BuildingSolids, the model's support radius.
    Ground(Terrain terrain_, std::vector<Building> buildings_, double range, Bed bed_ = {})
        : terrain(std::move(terrain_)),
          bed(std::move(bed_)),
          buildings(std::move(buildings_)),
          solids(terrain, buildings, range) {}

    Terrain terrain;
    Bed bed;
    std::vector<Building> buildings;
    BuildingSolids solids;  ///< of the buildings

    /// Takes a depth of the bed, m, away from a cell of the terrain.
    void erode(std::size_t cell, double depth) {
        bed.eroded[cell] += static_cast<float>(depth);
        terrain.set_elevation(cell, static_cast<float>(terrain.elevation().values[cell] - depth));
    }
    /// Removes a building's solid; its place among the buildings stays. `range`: as of BuildingSolids.
    void remove_solid(std::size_t building, double range) {
        buildings[building] = without_solid(std::move(buildings[building]));
        solids = BuildingSolids(terrain, buildings, range);
    }
};

}  // namespace talus
