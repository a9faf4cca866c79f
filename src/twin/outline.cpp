#include "twin/outline.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"

namespace talus::twin {

Status check_overlaps(const terrain::Release& release, const Setup& setup, const std::string& own_id) {
    for (const ReleaseSetup& other : setup.releases) {
        if (other.id == own_id) continue;
        for (const terrain::ReleasePatch& theirs : other.body->patches) {
            for (const terrain::ReleasePatch& ours : release.patches) {
                const std::string shared = scene::shared_ground(ours.polygon, theirs.polygon);
                if (shared.empty()) continue;
                return Error{fmt::format("polygon: overlaps release \"{}\" {}", other.body->name, shared)};
            }
        }
    }
    return {};
}

Error missing(const char* key, const char* what) {
    return Error{fmt::format("{}: missing; a new {} needs it", key, what)};
}

Result<Redrawn> read_outline(const nlohmann::json& action, const char* outline, const char* what, bool exists) {
    Redrawn drawn;
    drawn.key = outline;
    TALUS_ASSIGN(drawn.ring, read_points(action, outline, true, 3, max_points));
    TALUS_ASSIGN(drawn.by, read_shift(action, "move_m"));
    if (drawn.by && !exists) return Error{fmt::format("move_m: needs the id of a {}", what)};
    if (drawn.by && drawn.ring) return Error{fmt::format("move_m: cannot go with {}; send one of them", outline)};
    if (drawn.by) drawn.key = "move_m";
    return drawn;
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
