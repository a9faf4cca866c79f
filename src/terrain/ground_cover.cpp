#include "terrain/ground_cover.hpp"

#include <algorithm>

namespace talus::terrain {

GroundCover::GroundCover(const Grid<CoverCell>& cells)
    : last_column_(cells.geometry.columns - 1),
      last_row_(cells.geometry.rows - 1),
      x_west_(static_cast<float>(-0.5 * cells.geometry.columns * cells.geometry.cell)),
      y_south_(static_cast<float>(-0.5 * cells.geometry.rows * cells.geometry.cell)),
      inverse_cell_(static_cast<float>(1 / cells.geometry.cell)),
      drags_(std::any_of(cells.values.begin(), cells.values.end(),
                         [](const CoverCell& c) { return c.inverse_turbulent_friction > 0 || c.stem_drag > 0; })) {
    cells_.reserve(cells.values.size());
    for (const CoverCell& c : cells.values) {
        cells_.push_back({c.friction_coefficient, c.inverse_turbulent_friction, c.cohesion, c.stem_drag});
    }
}

}  // namespace talus::terrain
