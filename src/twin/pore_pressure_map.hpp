#pragma once

#include <cstdint>
#include <vector>

#include "core/grid.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::twin {

/// Whether debris of the model can have pore pressure at all.
[[nodiscard]] bool knows_pore_pressure(const sim::Model& model);

/// Ratios of pore pressure in steps of 1/200, and none.
inline constexpr double pore_pressure_step = 1.0 / 200;
inline constexpr std::uint8_t no_pore_pressure = 255;

/// Mean ratio of pore pressure over the particles of each cell of `depth`, m, whose cells are those of a world map; a
/// cell with debris but no particle has that of its neighbours, one without debris none. Empty where the model has no
/// pore pressure.
[[nodiscard]] std::vector<std::uint8_t> pore_pressure_map(const sim::Model& model, const sim::Ground& ground,
                                                          const sim::State& state, const Grid<float>& depth);

}  // namespace talus::twin
