#pragma once

#include <algorithm>

#include "terrain/bed.hpp"

namespace talus::sim {

/// Bed that comes loose in a step by shear, m of vertical depth: at the material's erosion rate, down to a depth
/// proportional to what the shear stress exceeds the critical one by (Frank, McArdell, Huggel & Vieli 2015, "The
/// importance of entrainment and bulking on debris flow runout modeling"). `cosine`, `sine`: of the slope; `depth`: m,
/// vertical, of the debris; `eroded`: m, what has come loose before.
inline double eroded_by_shear(const terrain::BedMaterial& material, double rest_density, double gravity, double depth,
                              double cosine, double sine, double eroded, double time_step) {
    const double shear_stress = rest_density * gravity * depth * cosine * sine;
    const double deepest = material.depth_per_shear * (shear_stress - material.critical_shear_stress);
    return std::clamp(deepest - eroded, 0.0, material.erosion_rate * time_step);
}

}  // namespace talus::sim
