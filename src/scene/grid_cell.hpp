#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "scene/parse.hpp"
#include "scene/scene.hpp"

/// A scene for the depth-averaged model.
namespace talus::scene {

/// The cell of its grid, m: a whole fraction of the terrain's where the scene does not give it.
[[nodiscard]] double grid_cell(const Scene& scene);

/// Something of a scene that this model does not have.
struct Lacking {
    std::string key;  ///< at fault: "barrier[2].passing_share"
    std::string why;  ///< ends a sentence that begins with the model: "has no nets, and "dam" is one"
};
/// The first that a loaded scene needs; nothing: the model can run it.
[[nodiscard]] std::optional<Lacking> depth_averaged_lacks(const Scene& scene);

/// What it leaves out of a loaded scene that it can run, in sentences without capital and full stop.
[[nodiscard]] std::vector<std::string> depth_averaged_notes(const Scene& scene);

/// Notes given keys that mean something to the depth-averaged model only, unless that runs too, for a zoom.
void note_unused_by_particles(Scene& scene);

/// Refuses what this model does not have, and too many cells. `otherwise`: what can be done but to remove it, "use
/// solver.model = "particles"".
[[nodiscard]] Status refuse_for_depth_averaged(const ParsedScene& parsed, const Scene& scene,
                                               const std::string& otherwise);

/// The same, and notes given keys that mean nothing to this model. The scene is loaded.
[[nodiscard]] Status check_depth_averaged(const ParsedScene& parsed, Scene& scene);

}  // namespace talus::scene
