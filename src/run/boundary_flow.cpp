#include "run/boundary_flow.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace talus::run {
namespace {

constexpr double finest_piece = 2;        // m, of the boundary
constexpr int spacings_of_piece = 8;      // at least, of an inflow
constexpr double part_of_volume = 0.999;  // of a piece; the rest trickles in for minutes and comes with it

double dot(const PlanPoint& a, const PlanPoint& b) {
    return a.x * b.x + a.y * b.y;
}

double signed_area(const Ring& ring) {
    double sum = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const PlanPoint &a = ring[k], &b = ring[(k + 1) % ring.size()];
        sum += (a.x * b.y - b.x * a.y) / 2;
    }
    return sum;
}

struct CellIndex {
    int column = 0, row = 0;
};
std::optional<CellIndex> cell_at(const GridGeometry& g, const PlanPoint& p) {
    const double column = std::floor((p.x - g.x_min) / g.cell), row = std::floor((p.y - g.y_min) / g.cell);
    if (!(column >= 0 && row >= 0 && column < g.columns && row < g.rows)) return {};
    return CellIndex{static_cast<int>(column), static_cast<int>(row)};
}

/// Rows of a hydrograph in the middles of intervals, whose integral over time is `volume`.
std::vector<params::InflowSample> hydrograph_of(const std::vector<params::InflowSample>& flow, double volume) {
    double sum = 0;
    for (const params::InflowSample& row : flow) sum += row.discharge * BoundaryFlow::interval;
    std::vector<params::InflowSample> rows;
    double before = 0;
    for (std::size_t k = 0; k < flow.size() && before <= part_of_volume * sum; ++k) {
        before += flow[k].discharge * BoundaryFlow::interval;
        if (rows.empty() && flow[k].discharge <= 0) continue;
        if (rows.empty())
            rows.push_back({std::max(0.0, flow[k].time - BoundaryFlow::interval), 0, flow[k].velocity, 0,
                            flow[k].pore_pressure_ratio});
        rows.push_back(flow[k]);
    }
    rows.push_back(
        {rows.back().time + BoundaryFlow::interval, 0, rows.back().velocity, 0, rows.back().pore_pressure_ratio});
    terrain::Inflow whole;
    whole.hydrograph = rows;
    const double scale = volume / whole.volume();
    for (params::InflowSample& row : rows) row.discharge *= scale;
    return rows;
}

}  // namespace

BoundaryFlow::Interval& BoundaryFlow::Interval::operator+=(const Interval& more) {
    volume += more.volume;
    momentum_x += more.momentum_x;
    momentum_y += more.momentum_y;
    pore_pressure += more.pore_pressure;
    return *this;
}

BoundaryFlow::BoundaryFlow(const depth::Solver& solver, const Polygon& area) : cells_(solver.geometry()) {
    const GridGeometry& cells = cells_;
    const double piece = std::max(finest_piece, cells.cell);
    const Ring& ring = area.outer;
    const double turn = signed_area(ring) > 0 ? 1 : -1;  // inward is to the left of a ring against the clock
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const PlanPoint &a = ring[k], &b = ring[(k + 1) % ring.size()];
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        if (!(length > 0)) continue;
        const PlanPoint along{(b.x - a.x) / length, (b.y - a.y) / length};
        const int count = std::max(1, static_cast<int>(std::lround(length / piece)));
        for (int part = 0; part < count; ++part) {
            const double at = (part + 0.5) * length / count;
            Piece one;
            one.centre = {a.x + at * along.x, a.y + at * along.y};
            one.along = along;
            one.inward = {-turn * along.y, turn * along.x};
            one.length = length / count;
            one.edge = k;
            if (const auto cell = cell_at(cells, one.centre)) {
                one.slope_x = solver.slope_x_at(cell->column, cell->row);
                one.slope_y = solver.slope_y_at(cell->column, cell->row);
            }
            pieces_.push_back(std::move(one));
        }
    }
    constexpr int parts = 8;
    const Extent e = extent_of(area).grown(cells.cell);
    for (int row = 0; row < cells.rows; ++row) {
        for (int column = 0; column < cells.columns; ++column) {
            const PlanPoint centre = cells.centre(column, row);
            if (!e.contains(centre)) continue;
            int count = 0;
            for (int k = 0; k < parts * parts; ++k) {
                const int east = k % parts, north = k / parts;
                count += contains(area, {centre.x + ((east + 0.5) / parts - 0.5) * cells.cell,
                                         centre.y + ((north + 0.5) / parts - 0.5) * cells.cell})
                             ? 1
                             : 0;
            }
            if (count > 0) inside_.emplace_back(cells.index(column, row), static_cast<float>(count) / (parts * parts));
        }
    }
}

