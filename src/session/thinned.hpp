#pragma once

#include <memory>
#include <string>

#include "core/grid.hpp"

namespace talus::session {

/// Cells of a terrain that a page may ask for.
inline constexpr double fewest_terrain_cells = 100, most_terrain_cells = 16e6, usual_terrain_cells = 1e6;

/// The whole factor by which columns and rows are thinned so that at most `max_cells` remain.
[[nodiscard]] int thinning(const GridGeometry& grid, double max_cells);

/// The middle one of every `factor` x `factor` cells.
[[nodiscard]] Grid<float> thinned_by(const Grid<float>& whole, int factor);

/// The same as a grid message for a page.
[[nodiscard]] std::shared_ptr<const std::string> terrain_message(const Grid<float>& elevation, int factor);

}  // namespace talus::session
