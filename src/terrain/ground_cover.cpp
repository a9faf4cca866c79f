#include "terrain/ground_cover.hpp"

#include <algorithm>
#include <cmath>

namespace talus::terrain {

GroundCover::GroundCover(const Grid<CoverCell>& cells)
    : last_column_(cells.geometry.columns - 1),
      last_row_(cells.geometry.rows - 1),
      x_west_(static_cast<float>(-0.5 * cells.geometry.columns * cells.geometry.cell)),
      y_south_(static_cast<float>(-0.5 * cells.geometry.rows * cells.geometry.cell)),
      inverse_cell_(static_cast<float>(1 / cells.geometry.cell)),
      drags_(std::any_of(cells.values.begin(), cells.values.end(), [](const CoverCell& c) {
          return c.inverse_turbulent_friction > 0 || c.stem_drag > 0 || c.laminar_viscosity > 0;
      })) {
    const bool viscous = std::any_of(cells.values.begin(), cells.values.end(),
                                     [](const CoverCell& c) { return !std::isnan(c.laminar_viscosity); });
    viscosities_ = viscous ? static_cast<int>(cells.values.size()) : 0;
    cells_.reserve(cells.values.size() * (viscous ? 2 : 1));
    for (const CoverCell& c : cells.values) {
        cells_.push_back({c.friction_coefficient, c.inverse_turbulent_friction, c.cohesion, c.stem_drag});
    }
    for (int k = 0; k < viscosities_; ++k) {
        cells_.push_back({cells.values[static_cast<std::size_t>(k)].laminar_viscosity});
    }
}

}  // namespace talus::terrain
