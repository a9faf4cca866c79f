#pragma once

#include "interrupt.hpp"
#include "scene/scene.hpp"

namespace talus::cli {

/// What a run of a scene costs, s of one thread, tried out; NaN: it could not be tried.
[[nodiscard]] double seconds_of_run(const scene::Scene& scene, const InterruptWatch& watch);

}  // namespace talus::cli
