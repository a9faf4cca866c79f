#include "geo/clip.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace talus::geo {
namespace {

PlanPoint between(const PlanPoint& a, const PlanPoint& b, double t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/// The share of a segment that lies within, from and to; empty: none of it.
std::optional<std::pair<double, double>> share_inside(const PlanPoint& a, const PlanPoint& b, const Extent& to) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    const std::array<std::pair<double, double>, 4> edges{
        {{-dx, a.x - to.x_min}, {dx, to.x_max - a.x}, {-dy, a.y - to.y_min}, {dy, to.y_max - a.y}}};
    double first = 0, last = 1;
    for (const auto& [p, q] : edges) {
        if (p == 0) {
            if (q < 0) return {};
        } else if (p < 0) {
            first = std::max(first, q / p);
        } else {
            last = std::min(last, q / p);
        }
    }
    if (first > last) return {};
    return std::pair{first, last};
}

/// The part of a ring on one side of a line; `depth`: how far inside a point is.
template <class Depth>
Ring half_of(const Ring& ring, const Depth& depth) {
    Ring kept;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const PlanPoint& a = ring[k];
        const PlanPoint& b = ring[(k + 1) % ring.size()];
        const double from = depth(a), to = depth(b);
        if (from >= 0) kept.push_back(a);
        if ((from >= 0) != (to >= 0)) kept.push_back(between(a, b, from / (from - to)));
    }
    return kept;
}

}  // namespace

std::vector<std::vector<PlanPoint>> clip_line(const std::vector<PlanPoint>& line, const Extent& to) {
    std::vector<std::vector<PlanPoint>> parts;
    bool goes_on = false;
    for (std::size_t k = 1; k < line.size(); ++k) {
        const auto share = share_inside(line[k - 1], line[k], to);
        if (!share) {
            goes_on = false;
            continue;
        }
        if (!goes_on || share->first > 0) parts.push_back({between(line[k - 1], line[k], share->first)});
        parts.back().push_back(between(line[k - 1], line[k], share->second));
        goes_on = share->second == 1;
    }
    return parts;
}

Ring clip_ring(const Ring& ring, const Extent& to) {
    Ring kept = half_of(ring, [&](const PlanPoint& p) { return p.x - to.x_min; });
    kept = half_of(kept, [&](const PlanPoint& p) { return to.x_max - p.x; });
    kept = half_of(kept, [&](const PlanPoint& p) { return p.y - to.y_min; });
    kept = half_of(kept, [&](const PlanPoint& p) { return to.y_max - p.y; });
    return kept.size() < 3 ? Ring() : kept;
}

}  // namespace talus::geo
