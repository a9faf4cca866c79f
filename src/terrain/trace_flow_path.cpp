#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include "terrain/flow_path.hpp"

namespace talus::terrain {
namespace {

struct Step {
    int column, row;
    float length;  ///< in cells
};
constexpr float diagonal = 1.41421356F;
constexpr std::array<Step, 8> neighbours{{{1, 0, 1},
                                          {0, 1, 1},
                                          {-1, 0, 1},
                                          {0, -1, 1},
                                          {1, 1, diagonal},
                                          {-1, 1, diagonal},
                                          {-1, -1, diagonal},
                                          {1, -1, diagonal}}};

/// Elevations without sinks: from every cell some neighbour is not higher, down to an edge of the data.
struct FilledSurface {
    Grid<float> elevation;
    /// The neighbour over which the flood came (index into `neighbours`), -1 at an edge of the data. Following it never
    /// climbs and, because the flood reached that neighbour earlier, never returns.
    std::vector<int> outlet;
};

bool inside(const GridGeometry& g, int column, int row) {
    return column >= 0 && row >= 0 && column < g.columns && row < g.rows;
}

bool at_edge_of_data(const Grid<float>& elevation, int column, int row) {
    return std::any_of(neighbours.begin(), neighbours.end(), [&](const Step& s) {
        const int c = column + s.column, r = row + s.row;
        return !inside(elevation.geometry, c, r) || std::isnan(elevation.at(c, r));
    });
}

/// Priority flood with a plain queue for cells below the water (Barnes, Lehman, Mulla 2014, algorithm 2).
FilledSurface fill_sinks(const Grid<float>& elevation) {
    const GridGeometry& g = elevation.geometry;
    FilledSurface filled{elevation, std::vector<int>(g.size(), -1)};
    std::vector<bool> reached(g.size(), false);
    // Ties in elevation go to the cell of lower index: so the path is the same on every machine.
    using Entry = std::pair<float, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    std::queue<std::size_t> pit;

    for (int r = 0; r < g.rows; ++r) {
        for (int c = 0; c < g.columns; ++c) {
            if (std::isnan(elevation.at(c, r)) || !at_edge_of_data(elevation, c, r)) continue;
            reached[g.index(c, r)] = true;
            open.emplace(elevation.at(c, r), g.index(c, r));
        }
    }
    while (!open.empty() || !pit.empty()) {
        std::size_t k = 0;
        if (!pit.empty()) {
            k = pit.front();
            pit.pop();
        } else {
            k = open.top().second;
            open.pop();
        }
        const auto columns = static_cast<std::size_t>(g.columns);
        const int column = static_cast<int>(k % columns), row = static_cast<int>(k / columns);
        for (std::size_t n = 0; n < neighbours.size(); ++n) {
            const int c = column + neighbours[n].column, r = row + neighbours[n].row;
            if (!inside(g, c, r)) continue;
            const std::size_t next = g.index(c, r);
            float& level = filled.elevation.values[next];
            if (reached[next] || std::isnan(level)) continue;
            reached[next] = true;
            // The direction back to this cell: a neighbour n and its opposite are two apart within their group of four.
            filled.outlet[next] = static_cast<int>(n < 4 ? (n + 2) % 4 : 4 + (n + 2) % 4);
            if (level <= filled.elevation.values[k]) {
                level = filled.elevation.values[k];
                pit.push(next);
            } else {
                open.emplace(level, next);
            }
        }
    }
    return filled;
}

/// The neighbour of steepest descent, or -1 where none is lower.
int steepest(const Grid<float>& elevation, int column, int row) {
    const float here = elevation.at(column, row);
    float best = 0;
    int found = -1;
    for (std::size_t n = 0; n < neighbours.size(); ++n) {
        const int c = column + neighbours[n].column, r = row + neighbours[n].row;
        if (!inside(elevation.geometry, c, r)) continue;
        const float slope = (here - elevation.at(c, r)) / neighbours[n].length;
        if (slope > best) {  // false for NaN
            best = slope;
            found = static_cast<int>(n);
        }
    }
    return found;
}

struct CellPosition {
    int column, row;
};

std::vector<CellPosition> descend(const Grid<float>& elevation, CellPosition start, double longest) {
    const FilledSurface filled = fill_sinks(elevation);
    const GridGeometry& g = elevation.geometry;
    std::vector<CellPosition> path{start};
    double run = 0;  // in metres
    const auto go = [&](int n) {
        const Step& s = neighbours[static_cast<std::size_t>(n)];
        path.push_back({path.back().column + s.column, path.back().row + s.row});
        run += s.length * g.cell;
    };
    while (run < longest) {
        const auto [column, row] = path.back();
        int n = steepest(filled.elevation, column, row);
        if (n < 0) n = filled.outlet[g.index(column, row)];  // over a filled sink to where it spills
        if (n < 0) break;
        go(n);
    }
    if (run >= longest) return path;

    // The end of the path over the filled surface may be level: open water, or a basin filled up to the edge of the
    // data. Nothing lower lies beyond it, so only the descent to it is kept.
    const auto level = [&](const CellPosition& p) { return filled.elevation.at(p.column, p.row); };
    while (path.size() > 1 && level(path[path.size() - 2]) == level(path.back())) path.pop_back();
    run = 0;
    for (std::size_t i = 1; i < path.size(); ++i) {
        run += std::hypot(path[i].column - path[i - 1].column, path[i].row - path[i - 1].row) * g.cell;
    }
    while (run < longest) {
        const int n = steepest(elevation, path.back().column, path.back().row);
        if (n < 0) break;
        go(n);
    }
    return path;
}

/// Weights 1 4 6 4 1, the ends kept.
void smooth(std::vector<PlanPoint>& points) {
    const std::vector<PlanPoint> raw = points;
    const auto last = static_cast<std::ptrdiff_t>(raw.size()) - 1;
    constexpr std::array<double, 5> weights{1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
    for (std::ptrdiff_t i = 1; i < last; ++i) {
        PlanPoint mean{0, 0};
        for (std::ptrdiff_t k = -2; k <= 2; ++k) {
            const PlanPoint& p = raw[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i + k, 0, last))];
            mean.x += weights[static_cast<std::size_t>(k + 2)] * p.x;
            mean.y += weights[static_cast<std::size_t>(k + 2)] * p.y;
        }
        points[static_cast<std::size_t>(i)] = mean;
    }
}

/// Leaves out points that lie within `tolerance` of the line through the kept ones (Douglas & Peucker 1973).
std::vector<PlanPoint> simplify(const std::vector<PlanPoint>& points, double tolerance) {
    std::vector<bool> keep(points.size(), false);
    keep.front() = keep.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        const PlanPoint &a = points[first], &b = points[last];
        const double dx = b.x - a.x, dy = b.y - a.y, length_squared = dx * dx + dy * dy;
        double farthest = tolerance;
        std::size_t split = 0;
        for (std::size_t i = first + 1; i < last; ++i) {
            const double px = points[i].x - a.x, py = points[i].y - a.y;
            const double t = length_squared > 0 ? std::clamp((px * dx + py * dy) / length_squared, 0.0, 1.0) : 0.0;
            const double distance = std::hypot(px - t * dx, py - t * dy);
            if (distance > farthest) {
                farthest = distance;
                split = i;
            }
        }
        if (split == 0) continue;
        keep[split] = true;
        open.emplace_back(first, split);
        open.emplace_back(split, last);
    }
    std::vector<PlanPoint> kept;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (keep[i]) kept.push_back(points[i]);
    }
    return kept;
}

}  // namespace

