#include "observe/trail.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace talus::observe {
namespace {

constexpr double unreached = std::numeric_limits<double>::infinity();
constexpr double longest_sight = 200;  ///< cells; a bend is inserted after this length, which hardly changes any
                                       ///< distance
constexpr double widest_gap = 2;       ///< times an island's narrowest: one beside the trail has many about as narrow

double distance(const PlanPoint& a, const PlanPoint& b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}

/// Calls f for the up to eight cells around one.
template <class Function>
void for_each_neighbour(const GridGeometry& g, std::int32_t cell, const Function& f) {
    const int column = cell % g.columns, row = cell / g.columns;
    for (int r = std::max(0, row - 1); r <= std::min(g.rows - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(g.columns - 1, column + 1); ++c) {
            const auto other = static_cast<std::int32_t>(g.index(c, r));
            if (other != cell) f(other);
        }
    }
}

}  // namespace

TrailDistances::TrailDistances(const Grid<float>& covered, const PlanPoint& from)
    : geometry_(covered.geometry),
      from_(from),
      covered_(covered.values.size()),
      settled_(covered.values.size(), 0),
      length_(covered.values.size(), unreached),
      bend_(covered.values.size(), -1),
      upstream_(covered.values.size(), -1) {
    std::transform(covered.values.begin(), covered.values.end(), covered_.begin(),
                   [](float value) { return static_cast<std::uint8_t>(!std::isnan(value)); });
    const Cell first = nearest_covered(from);
    if (first < 0) return;
    length_[static_cast<std::size_t>(first)] = distance(from, centre(first));
    open_.emplace_back(length_[static_cast<std::size_t>(first)], first);
    search();
    join_islands();
}

void TrailDistances::search() {
    while (!open_.empty()) {
        std::pop_heap(open_.begin(), open_.end(), std::greater<>{});
        const Cell cell = open_.back().second;
        open_.pop_back();
        const auto k = static_cast<std::size_t>(cell);
        if (settled_[k] != 0) continue;
        settle(cell);
        for_each_neighbour(geometry_, cell, [&](Cell other) {
            const auto n = static_cast<std::size_t>(other);
            if (settled_[n] != 0 || covered_[n] == 0) return;
            // Assumes that it is visible from the last bend: settle() checks.
            const double way = bend_length(cell) + distance(bend(cell), centre(other));
            if (way >= length_[n]) return;
            length_[n] = way;
            bend_[n] = bend_[k];
            open_.emplace_back(way, other);
            std::push_heap(open_.begin(), open_.end(), std::greater<>{});
        });
    }
}

void TrailDistances::settle(Cell cell) {
    const auto k = static_cast<std::size_t>(cell);
    if (bend_[k] != cell && !in_sight(bend(cell), centre(cell))) {
        double shortest = unreached;
        if (upstream_[k] >= 0) {  // an island's cell that a gap leads to
            shortest = length_[k] = length_at(upstream_[k]) + distance(centre(upstream_[k]), centre(cell));
            bend_[k] = cell;
        }
        const auto try_from = [&](Cell at, double way) {
            if (way >= shortest) return;
            shortest = length_[k] = way;
            bend_[k] = at;
        };
        for_each_neighbour(geometry_, cell, [&](Cell other) {
            const auto n = static_cast<std::size_t>(other);
            if (settled_[n] == 0) return;
            try_from(other, length_[n] + distance(centre(other), centre(cell)));
            if (in_sight(bend(other), centre(cell))) {
                try_from(bend_[n], bend_length(other) + distance(bend(other), centre(cell)));
            }
        });
    }
    if (bend_[k] != cell) upstream_[k] = bend_[k];
    settled_[k] = 1;
}

/// In the order of their distance from the trail, as Prim (1957) joins towns: an island beyond another one is reached
/// over that. The trail's own lengths stay.
void TrailDistances::join_islands() {
    std::vector<Edge> edges = island_edges();
    if (edges.empty()) return;
    std::vector<Place> joined;  // since the last island
    for (std::size_t k = 0; k < covered_.size(); ++k) {
        const auto cell = static_cast<Cell>(k);
        if (settled_[k] != 0 && at_edge(cell)) joined.push_back({centre(cell), cell});
    }
    while (!edges.empty()) {
        for (Edge& edge : edges) approach(edge, joined);
        const auto nearest = std::min_element(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) {
            return std::pair(a.gap, length_at(a.from)) < std::pair(b.gap, length_at(b.from));
        });
        const double widest = widest_gap * nearest->gap;
        const std::int32_t island = nearest->island;
        const auto rest = std::partition(edges.begin(), edges.end(), [&](const Edge& s) { return s.island != island; });
        joined.clear();
        for (auto edge = rest; edge != edges.end(); ++edge) {
            joined.push_back({centre(edge->cell), edge->cell});
            if (edge->gap > widest) continue;
            const auto k = static_cast<std::size_t>(edge->cell);
            length_[k] = length_at(edge->from) + edge->gap;
            bend_[k] = edge->cell;
            upstream_[k] = edge->from;
            open_.emplace_back(length_[k], edge->cell);
        }
        edges.erase(rest, edges.end());
        std::make_heap(open_.begin(), open_.end(), std::greater<>{});
        search();
    }
}

