#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "params/spec.hpp"

namespace talus::terrain {

/// A kind of loose material on the ground.
struct BedMaterial {
    std::string name;
    params::EntrainmentLaw law = params::EntrainmentLaw::growth;
    double growth_rate = 0;            ///< 1/m
    double critical_shear_stress = 0;  ///< Pa
    double erosion_rate = 0;           ///< m/s, vertical
    double depth_per_shear = 0;        ///< m/Pa
};

/// Material that debris can entrain: the upper part of the terrain, a value per cell of its grid.
struct Bed {
    std::vector<BedMaterial> materials;
    std::vector<std::uint8_t> material_at;  ///< 1 + index into `materials`; 0: none
    std::vector<float> depth;               ///< m, vertical, before any erosion
    std::vector<float> eroded;              ///< m, eroded so far

    [[nodiscard]] bool empty() const { return materials.empty(); }
    /// Maximum number of materials.
    static constexpr std::size_t max_materials = 255;
};

}  // namespace talus::terrain
