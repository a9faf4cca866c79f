#include "core/geometry.hpp"

#include <algorithm>

namespace talus {
namespace {

bool crosses(const Ring& ring, const PlanPoint& p) {
    bool inside = false;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
        const PlanPoint& a = ring[i];
        const PlanPoint& b = ring[j];
        if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) inside = !inside;
    }
    return inside;
}

double ring_area(const Ring& ring) {
    double twice = 0;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
        // Relative to the first point: the products of national-grid coordinates would cancel badly.
        const PlanPoint a{ring[j].x - ring[0].x, ring[j].y - ring[0].y};
        const PlanPoint b{ring[i].x - ring[0].x, ring[i].y - ring[0].y};
        twice += a.x * b.y - b.x * a.y;
    }
    return std::abs(twice) / 2;
}

}  // namespace

bool contains(const Polygon& polygon, const PlanPoint& point) {
    if (polygon.outer.empty() || !crosses(polygon.outer, point)) return false;
    return std::none_of(polygon.holes.begin(), polygon.holes.end(),
                        [&](const Ring& hole) { return !hole.empty() && crosses(hole, point); });
}

double plan_area(const Polygon& polygon) {
    if (polygon.outer.empty()) return 0;
    double area = ring_area(polygon.outer);
    for (const Ring& hole : polygon.holes) {
        if (!hole.empty()) area -= ring_area(hole);
    }
    return area;
}

void Extent::include(const PlanPoint& p) {
    x_min = std::min(x_min, p.x);
    y_min = std::min(y_min, p.y);
    x_max = std::max(x_max, p.x);
    y_max = std::max(y_max, p.y);
}

Extent extent_of(const Polygon& polygon) {
    if (polygon.outer.empty()) return {};
    const PlanPoint& first = polygon.outer.front();
    Extent extent{first.x, first.y, first.x, first.y};
    for (const PlanPoint& p : polygon.outer) extent.include(p);
    return extent;
}

}  // namespace talus