double BoundaryFlow::volume_inside(const depth::Solver& solver) const {
    double sum = 0;
    for (const auto& [cell, share] : inside_) {
        const auto columns = static_cast<std::size_t>(cells_.columns);
        sum += double{share} * solver.depth_at(static_cast<int>(cell % columns), static_cast<int>(cell / columns));
    }
    return sum * cells_.cell * cells_.cell;
}

void BoundaryFlow::record(const depth::Solver& solver) {
    const double step = solver.time_step();
    const auto at = static_cast<std::size_t>(std::max(0.0, solver.time() - step / 2) / BoundaryFlow::interval);
    for (Piece& piece : pieces_) {
        constexpr int samples = 4;
        for (int k = 0; k < samples; ++k) {
            const double off = ((k + 0.5) / samples - 0.5) * piece.length;
            // Debris that comes in is seen half a cell before the boundary, and that which leaves half a cell within.
            for (const double side : {-0.5, 0.5}) {
                const double inwards = side * cells_.cell;
                const auto cell = cell_at(cells_, {piece.centre.x + off * piece.along.x + inwards * piece.inward.x,
                                                   piece.centre.y + off * piece.along.y + inwards * piece.inward.y});
                if (!cell) continue;
                const double depth = solver.depth_at(cell->column, cell->row);
                const double u = solver.u_at(cell->column, cell->row), v = solver.v_at(cell->column, cell->row);
                const double crosses = u * piece.inward.x + v * piece.inward.y;
                const double volume = depth * std::abs(crosses) * piece.length / samples * step;
                if (side > 0 && crosses < 0) out_ += volume;
                if (side > 0 || !(volume > 0) || crosses < 0) continue;
                in_ += volume;
                if (piece.intervals.size() <= at) piece.intervals.resize(at + 1);
                Interval& now = piece.intervals[at];
                now.volume += volume;
                now.momentum_x += volume * u;
                now.momentum_y += volume * v;
                now.pore_pressure +=
                    volume * static_cast<double>(solver.pore_pressure_ratio_at(cell->column, cell->row));
                const double sx = solver.slope_x_at(cell->column, cell->row);
                const double sy = solver.slope_y_at(cell->column, cell->row);
                thickness_ = std::max(thickness_, depth / std::sqrt(1 + sx * sx + sy * sy));
            }
        }
    }
    gained_ = volume_inside(solver);
    carries_pore_pressure_ = solver.carries_pore_pressure();
}

void BoundaryFlow::bring(const PlanPoint& place, double time, double volume, double u, double v) {
    const auto distance = [&](const Piece& piece) {
        return std::hypot(piece.centre.x - place.x, piece.centre.y - place.y);
    };
    Piece& piece = *std::min_element(pieces_.begin(), pieces_.end(),
                                     [&](const Piece& a, const Piece& b) { return distance(a) < distance(b); });
    const auto at = static_cast<std::size_t>(std::max(0.0, time) / BoundaryFlow::interval);
    if (piece.intervals.size() <= at) piece.intervals.resize(at + 1);
    piece.intervals[at].volume += volume;
    piece.intervals[at].momentum_x += volume * u;
    piece.intervals[at].momentum_y += volume * v;
    in_ += volume;
    gained_ += volume;
}

BoundaryFlow::Volumes BoundaryFlow::volumes() const {
    const double lacks = in_ + out_ > 0 ? (gained_ - (in_ - out_)) / (in_ + out_) : 0;
    return {in_ * (1 + lacks), out_ * (1 - lacks), in_, out_};
}

std::vector<double> BoundaryFlow::discharge() const {
    std::vector<double> all;
    const double scale = in_ > 0 ? volumes().in / in_ / BoundaryFlow::interval : 0;
    for (const Piece& piece : pieces_) {
        if (all.size() < piece.intervals.size()) all.resize(piece.intervals.size());
        for (std::size_t k = 0; k < piece.intervals.size(); ++k) all[k] += piece.intervals[k].volume * scale;
    }
    return all;
}

