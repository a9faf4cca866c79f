#pragma once

#include <optional>
#include <string>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "terrain/terrain.hpp"

/// Whether what somebody drew, in a file or on the page, lies where the terrain has elevations.
namespace talus {

struct KnownGround {
    bool any = false;               ///< known somewhere on the area
    std::optional<PlanPoint> bare;  ///< a place of the area where it is not
};
[[nodiscard]] KnownGround known_ground(const Polygon& polygon, const Terrain& terrain);

/// A polygon whose shape is known to be good. `whole`: all of it must lie on known ground; else some of it. Errors
/// begin with `at`.
[[nodiscard]] Status check_ground(const Terrain& terrain, const Polygon& polygon, const std::string& at, bool whole);

/// The same, and that its outer ring neither meets itself nor has no area.
[[nodiscard]] Status check_area(const Terrain& terrain, const Polygon& polygon, const std::string& at, bool whole);

/// What two releases have in common, "by 12 m2 around (1.0, 2.0); the same ground cannot fail twice"; empty: nothing,
/// or a line where they touch.
[[nodiscard]] std::string shared_ground(const Polygon& a, const Polygon& b);

/// What is wrong with a zone or a bed that has no cell.
[[nodiscard]] std::string covers_no_cell(const Terrain& terrain);

}  // namespace talus
