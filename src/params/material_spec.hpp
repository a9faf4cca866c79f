#pragma once

#include <optional>
#include <string>

/// Debris, and ground that differs, as spec.hpp has the rest of a scene file.
namespace talus::params {

/// Where pore pressure comes from: numbers of the scene, or the state of the soil (docs/pore-pressure.md).
enum class PorePressure { prescribed, dilatancy };

/// `[material]`
struct MaterialSpec {
    double rest_density = 2000;                           ///< kg/m3
    double friction_coefficient = 0.4;                    ///< on ground, and on buildings and inside unless set
                                                          ///< separately
    std::optional<double> building_friction_coefficient;  ///< absent: equal to friction_coefficient
    std::optional<double> internal_friction_coefficient;  ///< absent: see internal_friction_of()
    double viscosity = 0.1;                               ///< XSPH smoothing per 1/60 s, 0 to below 1
    std::optional<double> kinematic_viscosity;            ///< m2/s, in place of `viscosity`
    bool viscosity_on_ground = false;                     ///< viscosity also acts between debris and ground
    std::optional<double> turbulent_friction;             ///< xi, m/s2; absent: none
    std::optional<double> turbulent_friction_thickness;   ///< m, of flow with that xi; absent: the same at any
                                                          ///< thickness
    std::optional<double> laminar_viscosity;              ///< kinematic, m2/s, of laminar drag; absent: none
    std::optional<double> laminar_dynamic_viscosity;      ///< Pa s, in place of `laminar_viscosity`
    double cohesion = 0;                                  ///< Pa, shear strength without pressure
    double pore_pressure_ratio = 0;                       ///< r_u, at the start of the debris
    std::optional<double> pore_pressure_decay_time;       ///< s; absent: constant
    PorePressure pore_pressure = PorePressure::prescribed;
    std::optional<double> permeability;                   ///< m2, at `solid_fraction`
    std::optional<double> solid_fraction;                 ///< share of the volume that grains fill
    std::optional<double> critical_solid_fraction;        ///< at which slow shear does not change the volume
    double pore_fluid_viscosity = 0.005;                  ///< Pa s
    double pore_fluid_density = 1100;                     ///< kg/m3
    double compressibility = 0.015;                       ///< of the grains' skeleton
    std::optional<double> inertial_friction_coefficient;  ///< internal, of fast shear; absent: independent of the rate
    double inertial_number = 0.279;  ///< I_0, at which friction is halfway between its slow and fast values
    double grain_diameter = 0.01;    ///< m
    double grain_density = 2650;     ///< kg/m3
    bool samosat = false;            ///< friction of samosAT on the ground; the next four are its constants
    double samosat_fluidization = 0.222;
    double samosat_karman = 0.43;
    double samosat_roughness = 0.05;  ///< m
    double samosat_offset = 4.13;
};

/// Internal friction where a scene gives none is that on the ground at rest, or debris would shear above it.
[[nodiscard]] inline double internal_friction_of(const MaterialSpec& material) {
    const double at_rest = material.samosat && material.samosat_fluidization > 0 ? 2 : 1;
    return material.internal_friction_coefficient.value_or(at_rest * material.friction_coefficient);
}

/// Kinematic viscosity of laminar drag, m2/s; 0: none.
[[nodiscard]] inline double laminar_viscosity_of(const MaterialSpec& material) {
    return material.laminar_viscosity.value_or(material.laminar_dynamic_viscosity.value_or(0) / material.rest_density);
}

/// What the cells of a zone's raster hold.
enum class ZoneRaster {
    zone_number,  ///< the zone is where it has `raster_value`
    friction_coefficient,
    turbulent_friction,
};

/// `[[zone]]`: ground that differs; exactly one of file, polygon, raster. Later zones override earlier ones.
struct ZoneSpec {
    std::string name;
    std::string file, layer;
    std::string polygon;  ///< "x y, x y, x y" in the terrain's reference system
    std::string raster;
    ZoneRaster raster_holds = ZoneRaster::zone_number;
    std::optional<double> raster_value;
    std::optional<double> friction_coefficient, turbulent_friction, cohesion;  ///< absent: as elsewhere; 1, m/s2, Pa
    std::optional<double> laminar_viscosity;                                   ///< absent: as elsewhere; m2/s
    double stem_density = 0;                                                   ///< per m2; 0: no stems
    double stem_diameter = 0.3;                                                ///< m
    double stem_drag_coefficient = 1;
};

}  // namespace talus::params
