#pragma once

#include <cmath>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"

namespace talus {

/// The ground below a plan position.
template <class Real>
struct GroundSample {
    Real height{};        ///< local z of the ground, m
    Vec3<Real> normal{};  ///< unit, upward
};

/// A height field: elevations at the centres of square cells, between them bicubic Hermite patches (without twist), in
/// a local float frame. Height and normal belong to one smooth surface: on facets debris would lose speed at every
/// kink, and with normals that are not those of the heights it would gain or lose energy. Slopes at the centres are
/// central differences, limited as van Leer (1977) does, so that the ground does not swell beside a cliff.
///
/// Debris can be on it where `covers` holds: inside the hull of the cell centres and away from nodata.
/// A height's cell index and fraction come from the same floor(): taken from two roundings, a particle exactly on
/// a cell edge would see the ground jump.
class Terrain {
  public:
    Terrain() = default;

    /// `elevation`: world elevations in m, NaN where there is no data; at least 2 x 2 cells.
    /// The frame's origin is the middle of the grid, at the lowest elevation.
    explicit Terrain(Grid<float> elevation);

    [[nodiscard]] const LocalFrame& frame() const { return frame_; }
    /// World elevations as given (NaN: no data).
    [[nodiscard]] const Grid<float>& elevation() const { return elevation_; }
    [[nodiscard]] double cell() const { return elevation_.geometry.cell; }

    /// Whether the ground is known at a local plan position.
    template <class Real>
    [[nodiscard]] bool covers(Real x, Real y) const {
        const Cell<Real> c = locate(x, y);
        return c.inside && !std::isnan(corner_sum(c.index));
    }

    /// Ground height and normal at a local plan position. Outside the grid, the nearest edge cell's plane goes on.
    template <class Real>
    [[nodiscard]] GroundSample<Real> sample(Real x, Real y) const {
        const Cell<Real> c = locate(x, y);
        const Basis<Real> along_x(c.fx), along_y(c.fy);
        Real height{}, rise_x{}, rise_y{};  // rises per cell
        for (const int row : {0, 1}) {
            for (const int column : {0, 1}) {
                const Node& node =
                    nodes_[c.index + static_cast<std::size_t>(row) * stride_ + static_cast<std::size_t>(column)];
                const Real value_x = along_x.value[column], value_y = along_y.value[row];
                const Real by_height = Real(node.height), by_x = Real(node.rise_x), by_y = Real(node.rise_y);
                const Real in_x = by_height * value_x + by_x * along_x.slope[column];
                height += in_x * value_y + by_y * value_x * along_y.slope[row];
                rise_x += (by_height * along_x.value_rise[column] + by_x * along_x.slope_rise[column]) * value_y +
                          by_y * along_x.value_rise[column] * along_y.slope[row];
                rise_y += in_x * along_y.value_rise[row] + by_y * value_x * along_y.slope_rise[row];
            }
        }
        height += rise_x * along_x.beyond + rise_y * along_y.beyond;
        const Real slope_x = rise_x * Real(inverse_cell_), slope_y = rise_y * Real(inverse_cell_);
        const Real inverse_length = Real(1) / std::sqrt(Real(1) + slope_x * slope_x + slope_y * slope_y);
        return {height, {-slope_x * inverse_length, -slope_y * inverse_length, inverse_length}};
    }

    /// World elevation at a world plan position; NaN where not covered.
    [[nodiscard]] double elevation_at(const PlanPoint& p) const;

    /// Unit normal's z component (cosine of the slope) at a world plan position; NaN where not covered.
    [[nodiscard]] double slope_cosine_at(const PlanPoint& p) const;

  private:
    template <class Real>
    struct Cell {
        std::size_t index;
        Real fx, fy;
        bool inside;
    };

    template <class Real>
    Cell<Real> locate(Real x, Real y) const {
        const Real u = (x - Real(x_first_)) * Real(inverse_cell_), v = (y - Real(y_first_)) * Real(inverse_cell_);
        const bool inside = u >= 0 && v >= 0 && u <= Real(last_column_) && v <= Real(last_row_);
        // The comparison form also sends NaN to cell 0 instead of into an undefined conversion.
        const Real cu = std::floor(u > 0 ? (u < Real(last_column_ - 1) ? u : Real(last_column_ - 1)) : Real(0));
        const Real cv = std::floor(v > 0 ? (v < Real(last_row_ - 1) ? v : Real(last_row_ - 1)) : Real(0));
        return {static_cast<std::size_t>(cv) * stride_ + static_cast<std::size_t>(cu), u - cu, v - cv, inside};
    }

    /// Cubic Hermite basis at a fraction of the cell: what the values and the rises of its two ends weigh, and the
    /// derivatives of that. Beyond the cell the basis of its end goes on as a straight line.
    template <class Real>
    struct Basis {
        explicit Basis(Real fraction) {
            const Real t = fraction > 0 ? (fraction < 1 ? fraction : Real(1)) : Real(0), t2 = t * t, t3 = t2 * t;
            beyond = fraction - t;
            value[1] = 3 * t2 - 2 * t3;
            value[0] = 1 - value[1];
            slope[0] = t - 2 * t2 + t3;
            slope[1] = t3 - t2;
            value_rise[1] = 6 * (t - t2);
            value_rise[0] = -value_rise[1];
            slope_rise[0] = 1 - 4 * t + 3 * t2;
            slope_rise[1] = 3 * t2 - 2 * t;
        }
        Real value[2], slope[2], value_rise[2], slope_rise[2];
        Real beyond;
    };

    /// A cell centre: local z (NaN: no data), and its rise over one cell eastwards and northwards, m.
    struct Node {
        float height, rise_x, rise_y;
    };

    float corner_sum(std::size_t i) const {
        return nodes_[i].height + nodes_[i + 1].height + nodes_[i + stride_].height + nodes_[i + stride_ + 1].height;
    }

    Grid<float> elevation_;
    LocalFrame frame_;
    std::vector<Node> nodes_;
    std::size_t stride_ = 0;
    int last_column_ = 0, last_row_ = 0;
    float x_first_ = 0, y_first_ = 0;  // local position of the south-west cell's centre
    float inverse_cell_ = 0;
};

}  // namespace talus
