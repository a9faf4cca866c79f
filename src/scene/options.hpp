#pragma once

#include "core/result.hpp"
#include "scene/parse.hpp"
#include "scene/scene.hpp"

namespace talus::scene {

/// Takes out of a loaded scene what is not in force with its option: barriers and zones that only other options name,
/// and buildings that it removes. Without any option nothing changes. Errors: a building that does not exist.
[[nodiscard]] Status apply_option(const ParsedScene& parsed, Scene& scene);

}  // namespace talus::scene
