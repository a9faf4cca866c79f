#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/number.hpp"

namespace talus::terrain {

/// Resistance of a cell's ground where it differs; NaN: as elsewhere.
struct CoverCell {
    float friction_coefficient, inverse_turbulent_friction, cohesion;  ///< 1, s2/m, Pa
    float stem_drag;                                                   ///< deceleration over v^2, 1/m; 0: no stems
};

/// Zones of the ground on the cells of the terrain: the values at a place need one look-up. Empty: no zones.
class GroundCover {
  public:
    GroundCover() = default;
    /// The cells of the run's terrain, in its local frame.
    explicit GroundCover(const Grid<CoverCell>& cells);

    [[nodiscard]] bool empty() const { return cells_.empty(); }
    /// Whether any of it causes speed-dependent drag.
    [[nodiscard]] bool drags() const { return drags_; }

    /// The CoverCell at a local plan position: its members in their order. Outside the terrain that of the nearest
    /// cell.
    template <class Real>
    [[nodiscard]] TALUS_INLINE auto at(Real x, Real y) const {
        const Real u = (x - Real(x_west_)) * Real(inverse_cell_), v = (y - Real(y_south_)) * Real(inverse_cell_);
        const auto column = truncated(larger(Real(0), smaller(Real(last_column_), u)));
        const auto row = truncated(larger(Real(0), smaller(Real(last_row_), v)));
        return quads_at(cells_.data(), decltype(column)(row * (last_column_ + 1) + column));
    }

  private:
    std::vector<Quad> cells_;
    int last_column_ = 0, last_row_ = 0;
    float x_west_ = 0, y_south_ = 0, inverse_cell_ = 0;
    bool drags_ = false;
};

}  // namespace talus::terrain
