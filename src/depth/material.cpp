#include "depth/material.hpp"

namespace talus::depth {

Material material_of(const params::MaterialSpec& material) {
    Material result;
    result.rest_density = material.rest_density;
    result.friction_coefficient = material.friction_coefficient;
    result.turbulent_friction = material.turbulent_friction.value_or(0);
    result.turbulent_thickness = material.turbulent_friction_thickness.value_or(0);
    result.cohesion = material.cohesion;
    result.viscosity = material.viscosity_on_ground ? material.kinematic_viscosity.value_or(0)
                                                    : params::laminar_viscosity_of(material);
    result.samosat = sim::samosat_of(material);
    result.pore_pressure_ratio = material.pore_pressure_ratio;
    result.soil = sim::evolving_pressure_of(material);
    result.pore_pressure_decay_time = material.pore_pressure_decay_time.value_or(0);
    return result;
}

}  // namespace talus::depth
