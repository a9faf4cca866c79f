#pragma once

#include "observe/observation.hpp"
#include "sim/model.hpp"
#include "terrain/flow_path.hpp"

namespace talus {

/// What the model's bed has lost: where, and how much of it upstream of every `chainage_interval` m of the flow path.
/// What was picked up beyond the path's corridor counts in the map and in the volume alone.
[[nodiscard]] Erosion measure_erosion(const Model& model, const FlowPath& flow_path, double chainage_interval);

}  // namespace talus
