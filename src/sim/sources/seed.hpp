#pragma once

#include <vector>

#include "core/result.hpp"
#include "params/spec.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/relax.hpp"
#include "sim/state.hpp"
#include "terrain/inflow.hpp"
#include "terrain/release.hpp"

namespace talus::sim {

/// Whether releases and inflows can be made of particles of this spacing: each of one at least, and no more in all than
/// the solver's limit (the error gives the number and a spacing that would fit).
[[nodiscard]] Status check_particle_count(const std::vector<terrain::Release>& releases,
                                          const std::vector<terrain::Inflow>& inflows, const params::SolverSpec& solver,
                                          double particle_spacing);

/// Fills the releases with particles at rest, and the model's release groups.
///
/// Every column of the spacing's lattice gets as many particles as its share of volume, stacked on the ground; each
/// release gets volume / spacing^3 particles, to the nearest whole one. The mass is then relaxed without gravity until
/// it is nowhere denser than rest: started over-dense, it would fly apart within a step. Errors: those of
/// check_particle_count; `progress` ended it.
[[nodiscard]] Result<State> seed_releases(Model& model, const Ground& ground,
                                          const std::vector<terrain::Release>& releases, const Progress& progress = {});

/// The multipliers and stresses with which a state, in the order of its ids, would start to move; it is not moved. The
/// search starts from the state's own.
void find_pressures(const Model& model, const Ground& ground, State& state);

}  // namespace talus::sim
