#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "params/spec.hpp"
#include "params/time_step.hpp"
#include "sim/physics/boundary_table.hpp"
#include "sim/physics/ground_laws.hpp"
#include "sim/physics/kernel.hpp"
#include "sim/physics/pore_pressure.hpp"
#include "terrain/ground_cover.hpp"

namespace talus::sim {

/// When a release starts and its particles: ids [first_particle, last_particle).
struct ReleaseGroup {
    std::string name;
    double start_time = 0;  ///< s
    std::uint32_t first_particle = 0, last_particle = 0;
    std::optional<double> pore_pressure_ratio = {};  ///< r_u at its start; absent: that of the material
    std::optional<double> solid_fraction = {};       ///< at its start; absent: that of the material
    std::vector<params::PressureSample> water = {};  ///< by time, see rising_water.hpp; empty: none rises
};

/// Internal friction that grows with the shear rate, the mu(I) law.
struct InertialFriction {
    bool on = false;
    double rise = 0;        ///< mu_2 - mu_s
    double half = 0;        ///< I_0
    double grain_size = 0;  ///< m, diameter x sqrt(grain density / bulk density)
};

/// The numbers of a Model, without its tables: what the laws need of it on a graphics card too.
struct ModelValues {
    double particle_spacing = 0;               ///< m
    double support_radius = 0;                 ///< m
    double rest_density = 0;                   ///< kg/m3
    double friction_coefficient = 0;           ///< on the ground
    double building_friction_coefficient = 0;  ///< on walls and roofs
    double internal_friction_coefficient = 0;
    double viscosity = 0;            ///< XSPH smoothing per 1/60 s
    double kinematic_viscosity = 0;  ///< m2/s, the equivalent at this support radius
    bool viscosity_on_ground = false;
    double cohesion = 0;                  ///< Pa, on the ground and inside
    double pore_pressure_ratio = 0;       ///< r_u, at the start of a release
    double pore_pressure_decay_time = 0;  ///< s; 0: constant
    EvolvingPressure evolving_pressure;   ///< of the pore fluid
    InertialFriction inertial_friction;   ///< inside
    GroundLaws laws;
    double gravity = 9.80665;  ///< m/s2

    Kernel kernel;  ///< density and gradient, with the calibrated particle volume folded in

    /// The distance, m, at which a particle touches ground and walls: half its own size.
    [[nodiscard]] TALUS_DEVICE double contact_distance() const { return particle_spacing / 2; }
    [[nodiscard]] TALUS_DEVICE double particle_volume() const {
        return particle_spacing * particle_spacing * particle_spacing;
    }
    /// kg, of a particle at rest density; see density_of().
    [[nodiscard]] TALUS_DEVICE double particle_mass() const { return rest_density * particle_volume(); }
};

/// Parameters and tables that no step changes; only Simulation::change() may change them, between two steps. Besides
/// its State, a run changes its Ground.
struct Model : ModelValues {
    std::vector<ReleaseGroup> releases;
    terrain::GroundCover cover;  ///< where the ground has its own resistance
    params::SolverSpec solver;
    BoundaryTable boundary;  ///< density share of a half-space of ground

    /// s, upper bound of the adaptive step.
    [[nodiscard]] double largest_time_step() const { return params::largest_time_step(solver, particle_spacing); }
};

/// All constants of a run, from the scene's material and solver sections.
[[nodiscard]] Model make_model(const params::MaterialSpec& material, const params::SolverSpec& solver,
                               double particle_spacing, terrain::GroundCover cover = {});

/// Sets the model's values from the scene's material section. The model must have its kernel.
void set_material(Model& model, const params::MaterialSpec& material);

}  // namespace talus::sim
