#pragma once

#include <string>

#include "scene/scene.hpp"

namespace talus {

/// What a loaded scene holds and what running it would take, as lines for a terminal: terrain, releases, particles and
/// spacing, map cell, buildings, flow path, and every note. Says so when the particles exceed the solver's limit.
[[nodiscard]] std::string describe_scene(const Scene& scene);

}  // namespace talus
