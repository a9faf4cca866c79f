#pragma once

#include <string>

#include "scene/scene.hpp"

namespace talus::scene {

/// Summary of a loaded scene and of what running it needs, as lines for a terminal: terrain, releases, particles and
/// spacing, map cell, buildings, flow path, and every note.
[[nodiscard]] std::string describe_scene(const Scene& scene);

}  // namespace talus::scene
