#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::sim {

/// kg/m3, of a particle: its own where a hydrograph sets one, otherwise the material's. Forces, pressures, energies and
/// masses follow from it. Motion does not: the solver moves volumes, so a denser particle pushes no harder on a lighter
/// one, and friction is proportional to weight.
template <class AnyModel, class AnyState>
[[nodiscard]] TALUS_DEVICE double density_of(const AnyModel& model, const AnyState& state, std::size_t particle) {
    if (state.density_of_id.empty()) return model.rest_density;
    const std::uint32_t id = state.id[particle];
    const bool own = id < state.density_of_id.size() && state.density_of_id[id] > 0;
    return own ? static_cast<double>(state.density_of_id[id]) : model.rest_density;
}

}  // namespace talus::sim
