#include "depth/inflow.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/angle.hpp"
#include "core/try.hpp"

namespace talus::depth {
namespace {

/// Places examined along a cell.
constexpr int area_parts = 8;

/// Of the line, seen from its first end to its second: to the right.
PlanPoint right_of(const terrain::Inflow& inflow) {
    const double dx = inflow.to.x - inflow.from.x, dy = inflow.to.y - inflow.from.y, length = std::hypot(dx, dy);
    return {dy / length, -dx / length};
}

/// Opposite to a direction; 0: at right angles to it.
int against(double component) {
    if (std::abs(component) < 1e-6) return 0;
    return component > 0 ? -1 : 1;
}

}  // namespace

Inflows::Inflows(const Solver& solver, const std::vector<terrain::Inflow>& inflows) : time_(solver.time()) {
    for (const terrain::Inflow& inflow : inflows) {
        Source source{inflow, {}};
        inflow.over_area() ? source.place_on_area(solver) : source.place_on_line(solver);
        double all = 0;
        for (const Cell& cell : source.cells) all += cell.share;
        for (Cell& cell : source.cells) cell.share /= all;
        source.find_velocities(solver);
        sources_.push_back(std::move(source));
    }
}

std::size_t Inflows::first_unplaced() const {
    const auto unplaced =
        std::find_if(sources_.begin(), sources_.end(), [](const Source& source) { return source.cells.empty(); });
    return static_cast<std::size_t>(unplaced - sources_.begin());
}

bool Inflows::to_come() const {
    return std::any_of(sources_.begin(), sources_.end(),
                       [&](const Source& source) { return time_ < source.inflow.hydrograph.back().time; });
}

Result<double> Inflows::advance(Solver& solver, double longest, Grid<float>& added, double left) {
    const double from = solver.time();
    for (const Source& source : sources_) longest = source.longest_step(solver, longest);
    const double step = solver.next_step(std::min(longest, left));
    for (const Source& source : sources_) {
        for (const Cell& cell : source.cells) solver.end_inflow(cell.column, cell.row);
    }
    for (const Source& source : sources_) source.begin_step(solver, step);
    TALUS_TRY(solver.advance(step));
    time_ = solver.time();
    double volume = 0;
    for (Source& source : sources_) volume += source.end_step(solver, from, added);
    return volume;
}

void Inflows::Source::place_on_line(const Solver& solver) {
    const GridGeometry& g = solver.geometry();
    const double dx = inflow.to.x - inflow.from.x, dy = inflow.to.y - inflow.from.y;
    // It is cut where it crosses the sides of cells.
    std::vector<double> cuts{0, 1};
    const auto cut = [&](double from, double length, double origin, int cells_along) {
        for (int k = 0; k <= cells_along && length != 0; ++k) {
            const double s = (origin + k * g.cell - from) / length;
            if (s > 0 && s < 1) cuts.push_back(s);
        }
    };
    cut(inflow.from.x, dx, g.x_min, g.columns);
    cut(inflow.from.y, dy, g.y_min, g.rows);
    std::sort(cuts.begin(), cuts.end());
    const PlanPoint right = right_of(inflow);
    const double beyond = 1e-6 * g.cell;  // of two cells that share the line, the one that debris enters
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const double s = (cuts[k] + cuts[k + 1]) / 2;
        add_place(solver, {inflow.from.x + s * dx + beyond * right.x, inflow.from.y + s * dy + beyond * right.y},
                  cuts[k + 1] - cuts[k]);
    }
    for (Cell& cell : cells) {
        const int x = against(right.x), y = against(right.y);
        if (!takes(cell.column + x, cell.row)) cell.from_x = x;
        if (!takes(cell.column, cell.row + y)) cell.from_y = y;
    }
}

void Inflows::Source::place_on_area(const Solver& solver) {
    const GridGeometry& g = solver.geometry();
    const double part = g.cell / area_parts;
    const auto first = [&](double from, double origin) {
        return origin + (std::floor((from - origin) / part) + 0.5) * part;
    };
    for (const Polygon& polygon : inflow.area) {
        const Extent e = extent_of(polygon);
        for (double y = first(e.y_min, g.y_min); y < e.y_max; y += part) {
            for (double x = first(e.x_min, g.x_min); x < e.x_max; x += part) {
                if (contains(polygon, {x, y})) add_place(solver, {x, y}, 1);
            }
        }
    }
    if (cells.empty()) add_place(solver, inflow.area.front().outer.front(), 1);  // a sliver
}

bool Inflows::Source::takes(int column, int row) const {
    return std::any_of(cells.begin(), cells.end(),
                       [&](const Cell& cell) { return cell.column == column && cell.row == row; });
}

