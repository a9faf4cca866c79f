#include "scene/polygons.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace talus::scene {
namespace {

constexpr int max_lines = 2000;

/// Where the line at `y` crosses the rings, sorted: inside from the first to the second, the third to the fourth, ...
void find_crossings(const Polygon& polygon, double y, std::vector<double>& crossings) {
    crossings.clear();
    const auto add = [&](const Ring& ring) {
        for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
            const PlanPoint &a = ring[j], &b = ring[i];
            if ((a.y > y) != (b.y > y)) crossings.push_back(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
        }
    };
    if (!polygon.outer.empty()) add(polygon.outer);
    for (const Ring& hole : polygon.holes) {
        if (!hole.empty()) add(hole);
    }
    std::sort(crossings.begin(), crossings.end());
}

}  // namespace

Overlap overlap_of(const Polygon& a, const Polygon& b) {
    const Extent ea = extent_of(a), eb = extent_of(b);
    const double bottom = std::max(ea.y_min, eb.y_min), top = std::min(ea.y_max, eb.y_max);
    Overlap overlap;
    if (!(top > bottom) || ea.x_max <= eb.x_min || eb.x_max <= ea.x_min) return overlap;
    const double strip = (top - bottom) / max_lines;
    std::vector<double> in_a, in_b;
    double widest = 0;
    for (int line = 0; line < max_lines; ++line) {
        const double y = bottom + (line + 0.5) * strip;
        find_crossings(a, y, in_a);
        find_crossings(b, y, in_b);
        for (std::size_t i = 0; i + 1 < in_a.size(); i += 2) {
            for (std::size_t k = 0; k + 1 < in_b.size(); k += 2) {
                const double left = std::max(in_a[i], in_b[k]), right = std::min(in_a[i + 1], in_b[k + 1]);
                if (!(right > left)) continue;
                overlap.area += (right - left) * strip;
                if (right - left > widest) {
                    widest = right - left;
                    overlap.place = {(left + right) / 2, y};
                }
            }
        }
    }
    return overlap;
}

bool is_true_overlap(const Overlap& overlap, const Polygon& a, const Polygon& b) {
    return overlap.area > 1e-3 * std::min(plan_area(a), plan_area(b));
}

void for_each_inside(const Polygon& polygon, double step, const std::function<void(const PlanPoint&)>& visit) {
    const Extent extent = extent_of(polygon);
    if (!(extent.height() > 0) || !(extent.width() > 0)) return;
    step = std::max(step, std::max(extent.width(), extent.height()) / max_lines);
    const int lines = std::max(1, static_cast<int>(std::ceil(extent.height() / step)));
    std::vector<double> crossings;
    for (int line = 0; line < lines; ++line) {
        const double y = extent.y_min + (line + 0.5) * extent.height() / lines;
        find_crossings(polygon, y, crossings);
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
            const double width = crossings[i + 1] - crossings[i];
            const int pieces = std::max(1, static_cast<int>(std::ceil(width / step)));
            for (int k = 0; k < pieces; ++k) visit({crossings[i] + (k + 0.5) * width / pieces, y});
        }
    }
}

void for_each_cell_inside(const Polygon& polygon, const GridGeometry& grid,
                          const std::function<void(int column, int row)>& visit) {
    const Extent extent = extent_of(polygon);
    const auto clamped = [](double cell, int count) { return static_cast<int>(std::clamp(cell, 0.0, double(count))); };
    const int last_row = clamped(std::ceil((extent.y_max - grid.y_min) / grid.cell), grid.rows);
    std::vector<double> crossings;
    for (int row = clamped(std::floor((extent.y_min - grid.y_min) / grid.cell), grid.rows); row < last_row; ++row) {
        find_crossings(polygon, grid.centre(0, row).y, crossings);
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
            const auto first_beyond = [&](double x) {
                return clamped(std::ceil((x - grid.x_min) / grid.cell - 0.5), grid.columns);
            };
            const int end = first_beyond(crossings[i + 1]);
            for (int column = first_beyond(crossings[i]); column < end; ++column) visit(column, row);
        }
    }
}

void for_each_on_rings(const Polygon& polygon, double step, const std::function<void(const PlanPoint&)>& visit) {
    const auto walk = [&](const Ring& ring) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
            const double pieces = std::clamp(std::ceil(std::hypot(b.x - a.x, b.y - a.y) / step), 1.0, 1e6);
            for (double k = 0; k < pieces; ++k) visit({a.x + (b.x - a.x) * k / pieces, a.y + (b.y - a.y) * k / pieces});
        }
    };
    walk(polygon.outer);
    for (const Ring& hole : polygon.holes) walk(hole);
}

}  // namespace talus::scene
