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

/// A height field of square cells, bilinear between cell centres, in a local float frame. Normals are those of central
/// differences, interpolated likewise: they turn gradually, where the facets' own normals jump from cell to cell, and
/// with them a particle's distance to the ground, which the solver would answer with a kick.
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
        const Real slope_x = interpolate(slope_x_, c), slope_y = interpolate(slope_y_, c);
        const Real inverse_length = Real(1) / std::sqrt(Real(1) + slope_x * slope_x + slope_y * slope_y);
        return {interpolate(height_, c), {-slope_x * inverse_length, -slope_y * inverse_length, inverse_length}};
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

    template <class Real>
    Real interpolate(const std::vector<float>& nodes, const Cell<Real>& c) const {
        const Real v00 = nodes[c.index], v10 = nodes[c.index + 1];
        const Real v01 = nodes[c.index + stride_], v11 = nodes[c.index + stride_ + 1];
        const Real south = v00 + (v10 - v00) * c.fx, north = v01 + (v11 - v01) * c.fx;
        return south + (north - south) * c.fy;
    }

    float corner_sum(std::size_t i) const {
        return height_[i] + height_[i + 1] + height_[i + stride_] + height_[i + stride_ + 1];
    }

    Grid<float> elevation_;
    LocalFrame frame_;
    std::vector<float> height_;             // local z per cell centre, NaN: no data
    std::vector<float> slope_x_, slope_y_;  // central differences per cell centre
    std::size_t stride_ = 0;
    int last_column_ = 0, last_row_ = 0;
    float x_first_ = 0, y_first_ = 0;  // local position of the south-west cell's centre
    float inverse_cell_ = 0;
};

}  // namespace talus
