#pragma once

#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "core/geometry.hpp"

namespace talus {

/// Where a grid of square cells lies in the world. Row 0 is the southernmost row, column 0 the westernmost.
struct GridGeometry {
    double x_min{};  ///< west edge of column 0, m
    double y_min{};  ///< south edge of row 0, m
    double cell{};   ///< edge length of a cell, m
    int columns{};
    int rows{};

    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(columns) * rows; }
    [[nodiscard]] std::size_t index(int column, int row) const {
        assert(column >= 0 && column < columns && row >= 0 && row < rows);
        return static_cast<std::size_t>(row) * columns + column;
    }
    [[nodiscard]] PlanPoint centre(int column, int row) const {
        return {x_min + (column + 0.5) * cell, y_min + (row + 0.5) * cell};
    }
    [[nodiscard]] Extent extent() const { return {x_min, y_min, x_min + columns * cell, y_min + rows * cell}; }

    friend bool operator==(const GridGeometry&, const GridGeometry&) = default;
};

/// A raster: a value per cell, row-major from the south-west corner. Floats use NaN for "no data".
template <class T>
struct Grid {
    GridGeometry geometry;
    std::vector<T> values;

    Grid() = default;
    explicit Grid(const GridGeometry& g, T fill = T{}) : geometry(g), values(g.size(), fill) {}

    [[nodiscard]] T& at(int column, int row) { return values[geometry.index(column, row)]; }
    [[nodiscard]] const T& at(int column, int row) const { return values[geometry.index(column, row)]; }
};

/// The value of the cell that holds a world plan position, NaN outside the raster.
[[nodiscard]] inline float value_at(const Grid<float>& grid, const PlanPoint& p) {
    const GridGeometry& g = grid.geometry;
    const double column = std::floor((p.x - g.x_min) / g.cell), row = std::floor((p.y - g.y_min) / g.cell);
    if (!(column >= 0 && row >= 0 && column < g.columns && row < g.rows)) {
        return std::numeric_limits<float>::quiet_NaN();
    }
    return grid.at(static_cast<int>(column), static_cast<int>(row));
}

}  // namespace talus
