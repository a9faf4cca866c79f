#pragma once

#include "scene/parse.hpp"
#include "scene/reach.hpp"
#include "scene/scene.hpp"

namespace talus::scene {

/// Looks at the ground that debris can reach for marks of missing data: a value that many cells hold beside ground far
/// above it (an undeclared 0), and cells beside nodata that are means of ground and nodata, as resampling leaves them.
/// Errors: debris would fall hundreds of metres there; what may be true is noted. Both say how to mend it.
[[nodiscard]] Status check_missing_data(const ParsedScene& parsed, const ReachableGround& reachable, Scene& scene);

}  // namespace talus::scene
