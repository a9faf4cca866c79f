#include "sim/model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/physics/viscosity.hpp"

namespace talus::sim {

void set_material(Model& model, const params::MaterialSpec& material) {
    model.rest_density = material.rest_density;
    model.friction_coefficient = material.friction_coefficient;
    model.building_friction_coefficient =
        material.building_friction_coefficient.value_or(material.friction_coefficient);
    model.internal_friction_coefficient = params::internal_friction_of(material);
    model.viscosity = material.kinematic_viscosity
                          ? smoothing_viscosity(*material.kinematic_viscosity, model.kernel.second_moment)
                          : material.viscosity;
    model.kinematic_viscosity = kinematic_viscosity(model.viscosity, model.kernel.second_moment);
    model.viscosity_on_ground = material.viscosity_on_ground;
    model.cohesion = material.cohesion;
    model.pore_pressure_ratio = material.pore_pressure_ratio;
    model.pore_pressure_decay_time = material.pore_pressure_decay_time.value_or(0);
    model.evolving_pressure = evolving_pressure_of(material);
    model.inertial_friction = {};
    if (material.inertial_friction_coefficient) {
        model.inertial_friction = {
            true, std::max(0.0, *material.inertial_friction_coefficient - model.internal_friction_coefficient),
            material.inertial_number,
            material.grain_diameter * std::sqrt(material.grain_density / material.rest_density)};
    }
    model.laws = ground_laws_of(material);
}

Model make_model(const params::MaterialSpec& material, const params::SolverSpec& solver, double particle_spacing,
                 terrain::GroundCover cover) {
    Model model;
    model.particle_spacing = particle_spacing;
    model.support_radius = solver.support_ratio * particle_spacing;
    model.solver = solver;
    model.kernel = make_kernel(solver.kernel, particle_spacing, model.support_radius);
    model.boundary = BoundaryTable(model.kernel, particle_spacing);
    set_material(model, material);
    model.cover = std::move(cover);
    return model;
}

}  // namespace talus::sim
