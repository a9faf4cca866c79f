#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "params/declaration.hpp"

namespace talus::params {
namespace {

/// Pore pressure that follows from the soil (Iverson & George 2014).
void declare_evolving_pore_pressure(Declaration<MaterialSpec>& s) {
    s.choice(
         "pore_pressure", &MaterialSpec::pore_pressure, {"prescribed", "dilatancy"},
         "Where pore pressure comes from: prescribed by pore_pressure_ratio, or computed from how the soil dilates, "
         "contracts and drains (Iverson & George 2014). Then pore_pressure_ratio is where it starts; 0: hydrostatic.")
        .needs(stress());
    s.optional_key("permeability_m2", "m2", &MaterialSpec::permeability, between(1e-13, 1e-8),
                   "pore_pressure = \"dilatancy\" needs it",
                   "Permeability of the debris at solid_fraction; it falls to 1/e where grains fill 0.04 more.");
    s.optional_key("solid_fraction", "", &MaterialSpec::solid_fraction, between(0.4, 0.75),
                   "pore_pressure = \"dilatancy\" needs it",
                   "Share of the volume that grains fill when debris starts; releases and inflows may have their own.");
    s.optional_key("critical_solid_fraction", "", &MaterialSpec::critical_solid_fraction, between(0.5, 0.7),
                   "pore_pressure = \"dilatancy\" needs it",
                   "Solid fraction at which slow shear neither dilates nor contracts; looser debris liquefies.");
    s.key("pore_fluid_viscosity_Pas", "Pa s", &MaterialSpec::pore_fluid_viscosity, between(0.001, 0.1),
          "Viscosity of the muddy water in the pores, with pore_pressure = \"dilatancy\".");
    s.key("pore_fluid_density_kgpm3", "kg/m3", &MaterialSpec::pore_fluid_density, between(1000, 1300),
          "Density of the muddy water in the pores, with pore_pressure = \"dilatancy\".");
    s.key("compressibility", "", &MaterialSpec::compressibility, between(0.003, 0.3),
          "a of the skeleton of grains, with pore_pressure = \"dilatancy\": its compressibility is a / (solid fraction "
          "x (effective stress + 1000 Pa)).");
}

/// What a scene with evolving pore pressure lacks, or says twice.
std::optional<Violation> contradicts_evolving_pore_pressure(const MaterialSpec& m) {
    const std::array needed = {std::tuple{m.permeability, "permeability_m2", "1e-13 to 1e-8 m2"},
                               std::tuple{m.solid_fraction, "solid_fraction", "0.4 to 0.75"},
                               std::tuple{m.critical_solid_fraction, "critical_solid_fraction", "0.5 to 0.7"}};
    if (m.pore_pressure == PorePressure::prescribed) {
        for (const auto& [value, key, range] : needed) {
            if (!value) continue;
            return Violation{key, fmt::format(" = {} has no effect while pore_pressure = \"prescribed\"; set "
                                              "pore_pressure = \"dilatancy\" or leave it out",
                                              *value)};
        }
        return {};
    }
    for (const auto& [value, key, range] : needed) {
        if (value) continue;
        return Violation{key, fmt::format(": missing; pore_pressure = \"dilatancy\" needs it, {}", range)};
    }
    if (m.pore_pressure_decay_time) {
        return Violation{
            "pore_pressure_decay_time_s",
            ": is given beside pore_pressure = \"dilatancy\", which computes how the pressure falls; leave "
            "one of them out"};
    }
    const double bulk = m.grain_density * *m.solid_fraction + m.pore_fluid_density * (1 - *m.solid_fraction);
    if (std::abs(bulk - m.rest_density) <= 0.05 * m.rest_density) return {};
    return Violation{
        "rest_density_kgpm3",
        fmt::format(" = {} is refused beside pore_pressure = \"dilatancy\"; with solid_fraction = {}, "
                    "grain_density_kgpm3 = {} and pore_fluid_density_kgpm3 = {} it must be within 5 % of {:.0f}",
                    m.rest_density, *m.solid_fraction, m.grain_density, m.pore_fluid_density, bulk)};
}

/// Resistance other than Coulomb friction and viscosity.
void declare_resistance(Declaration<MaterialSpec>& s) {
    s.key("viscosity_on_ground", "", &MaterialSpec::viscosity_on_ground, anything(),
          "Whether viscosity acts between debris and ground as well, which a viscous fluid sticks to.");
    s.optional_key("turbulent_friction_mps2", "m/s2", &MaterialSpec::turbulent_friction, between(1, 1e6), "none",
                   "Voellmy's xi: flow of thickness h is slowed by g v2 / (xi h) in addition to Coulomb friction.")
        .assumes("Turbulent friction, Voellmy's ξ")
        .live_as()
        .also_called({"xi", "xsi", "xsi_voellmy", "turbulence_coefficient", "turbulent_coefficient"});
    s.optional_key(
        "turbulent_friction_thickness_m", "m", &MaterialSpec::turbulent_friction_thickness, between(0.001, 1000),
        "xi is the same at every thickness",
        "Thickness of the flow at which xi, here and in zones, is as given. It then grows with the cube root "
        "of the thickness: Manning's law, with n = thickness^(1/6) / sqrt(xi).");
    s.optional_key(
         "laminar_viscosity_m2ps", "m2/s", &MaterialSpec::laminar_viscosity, between(0, 1e6), "none",
         "Laminar drag: flow of thickness h is slowed by 3 nu v / h2 over its whole depth, beside Coulomb and "
         "turbulent friction. nu is the kinematic viscosity, dynamic viscosity over density: the viscous term "
         "of FLO-2D and HEC-RAS with K = 24.")
        .assumes("Laminar drag, kinematic viscosity")
        .live_as()
        .also_called({"nu"});
    s.optional_key("laminar_viscosity_Pas", "Pa s", &MaterialSpec::laminar_dynamic_viscosity, between(0, 1e9),
                   "laminar_viscosity_m2ps", "The same as dynamic viscosity, in place of laminar_viscosity_m2ps.")
        .also_called({"eta", "dynamic_viscosity"});
    s.key("cohesion_Pa", "Pa", &MaterialSpec::cohesion, between(0, 1e7),
          "Shear strength at zero normal stress, on the ground and inside: the yield stress of a mud without friction.")
        .assumes("Cohesion")
        .live_as()
        .needs(stress())
        .also_called({"tau0", "tau0_samosat", "tau_y", "yield_stress", "shear_strength"});
    s.key(
         "pore_pressure_ratio", "", &MaterialSpec::pore_pressure_ratio, between(0, 1),
         "r_u, pore pressure over the total normal stress when debris starts: friction on ground, buildings and inside "
         "is 1 - r_u of what it is in dry debris.")
        .assumes("Pore-pressure ratio")
        .live_as()
        .needs(stress())
        .also_called({"r_u"});
    s.optional_key("pore_pressure_decay_time_s", "s", &MaterialSpec::pore_pressure_decay_time, between(0.001, 1e9),
                   "pore pressure stays",
                   "Time in which the pore-pressure ratio falls to 1/e, from when debris starts to move, comes in or "
                   "is entrained.");
    declare_evolving_pore_pressure(s);
    s.key("rest_density_kgpm3", "kg/m3", &MaterialSpec::rest_density, between(1, 30000), "Bulk density of the debris.")
        .assumes("Bulk density")
        .live_as()
        .also_called({"rho", "density", "bulk_density"});
    s.optional_key("inertial_friction_coefficient", "", &MaterialSpec::inertial_friction_coefficient, between(0, 10),
                   "friction does not depend on the shear rate",
                   "Limiting friction at high shear rate (mu_2 of the mu(I) law); at low shear rate it is "
                   "internal_friction_coefficient.")
        .needs(stress(true))
        .for_particles_only();
    s.key("inertial_number", "", &MaterialSpec::inertial_number, between(1e-6, 1000),
          "Inertial number I_0 at which internal friction lies half way to inertial_friction_coefficient.")
        .for_particles_only();
    s.key("grain_diameter_m", "m", &MaterialSpec::grain_diameter, between(1e-6, 100),
          "Grain diameter in the inertial number.")
        .for_particles_only();
    s.key("grain_density_kgpm3", "kg/m3", &MaterialSpec::grain_density, between(1, 30000),
          "Density of the grains in the inertial number.");
}

/// Friction of samosAT, with the constants that AvaFrame has (com1DFACfg.ini).
void declare_samosat(Declaration<MaterialSpec>& s) {
    s.key("samosat", "", &MaterialSpec::samosat, anything(),
          "Friction of samosAT on the ground, the law of AvaFrame (com1DFA) for snow: friction_coefficient times 1 + "
          "Rs0 / (Rs0 + rho v2 / normal stress), which is twice as much at rest, and drag v2 / (h (ln(h / R) / kappa + "
          "B)2) of flow of thickness h.");
    s.key("samosat_fluidization", "", &MaterialSpec::samosat_fluidization, between(0, 1000),
          "Rs0 of samosAT: rho v2 over the normal stress, at which friction is 1.5 friction_coefficient; 0: it is "
          "friction_coefficient at every speed.")
        .also_called({"rs0", "rs0_samosat"});
    s.key("samosat_karman", "", &MaterialSpec::samosat_karman, between(0.01, 10), "kappa of samosAT.")
        .also_called({"kappa", "kappa_samosat"});
    s.key("samosat_roughness_m", "m", &MaterialSpec::samosat_roughness, between(0.0001, 100),
          "R of samosAT, the roughness of the ground; drag of thinner flow is that of flow as thick.")
        .also_called({"r_samosat"});
    s.key("samosat_offset", "", &MaterialSpec::samosat_offset, between(0.1, 100), "B of samosAT.")
        .also_called({"b_samosat"});
}

/// Of two laws for the same drag: the key of the other one, if it is given.
std::optional<Violation> beside_samosat(bool given, const char* key) {
    if (!given) return {};
    return Violation{key,
                     ": is given beside material.samosat = true, which has a drag of its own; leave one of them out"};
}

std::optional<Violation> contradicts_samosat(const MaterialSpec& material) {
    if (!material.samosat) {
        const MaterialSpec published;
        for (const auto& [constant, key] : {std::pair{&MaterialSpec::samosat_fluidization, "samosat_fluidization"},
                                            {&MaterialSpec::samosat_karman, "samosat_karman"},
                                            {&MaterialSpec::samosat_roughness, "samosat_roughness_m"},
                                            {&MaterialSpec::samosat_offset, "samosat_offset"}}) {
            if (material.*constant == published.*constant) continue;
            return Violation{
                key, fmt::format(" = {} has no effect while samosat = false; set samosat = true or leave it out",
                                 material.*constant)};
        }
        return {};
    }
    const double viscosity = material.laminar_viscosity.value_or(0);
    const double dynamic_viscosity = material.laminar_dynamic_viscosity.value_or(0);
    for (const auto& [given, key] : {std::pair{material.turbulent_friction.has_value(), "turbulent_friction_mps2"},
                                     {viscosity > 0, "laminar_viscosity_m2ps"},
                                     {dynamic_viscosity > 0, "laminar_viscosity_Pas"},
                                     {material.viscosity_on_ground, "viscosity_on_ground"}}) {
        if (auto both = beside_samosat(given, key)) return both;
    }
    return {};
}

}  // namespace

Section declare_material() {
    Declaration<MaterialSpec> s("material", "Debris properties.", &SceneSpec::material);
    s.key("friction_coefficient", "", &MaterialSpec::friction_coefficient, between(0, 10),
          "Coulomb friction on the ground (tangent of the friction angle), and on buildings and inside unless set "
          "apart.")
        .assumes("Coulomb friction on the ground")
        .live_as()
        .also_called({"mu", "friction", "tan_phi", "basal_friction", "mu_coulomb", "mu_voellmy", "mu_samosat"});
    s.optional_key("building_friction_coefficient", "", &MaterialSpec::building_friction_coefficient, between(0, 10),
                   "equal to friction_coefficient", "Coulomb friction on the walls and roofs of buildings.")
        .assumes("Coulomb friction on walls and roofs")
        .live_as()
        .for_particles_only();
    s.optional_key("internal_friction_coefficient", "", &MaterialSpec::internal_friction_coefficient, between(0, 10),
                   "equal to friction_coefficient, with samosat twice that", "Coulomb friction of debris on debris.")
        .assumes("Internal friction")
        .live_as()
        .also_called({"internal_friction", "tan_phi_internal"})
        .for_particles_only();
    s.key("viscosity", "", &MaterialSpec::viscosity, from_to_below(0, 1),
          "Share of the velocity difference to its neighbours that debris loses per 1/60 s, at any time step. The "
          "same share is another material at another particle spacing; kinematic_viscosity_m2ps is not.")
        .assumes("Viscosity, as smoothing per 1/60 s")
        .live_as()
        .also_called({"mu", "artificial_viscosity"})
        .for_particles_only();
    s.optional_key("kinematic_viscosity_m2ps", "m2/s", &MaterialSpec::kinematic_viscosity, between(0, 1e6),
                   "what viscosity amounts to at this particle spacing",
                   "Viscosity of the debris, in place of viscosity.");
    declare_resistance(s);
    declare_samosat(s);
    s.rule([](const MaterialSpec& material, const SceneSpec&, double) -> std::optional<Violation> {
        const double slow = internal_friction_of(material);
        if (material.inertial_friction_coefficient.value_or(slow) >= slow) return {};
        return Violation{"inertial_friction_coefficient",
                         fmt::format(" = {} is refused; it must be at least the internal friction of slow shear, {}",
                                     *material.inertial_friction_coefficient, slow)};
    });
    s.rule([](const MaterialSpec& material, const SceneSpec&, double) -> std::optional<Violation> {
        if (!material.laminar_viscosity || !material.laminar_dynamic_viscosity) return {};
        return Violation{"laminar_viscosity_Pas", ": is given beside laminar_viscosity_m2ps; leave one of them out"};
    });
    s.rule([](const MaterialSpec& material, const SceneSpec&, double) -> std::optional<Violation> {
        if (!material.viscosity_on_ground || !(laminar_viscosity_of(material) > 0)) return {};
        return Violation{
            "viscosity_on_ground",
            " = true is refused beside laminar drag, which is the same viscosity over the whole depth; leave "
            "one of them out"};
    });
    s.rule([](const MaterialSpec& material, const SceneSpec&, double) { return contradicts_samosat(material); });
    s.rule([](const MaterialSpec& material, const SceneSpec&, double) {
        return contradicts_evolving_pore_pressure(material);
    });
    return s.take();
}

Section declare_zone() {
    Declaration<ZoneSpec> s(
        "zone",
        "Ground with its own resistance. A cell of the terrain belongs to it if its centre does. "
        "Values that a zone does not set are those of [material]; later zones override earlier ones.",
        &SceneSpec::zones);
    s.text("name", &ZoneSpec::name, "\"zone N\"", "Name in reports and messages.");
    s.path("file", &ZoneSpec::file, "one of the other two is given",
           "Polygons of the zone: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &ZoneSpec::layer, "the only layer", "Layer of the file.");
    s.text("polygon", &ZoneSpec::polygon, "one of the other two is given",
           "Corners of the zone in the terrain's reference system, \"x y, x y, x y\".");
    s.path("raster", &ZoneSpec::raster, "one of the other two is given",
           "Raster of the zone in the terrain's reference system, such as land cover.");
    s.choice(
        "raster_holds", &ZoneSpec::raster_holds, {"zone_number", "friction_coefficient", "turbulent_friction_mps2"},
        "What the raster's cells hold: a number by which the zone is told from others, or that coefficient itself.");
    s.optional_key("raster_value", "", &ZoneSpec::raster_value, anything(), "every cell that has data",
                   "The zone_number of the zone.");
    s.optional_key("friction_coefficient", "", &ZoneSpec::friction_coefficient, between(0, 10), "as in [material]",
                   "Coulomb friction on this ground.")
        .live_in({.label = "Coefficient",
                  .slider_low = 0.05,
                  .slider_high = 1.05,
                  .first = 0.4,
                  .tick = "Friction",
                  .tick_help = "A separate Coulomb friction; unticked: as in [material]"});
    s.optional_key("turbulent_friction_mps2", "m/s2", &ZoneSpec::turbulent_friction, between(1, 1e6),
                   "as in [material]", "Voellmy's xi on this ground; lower is rougher.")
        .live_in({.label = "Voellmy's \u03be",
                  .slider_low = 100,
                  .slider_high = 2100,
                  .first = 500,
                  .tick = "Turbulent friction",
                  .tick_help = "A separate Voellmy turbulent friction; unticked: as in [material]"});
    s.optional_key("laminar_viscosity_m2ps", "m2/s", &ZoneSpec::laminar_viscosity, between(0, 1e6), "as in [material]",
                   "Kinematic viscosity of laminar drag on this ground.")
        .live_in({.label = "Viscosity",
                  .slider_low = 0,
                  .slider_high = 0.2,
                  .first = 0.04,
                  .tick = "Laminar drag",
                  .tick_help = "A separate viscosity of laminar drag; unticked: as in [material]"});
    s.optional_key("cohesion_Pa", "Pa", &ZoneSpec::cohesion, between(0, 1e7), "as in [material]",
                   "Shear strength at zero normal stress between debris and this ground.")
        .live_in({.label = "Shear strength",
                  .slider_low = 0,
                  .slider_high = 10,
                  .first = 1,
                  .tick = "Cohesion",
                  .tick_help = "A separate cohesion; unticked: as in [material]"})
        .needs(stress(true));
    s.key("stem_density_pm2", "1/m2", &ZoneSpec::stem_density, between(0, 1000),
          "Stems of a forest per square metre that stand the flow; each drags on it as a cylinder.")
        .live_in({.label = "Stems",
                  .slider_low = 50,
                  .slider_high = 1550,
                  .first = 400,
                  .tick = "Forest",
                  .tick_help = "Stems that drag on the flow"});
    s.key("stem_diameter_m", "m", &ZoneSpec::stem_diameter, between(0.001, 100), "Diameter of a stem.")
        .live_in({.label = "Stem diameter", .slider_low = 0.05, .slider_high = 1.05, .first = 0.3});
    s.key("stem_drag_coefficient", "", &ZoneSpec::stem_drag_coefficient, between(0, 100),
          "Drag coefficient of a stem across the flow.")
        .live_in({.label = "Drag coefficient", .slider_low = 0, .slider_high = 3, .first = 1});
    s.exactly_one_of({"file", "polygon", "raster"});
    s.rule([](const ZoneSpec& zone, const SceneSpec&, double) -> std::optional<Violation> {
        if (!zone.raster_value || zone.raster_holds == ZoneRaster::zone_number) return {};
        return Violation{"raster_value",
                         ": is given, but raster_holds says that the cells hold a coefficient; leave one of them out"};
    });
    s.rule([](const ZoneSpec& zone, const SceneSpec& spec, double) -> std::optional<Violation> {
        if (!spec.material.viscosity_on_ground || !(zone.laminar_viscosity.value_or(0) > 0)) return {};
        return Violation{"laminar_viscosity_m2ps",
                         fmt::format(" = {} is refused beside material.viscosity_on_ground = true, which is the same "
                                     "viscosity; leave one of them out",
                                     *zone.laminar_viscosity)};
    });
    s.rule([](const ZoneSpec& zone, const SceneSpec& spec, double) -> std::optional<Violation> {
        if (!spec.material.samosat) return {};
        if (zone.raster_holds == ZoneRaster::turbulent_friction) {
            return Violation{"raster_holds",
                             " = \"turbulent_friction_mps2\" is refused beside material.samosat = true, which has a "
                             "drag of its own; leave one of them out"};
        }
        if (auto both = beside_samosat(zone.turbulent_friction.has_value(), "turbulent_friction_mps2")) return both;
        return beside_samosat(zone.laminar_viscosity.value_or(0) > 0, "laminar_viscosity_m2ps");
    });
    s.rule([](const ZoneSpec& zone, const SceneSpec&, double) -> std::optional<Violation> {
        if (zone.friction_coefficient || zone.turbulent_friction || zone.laminar_viscosity || zone.cohesion ||
            zone.stem_density > 0 || zone.raster_holds != ZoneRaster::zone_number) {
            return {};
        }
        return Violation{"friction_coefficient",
                         ": the zone says nothing; give friction_coefficient, turbulent_friction_mps2, "
                         "laminar_viscosity_m2ps, cohesion_Pa, stem_density_pm2 or raster_holds"};
    });
    return s.take();
}

}  // namespace talus::params
