#pragma once

#include <cstddef>
#include <cstdint>
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

    /// What a run has changed since the ground was made of the same scene.
    template <class Archive>
    void keep(Archive& archive);

  private:
    /// A cell of the bed that debris has eroded.
    struct Eroded {
        std::size_t cell = 0;
        float depth = 0, elevation = 0;  ///< m, now
    };
};

template <class Archive>
void Ground::keep(Archive& archive) {
    std::vector<Eroded> eroded;
    std::vector<std::uint8_t> standing;
    if constexpr (!Archive::reading) {
        for (std::size_t cell = 0; cell < bed.eroded.size(); ++cell) {
            if (bed.eroded[cell] != 0) {
                eroded.push_back({cell, bed.eroded[cell], terrain.elevation().values[cell]});
            }
        }
        for (const terrain::Building& building : buildings) standing.push_back(terrain::stands(building) ? 1 : 0);
    }
    // Not made again from the buildings: they are those of the terrain at the last failure.
    archive(eroded, standing, solids);
    if constexpr (Archive::reading) {
        for (const Eroded& e : eroded) {
            if (e.cell >= bed.eroded.size()) return archive.fail();
            bed.eroded[e.cell] = e.depth;
            terrain.set_elevation(e.cell, e.elevation);
        }
        if (standing.size() != buildings.size()) return archive.fail();
        for (std::size_t b = 0; b < buildings.size(); ++b) {
            if (standing[b] == 0) buildings[b] = terrain::without_solid(std::move(buildings[b]));
        }
    }
}

}  // namespace talus::sim
