#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "terrain/release.hpp"
#include "terrain/terrain.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

// What somebody draws or moves in the page must be an area on known ground. Errors begin with `key`.

/// One outline without courtyards. `whole`: all of it must lie on known ground; else some of it.
[[nodiscard]] Status check_ring(const Terrain& terrain, const Ring& ring, const char* key, bool whole);

/// A polygon whose shape is known to be good.
[[nodiscard]] Status check_ground(const Terrain& terrain, const Polygon& polygon, const char* key, bool whole);

/// That it covers no ground of the setup's other releases. `own_id`: of the release as it is in the setup; may be
/// empty.
[[nodiscard]] Status check_overlaps(const Release& release, const Setup& setup, const std::string& own_id);

/// The most points that an outline or a line may be drawn with.
inline constexpr std::size_t most_points = 500;

/// "line: missing; a new barrier needs it".
[[nodiscard]] Error missing(const char* key, const char* what);

/// How far what is there is moved as a whole by `move_m`: all parts and courtyards, which one `outline` could not tell.
/// Errors: there is nothing yet, or an outline is given too.
[[nodiscard]] Result<std::optional<PlanPoint>> read_move(const nlohmann::json& action, const char* outline,
                                                         const char* what, bool exists);

/// The polygon, holes and all, shifted in the plane, m.
[[nodiscard]] Polygon moved(Polygon polygon, const PlanPoint& by);

}  // namespace talus::twin
