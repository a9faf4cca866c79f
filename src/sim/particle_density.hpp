#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus {

/// kg/m3, of a particle: its own where a hydrograph gave it one, the material's otherwise. Forces, pressures, energies
/// and masses follow from it. Motion does not: the solver moves volume, in which a denser particle beside a lighter one
/// pushes no harder, and friction is a share of the weight, whatever that is.
[[nodiscard]] inline double density_of(const Model& model, const State& state, std::size_t particle) {
    if (state.density_of_id.empty()) return model.rest_density;
    const std::uint32_t id = state.id[particle];
    const bool own = id < state.density_of_id.size() && state.density_of_id[id] > 0;
    return own ? static_cast<double>(state.density_of_id[id]) : model.rest_density;
}

}  // namespace talus
