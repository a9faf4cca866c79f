#pragma once

#include "scene/reach.hpp"
#include "scene/scene.hpp"

namespace talus::scene {

/// Adds a note about a terrain whose slopes, relief or roughness are implausible for natural ground where debris can
/// go, for example with elevations in feet and plan coordinates in metres. The releases must be loaded.
void note_implausible_terrain(const ReachableGround& reachable, Scene& scene);

/// Adds a note about releases too thin to be resolved by several layers of particles.
void note_coarse_particles(Scene& scene);

}  // namespace talus::scene
