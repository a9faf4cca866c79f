#include "depth/material.hpp"

namespace talus::depth {

Material material_of(const params::MaterialSpec& material) {
    Material result;
    result.rest_density = material.rest_density;
    result.friction_coefficient = material.friction_coefficient;
    result.cohesion = material.cohesion;
    result.laws = sim::ground_laws_of(material);
    if (material.viscosity_on_ground) result.laws.laminar_viscosity = material.kinematic_viscosity.value_or(0);
    result.pore_pressure_ratio = material.pore_pressure_ratio;
    result.soil = sim::evolving_pressure_of(material);
    result.pore_pressure_decay_time = material.pore_pressure_decay_time.value_or(0);
    return result;
}

}  // namespace talus::depth
