#include "twin/outline.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"

namespace talus::twin {

Error missing(const char* key, const char* what) {
    return Error{fmt::format("{}: missing; a new {} needs it", key, what)};
}

Result<Redrawn> read_redrawn(const nlohmann::json& action, const char* outline, const char* what, bool exists) {
    Redrawn drawn;
    drawn.key = outline;
    TALUS_ASSIGN(drawn.ring, read_points(action, outline, true, 3, max_points));
    TALUS_ASSIGN(drawn.by, read_shift(action, "move_m"));
    if (drawn.by && !exists) return Error{fmt::format("move_m: needs the id of a {}", what)};
    if (drawn.by && drawn.ring) return Error{fmt::format("move_m: cannot go with {}; send one of them", outline)};
    if (drawn.by) drawn.key = "move_m";
    return drawn;
}

Result<Redrawn> read_outline(const nlohmann::json& action, const char* outline, const char* what, bool exists) {
    TALUS_ASSIGN(Redrawn drawn, read_redrawn(action, outline, what, exists));
    if (!exists && !drawn.ring) return missing(outline, what);
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

Error not_of_a_setup(const char* key, const nlohmann::json& file) {
    const bool given = file.is_object() && file.contains(key);
    return Error{fmt::format("{} = {}: not what a setup has there", key, shown(given ? file[key] : file))};
}

Result<std::string> read_name(const nlohmann::json& file) {
    const auto name = read_text(file, "name", 1000);
    if (!name || !*name) return not_of_a_setup("name", file);
    return **name;
}

Result<std::vector<Polygon>> read_polygons(const nlohmann::json& file) {
    std::vector<Polygon> polygons;
    if (!file.contains("polygons") || !file["polygons"].is_array()) return not_of_a_setup("polygons", file);
    for (const nlohmann::json& rings : file["polygons"]) {
        if (!rings.is_array() || rings.empty()) return Error{fmt::format("rings = {}: must be rings", shown(rings))};
        Polygon& polygon = polygons.emplace_back();
        for (const nlohmann::json& each : rings) {
            TALUS_ASSIGN(auto ring, read_points({{"ring", each}}, "ring", true, 3, 1'000'000));
            if (!ring) return Error{"ring = null: must be points"};
            (&each == &rings.front() ? polygon.outer : polygon.holes.emplace_back()) = std::move(*ring);
        }
    }
    return polygons;
}

}  // namespace talus::twin
