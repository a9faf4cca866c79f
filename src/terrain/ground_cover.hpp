#pragma once

#include <limits>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/number.hpp"

namespace talus::terrain {

/// Resistance of a cell's ground where it differs; NaN: as elsewhere.
struct CoverCell {
    float friction_coefficient = 0, inverse_turbulent_friction = 0, cohesion = 0;  ///< 1, s2/m, Pa
    float stem_drag = 0;                                                ///< deceleration over v^2, 1/m; 0: no stems
    float laminar_viscosity = std::numeric_limits<float>::quiet_NaN();  ///< m2/s
};

/// The zones of a GroundCover by pointers: see there. It owns nothing.
struct CoverField {
    const Quad* cells = nullptr;  ///< the first four members of each CoverCell
    int viscosities = 0;          ///< after so many cells as many with the fifth; 0: as elsewhere in all
    int last_column = 0, last_row = 0;
    float x_west = 0, y_south = 0, inverse_cell = 0;  ///< local m, 1/m

    [[nodiscard]] TALUS_DEVICE bool empty() const { return cells == nullptr; }
    [[nodiscard]] TALUS_DEVICE bool has_viscosities() const { return viscosities > 0; }
    /// See GroundCover::at().
    template <class Real>
    [[nodiscard]] TALUS_INLINE auto at(Real x, Real y) const {
        return quads_at(cells, index(x, y));
    }
    /// See GroundCover::viscosity_at().
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real viscosity_at(Real x, Real y) const {
        return quads_at(cells + viscosities, index(x, y)).x;
    }

  private:
    template <class Real>
    [[nodiscard]] TALUS_INLINE auto index(Real x, Real y) const {
        const Real u = (x - Real(x_west)) * Real(inverse_cell), v = (y - Real(y_south)) * Real(inverse_cell);
        const auto column = truncated(larger(Real(0), smaller(Real(last_column), u)));
        const auto row = truncated(larger(Real(0), smaller(Real(last_row), v)));
        return decltype(column)(row * (last_column + 1) + column);
    }
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

    /// Whether any of it has its own laminar viscosity.
    [[nodiscard]] bool has_viscosities() const { return viscosities_ > 0; }

    /// The first four members of the CoverCell at a local plan position in their order. Outside the terrain those of
    /// the nearest cell.
    template <class Real>
    [[nodiscard]] TALUS_INLINE auto at(Real x, Real y) const {
        return field().at(x, y);
    }
    /// Its laminar viscosity; only where has_viscosities().
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real viscosity_at(Real x, Real y) const {
        return field().viscosity_at(x, y);
    }
    /// For whoever computes elsewhere: valid as long as this, and until it changes.
    [[nodiscard]] TALUS_INLINE CoverField field() const {
        return {cells_.empty() ? nullptr : cells_.data(),
                viscosities_,
                last_column_,
                last_row_,
                x_west_,
                y_south_,
                inverse_cell_};
    }
    [[nodiscard]] const std::vector<Quad>& cells() const { return cells_; }

  private:
    std::vector<Quad> cells_;
    int viscosities_ = 0, last_column_ = 0, last_row_ = 0;
    float x_west_ = 0, y_south_ = 0, inverse_cell_ = 0;
    bool drags_ = false;
};

}  // namespace talus::terrain
