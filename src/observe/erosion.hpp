#pragma once

#include <vector>

#include "core/grid.hpp"
#include "observe/observation.hpp"
#include "sim/ground.hpp"
#include "terrain/flow_path.hpp"

namespace talus::observe {

/// Erosion of the bed: its depth, and the volume upstream of every `chainage_interval` m of the flow path. Erosion
/// outside the path's corridor counts in the map and the total volume only.
[[nodiscard]] Erosion measure_erosion(const sim::Ground& ground, const terrain::FlowPath& flow_path,
                                      double chainage_interval);

/// The volumes upstream along a path, from the depths.
void set_upstream_volumes(const terrain::FlowPath& flow_path, double chainage_interval, Erosion& erosion);

/// Depths of Bed::eroded as a map: the cells of the terrain that lost something and two more on every side. NaN: no
/// erosion. Empty if there is no such cell.
[[nodiscard]] Grid<float> erosion_depth(const GridGeometry& terrain, const std::vector<float>& eroded);

}  // namespace talus::observe
