#pragma once

#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::sim {

/// The next time step: `time_step` of the scene, or the largest dt_max / 2^(k/8) in which the fastest particle, falling
/// freely, moves at most `displacement_limit` of a spacing; shorter while the debris is compressed, down to an eighth.
[[nodiscard]] double choose_time_step(const Model& model, const StateSummary& state);

}  // namespace talus::sim