void Inflows::Source::add_place(const Solver& solver, const PlanPoint& p, double size) {
    const GridGeometry& g = solver.geometry();
    const double column = std::floor((p.x - g.x_min) / g.cell), row = std::floor((p.y - g.y_min) / g.cell);
    if (!(column >= 0 && row >= 0 && column < g.columns && row < g.rows)) return;
    Cell cell;
    cell.column = static_cast<int>(column);
    cell.row = static_cast<int>(row);
    cell.share = size;
    if (!solver.known(cell.column, cell.row) || solver.built(cell.column, cell.row)) return;
    const auto at = std::lower_bound(cells.begin(), cells.end(), cell, [](const Cell& a, const Cell& b) {
        return std::tie(a.row, a.column) < std::tie(b.row, b.column);
    });
    if (at != cells.end() && at->row == cell.row && at->column == cell.column) {
        at->share += size;
    } else {
        cells.insert(at, cell);
    }
}

void Inflows::Source::find_velocities(const Solver& solver) {
    for (Cell& cell : cells) {
        const double slope_x = solver.slope_x_at(cell.column, cell.row),
                     slope_y = solver.slope_y_at(cell.column, cell.row);
        PlanPoint towards{0, 0};
        if (!inflow.over_area()) {
            towards = right_of(inflow);
        } else if (inflow.spec.direction) {
            const double angle = *inflow.spec.direction * radians_per_degree;
            towards = {std::sin(angle), std::cos(angle)};
        } else if (const double steep = std::hypot(slope_x, slope_y); steep > 0) {
            towards = {-slope_x / steep, -slope_y / steep};
        }
        const double rise = towards.x * slope_x + towards.y * slope_y, along = std::sqrt(1 + rise * rise);
        cell.east = towards.x / along;
        cell.north = towards.y / along;
    }
}

bool Inflows::Source::comes_in(double from, double to) const {
    return inflow.volume_until(to) > inflow.volume_until(from);
}

double Inflows::Source::longest_step(const Solver& solver, double longest) const {
    const double now = solver.time();
    // Hydrographs are linear between rows: a step ends where that is no longer so.
    for (const params::InflowSample& row : inflow.hydrograph) {
        if (row.time > now + 1e-9) longest = std::min(longest, row.time - now);
    }
    if (cells.empty() || !comes_in(now, now + longest)) return longest;
    const auto most =
        std::max_element(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.share < b.share; });
    const double cell = solver.geometry().cell, gravity = solver.material().gravity;
    // A step is stable with the waves of what comes in it: the shorter it is, the less that is.
    double low = 0, high = longest;
    for (int bisection = 0; bisection < 20; ++bisection) {
        const double step = (low + high) / 2;
        const double depth = (inflow.volume_until(now + step) - inflow.volume_until(now)) * most->share / (cell * cell);
        const double velocity = std::max(inflow.velocity_at(now), inflow.velocity_at(now + step));
        const double wave = std::sqrt(2.0) * velocity + 2 * std::sqrt(gravity * depth);
        (step * wave < solver.stable_step(1) ? low : high) = step;
    }
    return high;
}

void Inflows::Source::begin_step(Solver& solver, double step) const {
    const double from = solver.time(), to = from + step;
    if (inflow.over_area() || !comes_in(from, to)) return;
    const double volume = inflow.volume_until(to) - inflow.volume_until(from);
    const double velocity = (inflow.way_until(to) - inflow.way_until(from)) / step;
    const double rate = volume / (step * solver.geometry().cell * solver.geometry().cell);
    for (const Cell& cell : cells) {
        solver.add_inflow(cell.column, cell.row,
                          {rate * cell.share, velocity * cell.east, velocity * cell.north, cell.from_x, cell.from_y,
                           inflow.spec.solid_fraction});
    }
}

double Inflows::Source::end_step(Solver& solver, double from, Grid<float>& added) {
    const double now = solver.time(), area = solver.geometry().cell * solver.geometry().cell;
    if (!comes_in(from, now)) return 0;
    const double came = inflow.volume_until(now) - inflow.volume_until(from);
    const double velocity = (inflow.way_until(now) - inflow.way_until(from)) / (now - from);
    double sum = 0;
    for (Cell& cell : cells) {
        double depth = came * cell.share / area;
        if (inflow.over_area()) {
            const double due = depth + cell.owed, before = solver.depth_at(cell.column, cell.row);
            solver.inject(cell.column, cell.row, due, velocity * cell.east, velocity * cell.north,
                          inflow.spec.solid_fraction);
            depth = solver.depth_at(cell.column, cell.row) - before;
            cell.owed = due - depth;
        }
        sum += depth * area;
        added.at(cell.column, cell.row) += static_cast<float>(depth);
    }
    return sum;
}

}  // namespace talus::depth