Result<std::vector<PlanPoint>> trace_flow_path(const Grid<float>& elevation, const PlanPoint& start, double longest) {
    const GridGeometry& g = elevation.geometry;
    const double u = std::floor((start.x - g.x_min) / g.cell), v = std::floor((start.y - g.y_min) / g.cell);
    const bool in_grid = u >= 0 && v >= 0 && u < g.columns && v < g.rows;
    if (!in_grid || std::isnan(elevation.at(static_cast<int>(u), static_cast<int>(v)))) {
        const Extent e = g.extent();
        return Error{"flow path: the start (" + std::to_string(start.x) + ", " + std::to_string(start.y) +
                     ") is outside the terrain's data, x " + std::to_string(e.x_min) + " to " +
                     std::to_string(e.x_max) + ", y " + std::to_string(e.y_min) + " to " + std::to_string(e.y_max) +
                     (in_grid ? " (nodata there)" : "") + "; move the release or give [flow_path] file"};
    }

    // The path cannot be longer than `longest`: fill sinks only within that distance.
    const double reach = std::clamp(longest / g.cell + 2, 2.0, 1e6);
    const int column = static_cast<int>(u), row = static_cast<int>(v), cells = static_cast<int>(reach);
    const int first_column = std::max(0, column - cells), first_row = std::max(0, row - cells);
    const GridGeometry part{g.x_min + first_column * g.cell, g.y_min + first_row * g.cell, g.cell,
                            std::min(g.columns, column + cells + 1) - first_column,
                            std::min(g.rows, row + cells + 1) - first_row};
    Grid<float> window(part);
    for (int r = 0; r < part.rows; ++r) {
        for (int c = 0; c < part.columns; ++c) window.at(c, r) = elevation.at(first_column + c, first_row + r);
    }

    const std::vector<CellPosition> cells_passed = descend(window, {column - first_column, row - first_row}, longest);
    std::vector<PlanPoint> points;
    points.reserve(cells_passed.size() + 1);
    for (const CellPosition& c : cells_passed) points.push_back(part.centre(c.column, c.row));
    points.front() = start;
    if (points.size() == 1) {  // the start is the lowest point there is: any direction will do
        points.push_back({start.x + g.cell, start.y});
    }
    smooth(points);
    return simplify(points, g.cell / 4);
}

}  // namespace talus::terrain
