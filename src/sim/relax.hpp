#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

/// Moves particles that were placed, not brought to their position by a step, until they fit; none gains speed.
namespace talus::sim {

/// Is called now and then during long work with the share of it that is done, 0 to 1; false ends it early.
using Progress = std::function<bool(double share)>;

/// Moves a local position out of the solids that it lies in, to their surface, and up to the ground. Calls `on_wall`
/// with the normal of every surface that it is moved out of.
template <class OnWall>
void push_out_of_solids(const Model& model, const Ground& ground, LocalPoint& p, float grain_rank,
                        const OnWall& on_wall) {
    const auto touching = static_cast<float>(model.contact_distance());
    // Once per wall at most in a corner; touching buildings act as one solid.
    for (int wall = 0; wall < 4 && ground.solids.inside(p, grain_rank); ++wall) {
        const terrain::SolidSample<float> nearest = ground.solids.nearest(p, grain_rank);
        p += nearest.normal * (touching - nearest.distance);
        on_wall(nearest.normal);
    }
    p.z = std::max(p.z, ground.terrain.sample(p.x, p.y).height);
}

/// Brings the seeded lattice to rest: first pushed apart, without gravity, until it is nowhere denser than rest; then
/// loaded by gravity until it carries its own weight, in steps so short that a slope steeper than its friction angle
/// hardly moves. Without the second part there would be no pressure for friction in the first steps, and the mass would
/// start with a jolt. Nets hold all debris during this. `overburden`, by id: thickness above a particle, m, whose
/// weight along the normal is the first guess of its pressure. False: `progress` ended it.
[[nodiscard]] bool relax(const Model& model, const Ground& ground, State& state, const std::vector<float>& overburden,
                         const Progress& progress = {});

/// Pushes debris denser than at rest apart, without gravity, friction or inertia, until it hardly is; held particles do
/// not move. Positions change; time and velocities are reset.
void push_apart(const Model& model, const Ground& ground, State& state);

}  // namespace talus::sim
