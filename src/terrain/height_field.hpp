#pragma once

#include <cmath>
#include <type_traits>

#include "core/geometry.hpp"
#include "core/number.hpp"

namespace talus::terrain {

/// The ground below a plan position.
template <class Real>
struct GroundSample {
    Real height{};        ///< local z of the ground, m
    Vec3<Real> normal{};  ///< unit, upward
};

/// What Terrain knows of the ground, by pointers: see there. It owns nothing, so that it can be copied to where debris
/// is moved.
struct HeightField {
    /// A cell centre: local z and its rise over one cell eastwards and northwards, m; NaN where there is no data,
    /// otherwise 0. In fours, which are loaded together.
    const Quad* nodes = nullptr;
    int stride = 0;
    int last_column = 0, last_row = 0;
    float x_first = 0, y_first = 0;  ///< local position of the south-west cell's centre
    float inverse_cell = 0;          ///< 1/m

    /// Whether the ground is known at a local plan position.
    template <class Real>
    [[nodiscard]] TALUS_INLINE bool covers(Real x, Real y) const {
        const auto c = locate(x, y);
        const bool inside = c.fx >= 0 && c.fy >= 0 && c.fx <= 1 && c.fy <= 1;
        return inside && !std::isnan(corner_marks(c.index));
    }

    /// Ground height and normal at a local plan position, finite everywhere. Outside the grid, the nearest edge cell's
    /// plane continues; where there is no data, that of the cells around.
    template <class Real>
    [[nodiscard]] TALUS_INLINE GroundSample<Real> sample(Real x, Real y) const {
        using std::sqrt;
        const auto c = locate(x, y);
        const Basis<Real> along_x(c.fx), along_y(c.fy);
        Real height{}, rise_x{}, rise_y{};  // rises per cell
        const auto add_corner = [&](const End<Real>& in_x, const End<Real>& in_y, const auto& node)
            __attribute__((always_inline)) {
            const Real by_height = Real(node.x), by_x = Real(node.y), by_y = Real(node.z);
            const Real here = by_height * in_x.value + by_x * in_x.slope;
            height += here * in_y.value + by_y * in_x.value * in_y.slope;
            rise_x += (by_height * in_x.value_rise + by_x * in_x.slope_rise) * in_y.value +
                      by_y * in_x.value_rise * in_y.slope;
            rise_y += here * in_y.value_rise + by_y * in_x.value * in_y.slope_rise;
        };
        const auto south = quad_pairs_at(nodes, c.index), north = quad_pairs_at(nodes + stride, c.index);
        add_corner(along_x.first, along_y.first, south.low);
        add_corner(along_x.last, along_y.first, south.high);
        add_corner(along_x.first, along_y.last, north.low);
        add_corner(along_x.last, along_y.last, north.high);
        height += rise_x * along_x.beyond + rise_y * along_y.beyond;
        const Real slope_x = rise_x * Real(inverse_cell), slope_y = rise_y * Real(inverse_cell);
        const Real inverse_length = Real(1) / sqrt(Real(1) + slope_x * slope_x + slope_y * slope_y);
        return {height, {-slope_x * inverse_length, -slope_y * inverse_length, inverse_length}};
    }

  private:
    template <class Index, class Real>
    struct Cell {
        Index index;
        Real fx, fy;  ///< from 0 to 1 inside the cell
    };

    template <class Real>
    TALUS_INLINE auto locate(Real x, Real y) const {
        const Real u = (x - Real(x_first)) * Real(inverse_cell), v = (y - Real(y_first)) * Real(inverse_cell);
        // This order of comparisons also maps NaN to a valid cell instead of an undefined conversion.
        const auto column = truncated(larger(Real(0), smaller(Real(last_column - 1), u)));
        const auto row = truncated(larger(Real(0), smaller(Real(last_row - 1), v)));
        using Index = std::remove_const_t<decltype(column)>;
        return Cell<Index, Real>{Index(row * stride + column), u - from_index<Real>(column), v - from_index<Real>(row)};
    }

    /// The weights of the value and the rise at one end of a cell, and their derivatives.
    template <class Real>
    struct End {
        Real value{}, slope{}, value_rise{}, slope_rise{};
    };

    /// Cubic Hermite basis at a fraction of the cell. Beyond the cell the basis of its end continues as a straight
    /// line.
    template <class Real>
    struct Basis {
        TALUS_DEVICE explicit Basis(Real fraction) {
            const Real t = larger(Real(0), smaller(Real(1), fraction)), t2 = t * t, t3 = t2 * t;
            beyond = fraction - t;
            const Real value = 3 * t2 - 2 * t3, rise = 6 * (t - t2);
            first = {1 - value, t - 2 * t2 + t3, -rise, 1 - 4 * t + 3 * t2};
            last = {value, t3 - t2, rise, 3 * t2 - 2 * t};
        }
        End<Real> first, last;
        Real beyond{};
    };

    /// NaN if a corner of the cell has no data.
    TALUS_DEVICE float corner_marks(std::size_t i) const {
        return nodes[i][3] + nodes[i + 1][3] + nodes[i + stride][3] + nodes[i + stride + 1][3];
    }
};

}  // namespace talus::terrain
