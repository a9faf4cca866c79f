#pragma once

#include "scene/scene.hpp"

namespace talus {

/// Notes a terrain whose slopes, relief or roughness no natural ground has, as where its elevations are in feet and its
/// plan in metres, and asks. The releases are loaded.
void note_implausible_terrain(Scene& scene);

/// Notes releases that are so thin that particles of the scene's spacing cannot flow in them as layers do.
void note_coarse_particles(Scene& scene);

}  // namespace talus
