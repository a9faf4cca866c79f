#include "core/triangulate.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace talus {
namespace {

/// Twice the area of a triangle; positive where it runs counterclockwise.
double twice_area(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double signed_area(const Ring& ring) {
    double twice = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        // Relative to the first corner: products of national-grid coordinates lose what is left of a small area.
        twice += twice_area(ring.front(), ring[i], ring[(i + 1) % ring.size()]);
    }
    return twice / 2;
}

Ring turned(Ring ring, bool counterclockwise) {
    if ((signed_area(ring) > 0) != counterclockwise) std::reverse(ring.begin(), ring.end());
    return ring;
}

/// Whether two segments cross between their ends.
bool cross(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c, const PlanPoint& d) {
    return twice_area(a, b, c) * twice_area(a, b, d) < 0 && twice_area(c, d, a) * twice_area(c, d, b) < 0;
}

bool crosses_ring(const PlanPoint& a, const PlanPoint& b, const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        if (cross(a, b, ring[i], ring[(i + 1) % ring.size()])) return true;
    }
    return false;
}

/// Joins a hole to the outline by the shortest cut that crosses no ring.
void join(Ring& outline, const Ring& hole, const std::vector<Ring>& holes) {
    std::size_t from = 0, to = 0;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < outline.size(); ++i) {
        for (std::size_t k = 0; k < hole.size(); ++k) {
            const PlanPoint &a = outline[i], &b = hole[k];
            const double distance = (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
            if (distance >= shortest || crosses_ring(a, b, outline)) continue;
            if (std::any_of(holes.begin(), holes.end(), [&](const Ring& ring) { return crosses_ring(a, b, ring); })) {
                continue;
            }
            shortest = distance;
            from = i;
            to = k;
        }
    }
    Ring joined(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(from) + 1);
    for (std::size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(to + k) % hole.size()]);
    joined.insert(joined.end(), outline.begin() + static_cast<std::ptrdiff_t>(from), outline.end());
    outline = std::move(joined);
}

bool within(const PlanPoint& p, const PlanPoint& a, const PlanPoint& b, const PlanPoint& c) {
    return twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 && twice_area(c, a, p) >= 0;
}

/// Whether the corner `at` can be cut off: it is convex, and its triangle holds no other corner.
bool is_ear(const Ring& ring, std::size_t at) {
    const PlanPoint &a = ring[(at + ring.size() - 1) % ring.size()], &b = ring[at], &c = ring[(at + 1) % ring.size()];
    if (twice_area(a, b, c) <= 0) return false;
    return std::none_of(ring.begin(), ring.end(), [&](const PlanPoint& p) {
        return p != a && p != b && p != c && within(p, a, b, c);  // both ends of a cut are there twice
    });
}

}  // namespace

std::vector<PlanTriangle> triangulate(const Polygon& polygon) {
    if (polygon.outer.size() < 3) return {};
    Ring ring = turned(polygon.outer, true);
    std::vector<Ring> holes;
    for (const Ring& hole : polygon.holes) {
        if (hole.size() >= 3) holes.push_back(turned(hole, false));
    }
    for (const Ring& hole : holes) join(ring, hole, holes);

    std::vector<PlanTriangle> triangles;
    while (ring.size() >= 3) {
        std::size_t ear = 0;
        while (ear < ring.size() && !is_ear(ring, ear)) ++ear;
        if (ear == ring.size()) {
            // None is left among corners in one line, or where an outline crosses itself: one corner less may help.
            ring.pop_back();
            continue;
        }
        triangles.push_back({ring[(ear + ring.size() - 1) % ring.size()], ring[ear], ring[(ear + 1) % ring.size()]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    return triangles;
}

}  // namespace talus
