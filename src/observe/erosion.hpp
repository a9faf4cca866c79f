#pragma once

#include <vector>

#include "core/grid.hpp"
#include "observe/observation.hpp"
#include "sim/ground.hpp"
#include "terrain/flow_path.hpp"

namespace talus {

/// What the model's bed has lost: where, and how much of it upstream of every `chainage_interval` m of the flow path.
/// What was picked up beyond the path's corridor counts in the map and in the volume alone.
[[nodiscard]] Erosion measure_erosion(const Ground& ground, const FlowPath& flow_path, double chainage_interval);

/// Depths of Bed::eroded as a map: the cells of the terrain that lost something and two more on every side. NaN:
/// nothing was picked up there. Empty if there is no such cell.
[[nodiscard]] Grid<float> erosion_depth(const GridGeometry& terrain, const std::vector<float>& eroded);

}  // namespace talus
