#pragma once

#include "core/result.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::sim {

/// Of speeds over free fall: pressure can transfer energy from the tail to the front.
inline constexpr double speed_margin = 1.5;

/// The speed, m/s, above which a particle has more energy than a fall from the highest debris to the lowest ground
/// (local z = 0) explains, with its margin.
[[nodiscard]] double speed_bound(const Model& model, double highest_energy_head);

/// Why the last step cannot be trusted, with the time and the parameter to change; success if it can.
/// `highest_energy_head`: greatest z + v^2 / 2g of any particle when it was released, local m.
[[nodiscard]] Status find_fault(const Model& model, const StateSummary& state, double highest_energy_head);

}  // namespace talus::sim
