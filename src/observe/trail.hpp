#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "observe/observation.hpp"

namespace talus {

/// Lengths in plan of the shortest ways over the ground that debris covered, from one place: how far debris ran along
/// its flow, round bends and past what it did not cover. No line that was drawn or traced beforehand has a part in it.
///
/// Dijkstra's search over the covered cells, in which the way to a cell leads straight on from where the last bend was,
/// where the straight line stays on the trail (lazy Theta*: Nash, Koenig & Tovey 2010): on open ground it is the
/// straight distance, without the 8 % that steps from cell to cell add.
class TrailWays {
  public:
    /// `covered`: NaN where debris never came. Parts that debris reached through the air are joined to the nearest.
    TrailWays(const Grid<float>& covered, const PlanPoint& from);

    /// m; to the nearest covered cell and straight on for a place off the trail. NaN: nothing is covered.
    [[nodiscard]] double to(const PlanPoint& p) const;
    /// To the cell's centre; NaN: not covered.
    [[nodiscard]] double at(std::size_t cell) const { return covered_[cell] != 0 ? length_[cell] : never; }

  private:
    using Cell = std::int32_t;

    void search(bool anywhere);
    void settle(Cell cell, bool anywhere);
    [[nodiscard]] bool in_sight(const PlanPoint& a, const PlanPoint& b, bool anywhere) const;
    [[nodiscard]] Cell nearest_covered(const PlanPoint& p) const;
    [[nodiscard]] PlanPoint centre(Cell cell) const;
    /// Where the last bend on the way to a cell is.
    [[nodiscard]] PlanPoint bend(Cell cell) const;
    [[nodiscard]] double bend_length(Cell cell) const;

    GridGeometry geometry_;
    PlanPoint from_;
    std::vector<std::uint8_t> covered_, settled_;
    std::vector<double> length_;
    std::vector<Cell> bend_;  // the cell of the last bend; -1: straight from `from_`
    std::vector<std::pair<double, Cell>> open_;
};

}  // namespace talus
