#pragma once

#include <cmath>
#include <memory>
#include <type_traits>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/number.hpp"

namespace talus::terrain {

/// The ground below a plan position.
template <class Real>
struct GroundSample {
    Real height{};        ///< local z of the ground, m
    Vec3<Real> normal{};  ///< unit, upward
};

/// A height field: elevations at the centres of square cells, between them bicubic Hermite patches (without twist), in
/// a local float frame. Height and normal belong to one smooth surface: on facets debris would lose speed at every
/// kink, and with normals that do not match the heights it would gain or lose energy. Slopes at the centres are central
/// differences, limited as van Leer (1977) does, so that the ground does not overshoot beside a cliff.
///
/// Debris can be on it where `covers` is true: inside the hull of the cell centres and away from nodata. Elsewhere the
/// ground continues as a plane, so that a particle on its way out, which is removed at the end of the step, still lies
/// on ground and does not disturb its neighbours. Copies share the heights, which never change: copying a terrain is
/// cheap, however large it is. A height's cell index and fraction come from the same floor(): taken from two roundings,
/// a particle exactly on a cell edge would see the ground jump.
class Terrain {
  public:
    Terrain() = default;

    /// `elevation`: world elevations in m, NaN where there is no data; at least 2 x 2 cells.
    /// The frame's origin is the middle of the grid, at the lowest elevation.
    explicit Terrain(Grid<float> elevation);

    [[nodiscard]] const LocalFrame& frame() const { return frame_; }
    /// World elevations as given (NaN: no data).
    [[nodiscard]] const Grid<float>& elevation() const { return *elevation_; }
    [[nodiscard]] double cell() const { return elevation_->geometry.cell; }

    /// Whether the ground is known at a local plan position.
    template <class Real>
    [[nodiscard]] bool covers(Real x, Real y) const {
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
        const auto south = quad_pairs_at(nodes_.get(), c.index), north = quad_pairs_at(nodes_.get() + stride_, c.index);
        add_corner(along_x.first, along_y.first, south.low);
        add_corner(along_x.last, along_y.first, south.high);
        add_corner(along_x.first, along_y.last, north.low);
        add_corner(along_x.last, along_y.last, north.high);
        height += rise_x * along_x.beyond + rise_y * along_y.beyond;
        const Real slope_x = rise_x * Real(inverse_cell_), slope_y = rise_y * Real(inverse_cell_);
        const Real inverse_length = Real(1) / sqrt(Real(1) + slope_x * slope_x + slope_y * slope_y);
        return {height, {-slope_x * inverse_length, -slope_y * inverse_length, inverse_length}};
    }

    /// World elevation at a world plan position; NaN where not covered.
    [[nodiscard]] double elevation_at(const PlanPoint& p) const;

    /// Unit normal's z component (cosine of the slope) at a world plan position; NaN where not covered.
    [[nodiscard]] double slope_cosine_at(const PlanPoint& p) const;

    /// Index of the cell that a local plan position lies in, which must be covered.
    [[nodiscard]] std::size_t cell_at(float x, float y) const;
    /// Cosine of the slope at the centre of a cell that has data.
    [[nodiscard]] double slope_cosine_of(std::size_t cell) const;
    /// Changes the world elevation of a cell, which has data; the surface changes up to two cells around. Copies of
    /// this terrain are not affected: shared data is copied first.
    void set_elevation(std::size_t cell, float elevation);

  private:
    template <class Index, class Real>
    struct Cell {
        Index index;
        Real fx, fy;  ///< from 0 to 1 inside the cell
    };

    template <class Real>
    auto locate(Real x, Real y) const {
        const Real u = (x - Real(x_first_)) * Real(inverse_cell_), v = (y - Real(y_first_)) * Real(inverse_cell_);
        // This order of comparisons also maps NaN to a valid cell instead of an undefined conversion.
        const auto column = truncated(larger(Real(0), smaller(Real(last_column_ - 1), u)));
        const auto row = truncated(larger(Real(0), smaller(Real(last_row_ - 1), v)));
        using Index = std::remove_const_t<decltype(column)>;
        return Cell<Index, Real>{Index(row * stride_ + column), u - from_index<Real>(column),
                                 v - from_index<Real>(row)};
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
        explicit Basis(Real fraction) {
            const Real t = larger(Real(0), smaller(Real(1), fraction)), t2 = t * t, t3 = t2 * t;
            beyond = fraction - t;
            const Real value = 3 * t2 - 2 * t3, rise = 6 * (t - t2);
            first = {1 - value, t - 2 * t2 + t3, -rise, 1 - 4 * t + 3 * t2};
            last = {value, t3 - t2, rise, 3 * t2 - 2 * t};
        }
        End<Real> first, last;
        Real beyond{};
    };

    [[nodiscard]] Quad make_node(int column, int row) const;
    void continue_into_nodata();

    /// NaN if a corner of the cell has no data.
    float corner_marks(std::size_t i) const {
        return nodes_[i][3] + nodes_[i + 1][3] + nodes_[i + stride_][3] + nodes_[i + stride_ + 1][3];
    }

    std::shared_ptr<Grid<float>> elevation_ = std::make_shared<Grid<float>>();
    LocalFrame frame_;
    /// A cell centre: local z and its rise over one cell eastwards and northwards, m; NaN where there is no data,
    /// otherwise 0. In fours, which are loaded together.
    std::shared_ptr<Quad[]> nodes_;
    int stride_ = 0;
    int last_column_ = 0, last_row_ = 0;
    float x_first_ = 0, y_first_ = 0;  // local position of the south-west cell's centre
    float inverse_cell_ = 0;
};

}  // namespace talus::terrain
