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

/// A change of position by an action: a new outline without courtyards, or a displacement of all parts.
struct Redrawn {
    std::optional<Ring> ring;
    std::optional<PlanPoint> by;
    const char* key = "";  ///< the key of the action at fault
    explicit operator bool() const { return ring || by; }
};

/// `outline`: the key of the ring; `move_m` moves all parts and courtyards, which a single ring cannot describe.
/// Errors: a move of a shape that does not exist yet, or both.
[[nodiscard]] Result<Redrawn> read_outline(const nlohmann::json& action, const char* outline, const char* what,
                                           bool exists);

/// The polygon, holes and all, shifted in the plane, m.
[[nodiscard]] Polygon moved(Polygon polygon, const PlanPoint& by);

/// Applies the new position to the parts: a new outline replaces them by one, with the other values of the first. A
/// drawn outline must have an area; `whole`: all of it must lie on known ground, otherwise some of it.
template <class Part>
[[nodiscard]] Status redraw(const Redrawn& drawn, const terrain::Terrain& terrain, bool whole,
                            std::vector<Part>& parts) {
    const auto polygon_of = [](Part& part) -> Polygon& {
        if constexpr (std::is_same_v<Part, Polygon>) {
            return part;
        } else {
            return part.polygon;
        }
    };
    if (drawn.ring) {
        Polygon polygon{*drawn.ring, {}};
        TALUS_TRY(scene::check_area(terrain, polygon, drawn.key, whole));
        parts.resize(1);
        polygon_of(parts.front()) = std::move(polygon);
    }
    if (!drawn.by) return {};
    for (Part& part : parts) {
        polygon_of(part) = moved(std::move(polygon_of(part)), *drawn.by);
        TALUS_TRY(scene::check_ground(terrain, polygon_of(part), drawn.key, whole));
    }
    return {};
}

/// Checks that it covers no ground of the setup's other releases. `own_id`: its id in the setup; may be empty.
[[nodiscard]] Status check_overlaps(const terrain::Release& release, const Setup& setup, const std::string& own_id);

/// Maximum number of points of a drawn outline or line.
inline constexpr std::size_t max_points = 500;

/// "line: missing; a new barrier needs it".
[[nodiscard]] Error missing(const char* key, const char* what);

}  // namespace talus::twin
