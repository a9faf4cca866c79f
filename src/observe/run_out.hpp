#pragma once

#include "observe/observation.hpp"
#include "sim/ground.hpp"
#include "sim/state.hpp"
#include "terrain/flow_path.hpp"

namespace talus {

/// Where the released debris lay before the run.
struct ReleasedMass {
    WorldPoint crown;              ///< highest particle
    WorldPoint centre;             ///< of mass
    double mean_chainage = never;  ///< m, of the particles within the corridor; NaN: none
};

[[nodiscard]] ReleasedMass measure_release(const Ground& ground, const State& state, const FlowPath& flow_path);

/// Distances and angles from the release to the debris as it lies now. The toe is where all but
/// `front_particle_count` particles lie behind: along the path, or by distance from the crown where there is no path or
/// the crown is outside its corridor. Held particles do not count.
[[nodiscard]] RunOut measure_run_out(const Ground& ground, const State& state, const FlowPath& flow_path,
                                     const ReleasedMass& released, double front_chainage);

}  // namespace talus
