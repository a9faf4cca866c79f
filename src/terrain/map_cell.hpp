#pragma once

namespace talus::terrain {

/// The default map cell, m: a whole fraction or multiple of the terrain's cell, near 2.5 particle spacings.
[[nodiscard]] double default_map_cell(double terrain_cell, double particle_spacing);

}  // namespace talus::terrain
