#include "terrain/map_cell.hpp"

#include <algorithm>
#include <cmath>

namespace talus::terrain {

double default_map_cell(double terrain_cell, double particle_spacing) {
    const double wanted = 2.5 * particle_spacing;
    if (wanted < terrain_cell) return terrain_cell / std::max(1.0, std::round(terrain_cell / wanted));
    return terrain_cell * std::max(1.0, std::round(wanted / terrain_cell));
}

}  // namespace talus::terrain
