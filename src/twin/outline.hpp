#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "core/try.hpp"
#include "scene/known_ground.hpp"
#include "terrain/release.hpp"
#include "terrain/terrain.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// What an action changes of where something lies: a new outline without courtyards, or how far all its parts are
/// moved.
struct Redrawn {
    std::optional<Ring> ring;
    std::optional<PlanPoint> by;
    const char* key = "";  ///< of the action, to blame
    explicit operator bool() const { return ring || by; }
};

/// `outline`: the key of the ring; `move_m` moves all parts and courtyards, which one ring could not tell. Errors: a
/// move of what does not exist yet, or both.
[[nodiscard]] Result<Redrawn> read_outline(const nlohmann::json& action, const char* outline, const char* what,
                                           bool exists);

/// The polygon, holes and all, shifted in the plane, m.
[[nodiscard]] Polygon moved(Polygon polygon, const PlanPoint& by);

/// Gives the parts their new place: a new outline makes one of them, with all else as the first. What somebody draws
/// must be an area; `whole`: all of it must lie on known ground, else some of it.
template <class Part>
[[nodiscard]] Status redraw(const Redrawn& drawn, const Terrain& terrain, bool whole, std::vector<Part>& parts) {
    const auto polygon_of = [](Part& part) -> Polygon& {
        if constexpr (std::is_same_v<Part, Polygon>) {
            return part;
        } else {
            return part.polygon;
        }
    };
    if (drawn.ring) {
        Polygon polygon{*drawn.ring, {}};
        TALUS_TRY(check_area(terrain, polygon, drawn.key, whole));
        parts.resize(1);
        polygon_of(parts.front()) = std::move(polygon);
    }
    if (!drawn.by) return {};
    for (Part& part : parts) {
        polygon_of(part) = moved(std::move(polygon_of(part)), *drawn.by);
        TALUS_TRY(check_ground(terrain, polygon_of(part), drawn.key, whole));
    }
    return {};
}

/// That it covers no ground of the setup's other releases. `own_id`: of the release as it is in the setup; may be
/// empty.
[[nodiscard]] Status check_overlaps(const Release& release, const Setup& setup, const std::string& own_id);

/// The most points that an outline or a line may be drawn with.
inline constexpr std::size_t most_points = 500;

/// "line: missing; a new barrier needs it".
[[nodiscard]] Error missing(const char* key, const char* what);

}  // namespace talus::twin
