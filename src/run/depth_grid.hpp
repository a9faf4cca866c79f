#pragma once

#include <vector>

#include "core/grid.hpp"
#include "depth/solver.hpp"
#include "observe/grid_observer.hpp"
#include "scene/scene.hpp"

/// A scene on the cells of the depth-averaged model.
namespace talus::run {

/// Elevations, m, with the structures on them; NaN where the ground is not known.
struct GridGround {
    Grid<double> bed;
    std::vector<observe::StructureCells> structures;  ///< as in Scene::buildings
    depth::GroundValues values;                       ///< of the scene's zones
};
[[nodiscard]] GridGround grid_ground(const scene::Scene& scene);

/// The scene's bed on the cells of the grid; none under structures. And what was eroded of it, on those of the terrain.
[[nodiscard]] terrain::Bed grid_bed(const scene::Scene& scene, const GridGround& ground);
[[nodiscard]] terrain::Bed terrain_bed(const scene::Scene& scene, const GridGeometry& grid, const terrain::Bed& eroded);

/// Vertical depth of a release, m, of its volume to rounding; none on structures.
[[nodiscard]] Grid<float> grid_release(const scene::Scene& scene, const terrain::Release& release,
                                       const GridGround& ground);

}  // namespace talus::run