std::vector<TrailDistances::Edge> TrailDistances::island_edges() const {
    std::vector<Edge> edges;
    std::vector<std::uint8_t> seen = settled_;
    std::vector<Cell> cells;
    std::int32_t island = 0;
    for (std::size_t k = 0; k < covered_.size(); ++k) {
        if (covered_[k] == 0 || seen[k] != 0) continue;
        cells.assign(1, static_cast<Cell>(k));
        seen[k] = 1;
        while (!cells.empty()) {
            const Cell cell = cells.back();
            cells.pop_back();
            if (at_edge(cell)) edges.push_back({cell, island});
            for_each_neighbour(geometry_, cell, [&](Cell other) {
                const auto n = static_cast<std::size_t>(other);
                if (covered_[n] == 0 || seen[n] != 0) return;
                seen[n] = 1;
                cells.push_back(other);
            });
        }
        ++island;
    }
    return edges;
}

bool TrailDistances::at_edge(Cell cell) const {
    bool beside_dry = false;
    for_each_neighbour(geometry_, cell,
                       [&](Cell other) { beside_dry = beside_dry || covered_[static_cast<std::size_t>(other)] == 0; });
    return beside_dry;
}

void TrailDistances::approach(Edge& edge, const std::vector<Place>& joined) const {
    const PlanPoint at = centre(edge.cell);
    double nearest = edge.gap * edge.gap;
    for (const Place& place : joined) {
        const double dx = place.at.x - at.x, dy = place.at.y - at.y, square = dx * dx + dy * dy;
        if (square > nearest || (square == nearest && length_at(place.cell) >= length_at(edge.from))) continue;
        nearest = square;
        edge.from = place.cell;
    }
    edge.gap = std::sqrt(nearest);
}

bool TrailDistances::in_sight(const PlanPoint& a, const PlanPoint& b) const {
    const double length = distance(a, b) / geometry_.cell;
    if (length > longest_sight) return false;
    if (length < 1.5) return true;  // adjacent, also diagonally
    const auto samples = static_cast<int>(std::ceil(2 * length));
    for (int s = 1; s < samples; ++s) {
        const double share = static_cast<double>(s) / samples;
        const auto c = static_cast<int>((a.x + share * (b.x - a.x) - geometry_.x_min) / geometry_.cell);
        const auto r = static_cast<int>((a.y + share * (b.y - a.y) - geometry_.y_min) / geometry_.cell);
        if (c < 0 || r < 0 || c >= geometry_.columns || r >= geometry_.rows || covered_[geometry_.index(c, r)] == 0) {
            return false;
        }
    }
    return true;
}

TrailDistances::Cell TrailDistances::nearest_covered(const PlanPoint& p) const {
    const double u = (p.x - geometry_.x_min) / geometry_.cell, v = (p.y - geometry_.y_min) / geometry_.cell;
    if (u >= 0 && v >= 0 && u < geometry_.columns && v < geometry_.rows) {
        const std::size_t k = geometry_.index(static_cast<int>(u), static_cast<int>(v));
        if (covered_[k] != 0) return static_cast<Cell>(k);
    }
    // In squares that double until one holds a covered cell.
    const int column = static_cast<int>(std::clamp(u, 0.0, geometry_.columns - 1.0));
    const int row = static_cast<int>(std::clamp(v, 0.0, geometry_.rows - 1.0));
    Cell nearest = -1;
    for (int reach = 2; nearest < 0 && reach < 2 * (geometry_.columns + geometry_.rows); reach *= 2) {
        double shortest = unreached;
        for (int r = std::max(0, row - reach); r <= std::min(geometry_.rows - 1, row + reach); ++r) {
            for (int c = std::max(0, column - reach); c <= std::min(geometry_.columns - 1, column + reach); ++c) {
                const std::size_t k = geometry_.index(c, r);
                const double d = distance(p, geometry_.centre(c, r));
                if (covered_[k] == 0 || d >= shortest) continue;
                shortest = d;
                nearest = static_cast<Cell>(k);
            }
        }
    }
    return nearest;
}

PlanPoint TrailDistances::centre(Cell cell) const {
    return geometry_.centre(cell % geometry_.columns, cell / geometry_.columns);
}

PlanPoint TrailDistances::bend(Cell cell) const {
    const Cell at = bend_[static_cast<std::size_t>(cell)];
    return at < 0 ? from_ : centre(at);
}

double TrailDistances::bend_length(Cell cell) const {
    return length_at(bend_[static_cast<std::size_t>(cell)]);
}

std::optional<std::size_t> TrailDistances::cell_on_way(const PlanPoint& p, double along) const {
    Cell cell = nearest_covered(p);
    if (cell < 0) return {};
    // Upstream from bend to bend, until the place lies between the bend and what comes after it.
    const auto upstream = [&](Cell c) { return upstream_[static_cast<std::size_t>(c)]; };
    PlanPoint after = p;
    while (length_at(upstream(cell)) > along) {
        cell = upstream(cell);
        after = centre(cell);
    }
    const Cell before = upstream(cell);
    const PlanPoint from = before < 0 ? from_ : centre(before);
    const double length = distance(from, after);
    const double share = length > 0 ? std::min(1.0, (along - length_at(before)) / length) : 0;
    const double u = (from.x + share * (after.x - from.x) - geometry_.x_min) / geometry_.cell;
    const double v = (from.y + share * (after.y - from.y) - geometry_.y_min) / geometry_.cell;
    if (!(u >= 0 && v >= 0 && u < geometry_.columns && v < geometry_.rows)) return {};
    const std::size_t k = geometry_.index(static_cast<int>(u), static_cast<int>(v));
    return covered_[k] != 0 ? std::optional(k) : std::nullopt;
}

double TrailDistances::to(const PlanPoint& p) const {
    const Cell cell = nearest_covered(p);
    return cell < 0 ? never : bend_length(cell) + distance(bend(cell), p);
}

}  // namespace talus::observe
