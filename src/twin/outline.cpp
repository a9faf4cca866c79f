#include "twin/outline.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "scene/polygons.hpp"
#include "terrain/barrier.hpp"
#include "twin/json_keys.hpp"

namespace talus::twin {

Status check_ring(const Terrain& terrain, const Ring& ring, const char* key, bool whole) {
    if (meets_itself(ring)) return Error{fmt::format("{}: touches or crosses itself", key)};
    const Polygon polygon{ring, {}};
    if (!(plan_area(polygon) > 0)) return Error{fmt::format("{}: has no area", key)};
    return check_ground(terrain, polygon, key, whole);
}

Status check_ground(const Terrain& terrain, const Polygon& polygon, const char* key, bool whole) {
    std::optional<PlanPoint> bare;
    bool any = false;
    const auto look = [&](const PlanPoint& p) {
        const bool known = !std::isnan(terrain.elevation_at(p));
        any = any || known;
        if (!known && !bare) bare = p;
    };
    for_each_on_rings(polygon, terrain.cell() / 2, look);
    for_each_inside(polygon, terrain.cell() / 2, look);
    if (any && !(whole && bare)) return {};
    const Extent e = terrain.elevation().geometry.extent().grown(-terrain.cell() / 2);
    return Error{fmt::format(
        "{}: reaches ({:.1f}, {:.1f}), where the ground is not known; the terrain covers x {:.1f} to {:.1f}, y {:.1f} "
        "to {:.1f} at most",
        key, bare->x, bare->y, e.x_min, e.x_max, e.y_min, e.y_max)};
}

Status check_overlaps(const Release& release, const Setup& setup, const std::string& own_id) {
    for (const ReleaseSetup& other : setup.releases) {
        if (other.id == own_id) continue;
        for (const ReleasePatch& theirs : other.body->patches) {
            for (const ReleasePatch& ours : release.patches) {
                const Overlap overlap = overlap_of(ours.polygon, theirs.polygon);
                if (!is_true_overlap(overlap, ours.polygon, theirs.polygon)) continue;
                return Error{
                    fmt::format("polygon: overlaps release \"{}\" by {:.4g} m2 around ({:.1f}, {:.1f}); the same "
                                "ground cannot fail twice",
                                other.body->name, overlap.area, overlap.place.x, overlap.place.y)};
            }
        }
    }
    return {};
}

Error missing(const char* key, const char* what) {
    return Error{fmt::format("{}: missing; a new {} needs it", key, what)};
}

Result<std::optional<PlanPoint>> read_move(const nlohmann::json& action, const char* outline, const char* what,
                                           bool exists) {
    auto by = read_shift(action, "move_m");
    if (!by || !*by) return by;
    if (!exists) return Error{fmt::format("move_m: needs the id of a {}", what)};
    if (action.contains(outline)) return Error{fmt::format("move_m: cannot go with {}; send one of them", outline)};
    return by;
}

Polygon moved(Polygon polygon, const PlanPoint& by) {
    const auto move = [&](Ring& ring) {
        for (PlanPoint& p : ring) p = {p.x + by.x, p.y + by.y};
    };
    move(polygon.outer);
    std::for_each(polygon.holes.begin(), polygon.holes.end(), move);
    return polygon;
}

}  // namespace talus::twin
