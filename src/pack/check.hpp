#pragma once

#include "core/result.hpp"
#include "scene/scene.hpp"

namespace talus::pack {

/// Checks what loading a scene has checked, of one that came as bytes from anybody: values in their ranges, sizes and
/// indices that fit together. Errors are the end of a sentence: "release[0] has no area".
[[nodiscard]] Status check_scene(const scene::Scene& scene);

/// The grid of a terrain, before it is made.
[[nodiscard]] Status check_terrain(const Grid<float>& elevation);

/// The rest of check_scene() that making the scene's parts relies on.
[[nodiscard]] Status check_parts(const scene::Scene& scene);

/// Cells of the maps of a run.
[[nodiscard]] double map_cells(const scene::Scene& scene);

}  // namespace talus::pack
