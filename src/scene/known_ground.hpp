#pragma once

#include <optional>
#include <string>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "terrain/terrain.hpp"

/// Checks that a shape given in a file or drawn on the page lies where the terrain has elevations.
namespace talus::scene {

struct KnownGround {
    bool any = false;               ///< known somewhere on the area
    std::optional<PlanPoint> bare;  ///< a place of the area where it is unknown
};
[[nodiscard]] KnownGround known_ground(const Polygon& polygon, const terrain::Terrain& terrain);

/// Checks a polygon whose shape is valid. `whole`: all of it must lie on known ground, otherwise some of it. Errors
/// begin with `at`.
[[nodiscard]] Status check_ground(const terrain::Terrain& terrain, const Polygon& polygon, const std::string& at,
                                  bool whole);

/// The same, and that its outer ring does not intersect itself and has an area.
[[nodiscard]] Status check_area(const terrain::Terrain& terrain, const Polygon& polygon, const std::string& at,
                                bool whole);

/// The overlap of two releases, "by 12 m2 around (1.0, 2.0); the same ground cannot fail twice"; empty: none, or only a
/// line where they touch.
[[nodiscard]] std::string shared_ground(const Polygon& a, const Polygon& b);

/// The message for a zone or a bed that covers no cell.
[[nodiscard]] std::string covers_no_cell(const terrain::Terrain& terrain);

}  // namespace talus::scene
