#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "observe/observation.hpp"

namespace talus::observe {

/// Lengths in plan of the shortest paths over the ground that debris covered, from one place: the run-out along the
/// flow, around bends and around ground that was not covered. Independent of any drawn or traced flow path.
///
/// Dijkstra's search over the covered cells, in which the path to a cell runs straight from the last bend, if the
/// straight line stays on the trail (lazy Theta*: Nash, Koenig & Tovey 2010): on open ground it is the straight
/// distance, without the 8 % that steps from cell to cell add.
///
/// Ground that debris reached through the air is an island. It is joined to what lies nearest over its narrowest gaps,
/// and only these cross ground that was not covered.
class TrailDistances {
  public:
    /// `covered`: NaN where debris never was.
    TrailDistances(const Grid<float>& covered, const PlanPoint& from);

    /// m; for a place off the trail, to the nearest covered cell and straight from there. NaN: no cell is covered.
    [[nodiscard]] double to(const PlanPoint& p) const;
    /// To the cell's centre; NaN: not covered.
    [[nodiscard]] double at(std::size_t cell) const { return covered_[cell] != 0 ? length_[cell] : never; }
    /// The covered cell at a distance, m, along the shortest path to `p`; empty: that place is not covered.
    [[nodiscard]] std::optional<std::size_t> cell_on_way(const PlanPoint& p, double distance) const;

  private:
    using Cell = std::int32_t;

    /// A cell at the edge of an island, and the nearest cell that was joined before.
    struct Edge {
        Cell cell = -1;
        std::int32_t island = -1;
        Cell from = -1;
        double gap = std::numeric_limits<double>::infinity();  ///< m
    };

    struct Place {
        PlanPoint at;
        Cell cell = -1;
    };

    void search();
    void settle(Cell cell);
    void join_islands();
    [[nodiscard]] std::vector<Edge> island_edges() const;
    [[nodiscard]] bool at_edge(Cell cell) const;
    void approach(Edge& edge, const std::vector<Place>& joined) const;
    [[nodiscard]] bool in_sight(const PlanPoint& a, const PlanPoint& b) const;
    [[nodiscard]] Cell nearest_covered(const PlanPoint& p) const;
    [[nodiscard]] PlanPoint centre(Cell cell) const;
    /// The last bend on the path to a cell.
    [[nodiscard]] PlanPoint bend(Cell cell) const;
    [[nodiscard]] double bend_length(Cell cell) const;
    /// 0 for -1.
    [[nodiscard]] double length_at(Cell cell) const { return cell < 0 ? 0 : length_[static_cast<std::size_t>(cell)]; }

    GridGeometry geometry_;
    PlanPoint from_;
    std::vector<std::uint8_t> covered_, settled_;
    std::vector<double> length_;
    std::vector<Cell> bend_;      // the cell of the last bend; -1: straight from `from_`
    std::vector<Cell> upstream_;  // the same, never the cell itself
    std::vector<std::pair<double, Cell>> open_;
};

}  // namespace talus::observe
