#pragma once

#include "core/grid.hpp"
#include "observe/observation.hpp"
#include "sim/ground.hpp"
#include "sim/state.hpp"

namespace talus::observe {

/// Position of the released debris before the run.
struct ReleasedMass {
    WorldPoint crown;   ///< highest particle
    WorldPoint centre;  ///< of mass
};

[[nodiscard]] ReleasedMass measure_release(const sim::Ground& ground, const sim::State& state);

/// Distances and angles from the release to the current position of the debris, independent of the flow path. All but
/// `front_particle_count` particles lie behind the toe. Held particles do not count. `covered`: NaN where debris never
/// was. If that many particles have left the terrain, distances go to the farthest covered ground instead.
[[nodiscard]] RunOut measure_run_out(const sim::Ground& ground, const sim::State& state, const Grid<float>& covered,
                                     const ReleasedMass& released, double front_chainage);

}  // namespace talus::observe
