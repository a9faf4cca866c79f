#include "run/inflow_energy.hpp"

#include <algorithm>
#include <cmath>

namespace talus::run {

InflowEnergy::InflowEnergy(const depth::Solver& solver, const std::vector<terrain::Inflow>& inflows)
    : inflows_(inflows) {
    for (const terrain::Inflow& inflow : inflows) {
        places_.emplace_back();
        inflow.over_area() ? add_area(solver, inflow) : add_line(solver, inflow);
    }
}

double InflowEnergy::highest(const depth::Solver& solver) const {
    double highest = 0;
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const double speed = inflows_[k].velocity_at(solver.time());
        const double head = speed * speed / (2 * solver.material().gravity);
        for (const auto& [column, row] : places_[k]) {
            const double surface = double{solver.bed_at(column, row)} + solver.depth_at(column, row);
            highest = std::max(highest, surface + head);
        }
    }
    return highest;
}

void InflowEnergy::add_line(const depth::Solver& solver, const terrain::Inflow& inflow) {
    const PlanPoint along{inflow.to.x - inflow.from.x, inflow.to.y - inflow.from.y};
    const int parts = 1 + static_cast<int>(2 * std::hypot(along.x, along.y) / solver.geometry().cell);
    for (int k = 0; k <= parts; ++k) {
        const double s = static_cast<double>(k) / parts;
        add(solver, {inflow.from.x + s * along.x, inflow.from.y + s * along.y});
    }
}

void InflowEnergy::add_area(const depth::Solver& solver, const terrain::Inflow& inflow) {
    const GridGeometry& g = solver.geometry();
    for (const Polygon& polygon : inflow.area) {
        for (const PlanPoint& corner : polygon.outer) add(solver, corner);
        const Extent e = extent_of(polygon);
        for (double y = e.y_min; y <= e.y_max; y += g.cell) {
            for (double x = e.x_min; x <= e.x_max; x += g.cell) {
                if (contains(polygon, {x, y})) add(solver, {x, y});
            }
        }
    }
}

void InflowEnergy::add(const depth::Solver& solver, const PlanPoint& p) {
    const GridGeometry& g = solver.geometry();
    const double column = std::floor((p.x - g.x_min) / g.cell), row = std::floor((p.y - g.y_min) / g.cell);
    if (!(column >= 0 && row >= 0 && column < g.columns && row < g.rows)) return;
    const std::pair cell(static_cast<int>(column), static_cast<int>(row));
    if (solver.known(cell.first, cell.second)) places_.back().push_back(cell);
}

}  // namespace talus::run
