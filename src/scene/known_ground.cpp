#include "scene/known_ground.hpp"

#include <cmath>

#include <fmt/format.h>

#include "scene/load.hpp"
#include "scene/polygons.hpp"
#include "terrain/barrier.hpp"

namespace talus::scene {

KnownGround known_ground(const Polygon& polygon, const terrain::Terrain& terrain) {
    KnownGround ground;
    const auto look = [&](const PlanPoint& p) {
        const bool known = !std::isnan(terrain.elevation_at(p));
        ground.any = ground.any || known;
        if (!known && !ground.bare) ground.bare = p;
    };
    for_each_on_rings(polygon, terrain.cell() / 2, look);
    for_each_inside(polygon, terrain.cell() / 2, look);
    return ground;
}

Status check_ground(const terrain::Terrain& terrain, const Polygon& polygon, const std::string& at, bool whole) {
    const KnownGround ground = known_ground(polygon, terrain);
    if (ground.any && !(whole && ground.bare)) return {};
    return Error{fmt::format("{}: reaches {}, where the ground is not known; the terrain covers {} at most", at,
                             place_text(*ground.bare), extent_text(covered_extent(terrain)))};
}

Status check_area(const terrain::Terrain& terrain, const Polygon& polygon, const std::string& at, bool whole) {
    if (terrain::meets_itself(polygon.outer)) return Error{at + ": touches or crosses itself"};
    if (!(plan_area(polygon) > 0)) return Error{at + ": has no area"};
    return check_ground(terrain, polygon, at, whole);
}

std::string shared_ground(const Polygon& a, const Polygon& b) {
    const Overlap overlap = overlap_of(a, b);
    if (!is_true_overlap(overlap, a, b)) return "";
    return fmt::format("by {:.4g} m2 around {}; the same ground cannot fail twice", overlap.area,
                       place_text(overlap.place));
}

std::string covers_no_cell(const terrain::Terrain& terrain) {
    return fmt::format("covers the centre of no cell of the terrain, {} in cells of {:.6g} m",
                       extent_text(covered_extent(terrain)), terrain.cell());
}

}  // namespace talus::scene