PlanPoint BoundaryFlow::momentum() const {
    PlanPoint sum{0, 0};
    const double scale = in_ > 0 ? volumes().in / in_ : 0;
    for (const Piece& piece : pieces_) {
        for (const Interval& one : piece.intervals) {
            sum.x += one.momentum_x * scale;
            sum.y += one.momentum_y * scale;
        }
    }
    return sum;
}

/// Neighbours on an edge as one, so long that its particles stand in eight columns or more where the edge is.
std::vector<BoundaryFlow::Piece> BoundaryFlow::merged(double least_length) const {
    std::vector<Piece> all;
    for (std::size_t first = 0; first < pieces_.size();) {
        std::size_t last = first;
        while (last < pieces_.size() && pieces_[last].edge == pieces_[first].edge) ++last;
        const double length = pieces_[first].length;
        const auto count = std::clamp<std::size_t>(
            static_cast<std::size_t>(std::floor(static_cast<double>(last - first) * length / least_length)), 1,
            last - first);
        for (std::size_t part = 0; part < count; ++part) {
            const std::size_t from = first + part * (last - first) / count;
            const std::size_t to = first + (part + 1) * (last - first) / count;
            all.push_back(joined(from, to));
        }
        first = last;
    }
    return all;
}

BoundaryFlow::Piece BoundaryFlow::joined(std::size_t from, std::size_t to) const {
    Piece piece = pieces_[from];
    const double count = static_cast<double>(to - from);
    piece.centre = {(pieces_[from].centre.x + pieces_[to - 1].centre.x) / 2,
                    (pieces_[from].centre.y + pieces_[to - 1].centre.y) / 2};
    piece.length *= count;
    piece.slope_x /= count;
    piece.slope_y /= count;
    for (std::size_t k = from + 1; k < to; ++k) {
        const Piece& next = pieces_[k];
        piece.slope_x += next.slope_x / count;
        piece.slope_y += next.slope_y / count;
        if (piece.intervals.size() < next.intervals.size()) piece.intervals.resize(next.intervals.size());
        for (std::size_t i = 0; i < next.intervals.size(); ++i) piece.intervals[i] += next.intervals[i];
    }
    return piece;
}

std::vector<terrain::Inflow> BoundaryFlow::inflows(double particle_spacing) const {
    const double particle = std::pow(particle_spacing, 3);
    const double scale = in_ > 0 ? volumes().in / in_ : 0;
    std::vector<terrain::Inflow> inflows;
    double came = 0;
    long brought = 0;
    for (const Piece& piece : merged(spacings_of_piece * particle_spacing)) {
        Interval all;
        for (const Interval& one : piece.intervals) all += one;
        came += all.volume * scale;
        const long count = std::lround(came / particle) - brought;
        const double momentum = std::hypot(all.momentum_x, all.momentum_y);
        if (count <= 0 || !(momentum > 0)) continue;
        brought += count;
        const PlanPoint towards{all.momentum_x / momentum, all.momentum_y / momentum};
        const double rise = towards.x * piece.slope_x + towards.y * piece.slope_y;
        std::vector<params::InflowSample> flow;
        double velocity = 0, ratio = all.pore_pressure / all.volume;
        for (const Interval& one : piece.intervals) {
            const double along = one.momentum_x * towards.x + one.momentum_y * towards.y;
            if (one.volume > 0) velocity = std::max(0.0, along / one.volume) * std::sqrt(1 + rise * rise);
            if (one.volume > 0) ratio = one.pore_pressure / one.volume;
            flow.push_back({(static_cast<double>(flow.size()) + 0.5) * BoundaryFlow::interval,
                            one.volume / BoundaryFlow::interval, velocity, 0, carries_pore_pressure_ ? ratio : -1});
        }
        terrain::Inflow inflow;
        inflow.name = fmt::format("boundary of the zoom {}", inflows.size() + 1);
        const double half = std::max(particle_spacing, piece.length * std::abs(dot(piece.inward, towards))) / 2;
        // Its right is the direction of flow.
        inflow.from = {piece.centre.x + half * towards.y, piece.centre.y - half * towards.x};
        inflow.to = {piece.centre.x - half * towards.y, piece.centre.y + half * towards.x};
        inflow.hydrograph = hydrograph_of(flow, static_cast<double>(count) * particle);
        inflow.spec.name = inflow.name;
        inflow.spec.line = {inflow.from, inflow.to};
        inflows.push_back(std::move(inflow));
    }
    return inflows;
}

}  // namespace talus::run
