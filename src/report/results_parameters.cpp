#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "geo/versions.hpp"
#include "params/fields.hpp"
#include "report/hardware.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"
#include "sim/stage_times.hpp"

namespace talus::report {
namespace {

std::string_view kernel_name(params::KernelChoice kernel) {
    switch (kernel) {
        case params::KernelChoice::wendland_c2:
            return "Wendland C2 with its own gradient";
        case params::KernelChoice::cubic_spline:
            return "cubic spline with its own gradient";
        case params::KernelChoice::spiky:
            return "spiky with its own gradient";
        case params::KernelChoice::poly6_spiky:
            return "Poly6 density, Spiky gradient (Macklin & Mueller 2013)";
    }
    return "";
}

std::string bytes_text(std::uint64_t bytes) {
    if (bytes < 10'000) return fmt::format("{} B", bytes);
    return bytes < 10'000'000 ? fmt::format("{} kB", bytes / 1000) : fmt::format("{} MB", bytes / 1'000'000);
}

bool uses_particles(const scene::Scene& scene) {
    return scene.spec.solver.model == params::ModelChoice::particles;
}

/// Resistance other than friction and viscosity, if any.
void add_resistances(Json& rows, const scene::Scene& scene) {
    const params::MaterialSpec& material = scene.spec.material;
    const auto add = [&](const std::string& name, const std::string& text) { rows.push_back(fact(name, text)); };
    const bool particles = uses_particles(scene);
    if (material.viscosity_on_ground) {
        add("Viscosity on the ground",
            particles ? "the debris sticks to it"
                      : fmt::format("{} m²/s, laminar", plain(material.kinematic_viscosity.value_or(0))));
    }
    if (material.turbulent_friction) {
        const std::string at = material.turbulent_friction_thickness
                                   ? fmt::format(" where {} m thick", plain(*material.turbulent_friction_thickness))
                                   : "";
        add("Turbulent friction", fmt::format("ξ = {} m/s²{}", plain(*material.turbulent_friction), at));
    }
    if (const double nu = params::laminar_viscosity_of(material); nu > 0) {
        add("Laminar drag",
            fmt::format("ν = {} m²/s, {} Pa s", significant(nu, 3), significant(nu * material.rest_density, 3)));
    }
    if (material.samosat) {
        add("samosAT", fmt::format("R_s0 = {}, κ = {}, R = {} m, B = {}", plain(material.samosat_fluidization),
                                   plain(material.samosat_karman), plain(material.samosat_roughness),
                                   plain(material.samosat_offset)));
    }
    if (material.cohesion > 0) add("Cohesion", fmt::format("{} Pa", plain(material.cohesion)));
    const bool evolves = material.pore_pressure == params::PorePressure::dilatancy;
    if (evolves) {
        add("Soil",
            fmt::format("solid fraction {}, critical {}, permeability {} m², a = {}",
                        plain(material.solid_fraction.value_or(0)), plain(material.critical_solid_fraction.value_or(0)),
                        plain(material.permeability.value_or(0)), plain(material.compressibility)));
        add("Pore fluid",
            fmt::format("{} Pa s, {} kg/m³", plain(material.pore_fluid_viscosity), plain(material.pore_fluid_density)));
    }
    for (const params::ReleaseSpec& release : scene.spec.releases) {
        if (release.solid_fraction) {
            add(fmt::format("Solid fraction, {}", release.name), plain(*release.solid_fraction));
        }
        if (!release.pore_pressure_hydrograph.empty()) {
            add(fmt::format("Pore pressure, {}", release.name), "rises as its hydrograph says, until it fails");
            continue;
        }
        const double ratio = release.pore_pressure_ratio.value_or(material.pore_pressure_ratio);
        if (ratio <= 0) continue;
        if (evolves) {
            add(fmt::format("Pore pressure, {}", release.name), fmt::format("ratio {} at the start", plain(ratio)));
            continue;
        }
        const std::string decay = material.pore_pressure_decay_time
                                      ? fmt::format(", falls to 1/e in {} s", plain(*material.pore_pressure_decay_time))
                                      : ", stays";
        add(fmt::format("Pore pressure, {}", release.name), fmt::format("ratio {}{}", plain(ratio), decay));
    }
    if (particles && material.inertial_friction_coefficient) {
        add("Friction inside, fast shear",
            fmt::format("f = {}, half way at I = {}, grains of {} m", plain(*material.inertial_friction_coefficient),
                        plain(material.inertial_number), plain(material.grain_diameter)));
    }
    for (const params::ZoneSpec& zone : scene.spec.zones) {
        std::string says;
        const auto say = [&](const std::string& text) { says += (says.empty() ? "" : ", ") + text; };
        if (zone.friction_coefficient) say(fmt::format("f = {}", plain(*zone.friction_coefficient)));
        if (zone.turbulent_friction) say(fmt::format("ξ = {} m/s²", plain(*zone.turbulent_friction)));
        if (zone.laminar_viscosity) say(fmt::format("ν = {} m²/s", plain(*zone.laminar_viscosity)));
        if (zone.cohesion) say(fmt::format("cohesion {} Pa", plain(*zone.cohesion)));
        if (zone.raster_holds != params::ZoneRaster::zone_number) say("coefficients of its raster");
        if (zone.stem_density > 0) {
            say(fmt::format("{} stems of {} m per m²", plain(zone.stem_density), plain(zone.stem_diameter)));
        }
        add(fmt::format("Zone {}", zone.name), says);
    }
}

bool has_pore_pressure(const params::SceneSpec& spec) {
    return spec.material.pore_pressure_ratio > 0 ||
           std::any_of(spec.releases.begin(), spec.releases.end(), [](const params::ReleaseSpec& r) {
               return r.pore_pressure_ratio.value_or(0) > 0 || !r.pore_pressure_hydrograph.empty();
           });
}

/// The rows of a section have its name above the first.
std::string heading_of(const params::Section& section, std::size_t index) {
    return fmt::format("[{}]", section.repeats ? fmt::format("{} {}", section.name, index + 1) : section.name);
}

}  // namespace

Json chosen_values(const scene::Scene& scene, const run::RunResult& result) {
    const params::SolverSpec& solver = scene.spec.solver;
    const params::MaterialSpec& material = scene.spec.material;
    Json rows = Json::array();
    const auto add = [&](const char* name, const std::string& text) { rows.push_back(fact(name, text)); };
    if (result.depth_averaged()) {
        add("Model", "depth-averaged");
        add("Cell", fmt::format("{} m", plain(result.grid_cell)));
        add("Time step", fmt::format("{} to {} ms", fixed(1e3 * result.smallest_time_step, 3),
                                     fixed(1e3 * result.largest_time_step, 3)));
        add("Rest density", fmt::format("{} kg/m³", fixed(material.rest_density, 0)));
        add("Friction on the ground", fmt::format("f = {}", plain(material.friction_coefficient)));
        add_resistances(rows, scene);
        return rows;
    }
    add("Particle spacing", fmt::format("{} m", plain(result.particle_spacing)));
    add("Support radius", fmt::format("{} m", plain(result.support_radius)));
    add("Kernel", std::string(kernel_name(solver.kernel)));
    add("Time step", fmt::format("{} to {} ms, {}", fixed(1e3 * result.smallest_time_step, 3),
                                 fixed(1e3 * result.largest_time_step, 3),
                                 solver.time_step ? "fixed"
                                                  : fmt::format("adaptive: a particle moves at most {} of a spacing",
                                                                plain(solver.displacement_limit))));
    add("Iterations per step", fmt::format("{}", solver.iteration_count));
    add("Rest density", fmt::format("{} kg/m³", fixed(material.rest_density, 0)));
    add("Friction on the ground", fmt::format("f = {}", plain(material.friction_coefficient)));
    add("Friction on buildings",
        fmt::format("f = {}", plain(material.building_friction_coefficient.value_or(material.friction_coefficient))));
    add("Friction inside", fmt::format("f = {}", plain(params::internal_friction_of(material))));
    const std::string smoothing =
        material.kinematic_viscosity ? significant(result.viscosity, 3) : plain(material.viscosity);
    add("Viscosity, as smoothing", fmt::format("μ = {} per 1/60 s", smoothing));
    add("Viscosity, kinematic",
        fmt::format("{} m²/s at this support radius", significant(result.kinematic_viscosity, 3)));
    add_resistances(rows, scene);
    add("Cell of the maps", fmt::format("{} m", plain(result.map_cell)));
    return rows;
}

namespace {

/// What is said of a value, as an entry of a table: what happens where there is none.
Json shown(const params::Parameter& parameter, const params::ParameterValue& value) {
    const std::string text = params::plain_text(value);
    if (!text.empty()) return text;
    return {{"value", parameter.absent.empty() ? "not given" : parameter.absent}, {"tone", "absent"}};
}

/// Whether the scene says what the value is, or something has changed it since.
bool is_set(const scene::Scene& scene, const params::Section& section, std::size_t index,
            const params::Parameter& parameter, const params::ParameterValue& value) {
    return scene.given_keys.count(key_path(section, index, parameter)) > 0 ||
           params::toml_text(value) != params::toml_text(default_value(section, parameter));
}

/// The keys that are set, or those that are not.
Json parameter_table(const scene::Scene& scene, bool set) {
    Json rows = table({{"key", "Key", "", "", "code"},
                       {"value", "Value", "", "", "value"},
                       {"unit", "Unit", "", "", "", ""},
                       {"help", "Meaning", "", "", "help"}},
                      "parameters");
    std::string open;
    for_each_value(scene.spec, [&](const params::Section& section, std::size_t index,
                                   const params::Parameter& parameter, const params::ParameterValue& value) {
        // Printed in full elsewhere: at the top, under Assumptions, beside the computed front velocities.
        if (section.name == "scene" || section.name == "report" || section.name == "observation") return;
        if (is_set(scene, section, index, parameter, value) != set) return;
        const bool unused = uses_particles(scene) ? !scene.zoom && parameter.use == params::KeyUse::depth_averaged
                                                  : parameter.use == params::KeyUse::particles;
        if (unused && !set) return;
        Json row = {{"key", parameter.key},
                    {"value", shown(parameter, value)},
                    {"unit", parameter.unit},
                    {"help", !unused                 ? parameter.help
                             : uses_particles(scene) ? "Used by the depth-averaged model only."
                                                     : "Not used by the depth-averaged model."}};
        if (const std::string heading = heading_of(section, index); heading != open) {
            row["heading"] = open = heading;
            row["heading_note"] = index == 0 ? section.help : "";
        }
        rows["rows"].push_back(std::move(row));
    });
    return rows;
}

/// Whether a result rests on a default of this run.
bool matters(const scene::Scene& scene, const run::RunResult& result, const params::Section& section, std::size_t index,
             const params::Parameter& parameter) {
    const auto& impacts = result.observation.buildings;
    const auto any = [&](const auto& what) { return std::any_of(impacts.begin(), impacts.end(), what); };
    if (section.name == "buildings") {
        if (!any([](const observe::BuildingImpact& b) { return b.hit && !b.is_barrier; })) return false;
        if (parameter.key == "resistance_Pa") return scene.spec.buildings.resistance_attribute.empty();
        return std::any_of(scene.buildings.begin(), scene.buildings.end(),
                           [](const terrain::Building& b) { return b.height_assumed; });
    }
    if (section.name == "outputs") return any([](const observe::BuildingImpact& b) { return b.hit; });
    if (section.name == "release") return !scene.spec.releases[index].volume;
    if (section.name == "bed") {
        return parameter.key == "law" || scene.spec.beds[index].law == params::EntrainmentLaw::shear;
    }
    if (parameter.key == "building_friction_coefficient") return !impacts.empty();
    if (parameter.key == "viscosity") return !scene.spec.material.kinematic_viscosity;
    return true;
}

}  // namespace

Json parameters(const scene::Scene& scene) {
    return parameter_table(scene, true);
}

Json defaults(const scene::Scene& scene) {
    Json rows = parameter_table(scene, false);
    const std::size_t count = rows["rows"].size();
    return {{"count", count}, {"table", std::move(rows)}};
}

Json not_set(const scene::Scene& scene, const run::RunResult& result) {
    Json rows = table({{"assumption", "Assumption", ""},
                       {"value", "Value", "", "", "value"},
                       {"unit", "Unit", "", "", "", ""},
                       {"key", "Not set in the scene", "", "", "code"}},
                      "not-set");
    const auto add = [&](const std::string& what, Json value, const std::string& unit, const std::string& key) {
        rows["rows"].push_back({{"assumption", what}, {"value", std::move(value)}, {"unit", unit}, {"key", key}});
    };
    for_each_value(scene.spec, [&](const params::Section& section, std::size_t index,
                                   const params::Parameter& parameter, const params::ParameterValue& value) {
        if (parameter.assumption.empty() || is_set(scene, section, index, parameter, value)) return;
        if (!matters(scene, result, section, index, parameter)) return;
        if (result.depth_averaged() && parameter.use == params::KeyUse::particles) return;
        add(parameter.assumption, shown(parameter, value), parameter.unit, key_path(section, index, parameter));
    });
    for (std::size_t i = 0; i < scene.releases.size(); ++i) {
        const terrain::Release& release = scene.releases[i];
        if (!release.spec.volume || release.patches.empty()) continue;
        add(fmt::format("Thickness of {}, the same everywhere, from its volume", release.name),
            significant(release.patches.front().thickness, 3), "m", fmt::format("release[{}].thickness_m", i));
    }
    if (scene.spec.beds.empty()) add("Erosion", {{"value", "no erosion of the ground"}, {"tone", "absent"}}, "", "bed");
    const std::size_t count = rows["rows"].size();
    return count == 0 ? Json() : Json{{"count", count}, {"table", std::move(rows)}};
}

Json method(const scene::Scene& scene) {
    const params::MaterialSpec& material = scene.spec.material;
    const auto& all_zones = scene.spec.zones;
    const auto any_zone = [&](const auto& holds) { return std::any_of(all_zones.begin(), all_zones.end(), holds); };
    const bool turbulent =
        material.turbulent_friction || any_zone([](const params::ZoneSpec& zone) {
            return zone.turbulent_friction || zone.raster_holds == params::ZoneRaster::turbulent_friction;
        });
    const auto& all_barriers = scene.spec.barriers;
    const auto given = [](const auto& value) { return value ? Json(*value) : Json(); };
    const bool pairwise = scene.spec.solver.internal_friction == params::InternalFriction::pair;
    return {
        {"pairwise_internal_friction", pairwise},
        {"turbulent_friction",
         turbulent ? Json{{"thickness_m", given(material.turbulent_friction_thickness)}} : Json()},
        {"laminar_drag", params::laminar_viscosity_of(material) > 0 || any_zone([](const params::ZoneSpec& zone) {
                             return zone.laminar_viscosity.value_or(0) > 0;
                         })},
        {"samosat", static_cast<bool>(material.samosat)},
        {"cohesion", material.cohesion > 0},
        {"evolving_pore_pressure", material.pore_pressure == params::PorePressure::dilatancy},
        {"pore_pressure", has_pore_pressure(scene.spec) && material.pore_pressure == params::PorePressure::prescribed
                              ? Json{{"decay_time_s", given(material.pore_pressure_decay_time)}}
                              : Json()},
        {"inertial_friction", material.inertial_friction_coefficient.has_value()},
        {"viscosity_on_ground", static_cast<bool>(material.viscosity_on_ground)},
        {"flight", scene.spec.solver.flight},
        {"stems", any_zone([](const params::ZoneSpec& zone) { return zone.stem_density > 0; })},
        {"nets", std::any_of(all_barriers.begin(), all_barriers.end(),
                             [](const params::BarrierSpec& b) { return b.passing_share.has_value(); })},
        {"zones", !all_zones.empty()}};
}

Json inputs(const scene::Scene& scene) {
    Json rows = table({{"role", "Input", ""},
                       {"path", "File", "", "", "path"},
                       {"size", "Size", "", "", "n"},
                       {"fnv1a_64", "Checksum (FNV-1a 64)", "", "", "code"}});
    for (const scene::InputFile& input : scene.inputs) {
        rows["rows"].push_back({{"role", input.role},
                                {"path", input.path},
                                {"size", bytes_text(input.bytes)},
                                {"bytes", input.bytes},
                                {"fnv1a_64", input.hash}});
    }
    return rows;
}

Json computation(const scene::Scene& scene, const run::RunResult& result) {
    const Hardware machine = this_machine();
    const GridGeometry& grid = scene.terrain.elevation().geometry;
    Json rows = {
        fact("Result hash", fmt::format("{:016x}, of time, {} and velocities at the end", result.hash,
                                        result.depth_averaged() ? "depths" : "positions")),
        fact("Program", fmt::format("talus {}, GDAL {}, PROJ {}, compiled with {}", TALUS_VERSION, geo::gdal_version(),
                                    geo::proj_version(), compiler_version())),
        fact("Hardware",
             fmt::format("{}, {} of {} logical cores used{}{}{}",
                         machine.cpu.empty() ? "processor not named by the system" : machine.cpu, result.thread_count,
                         machine.logical_cores,
                         machine.memory_GiB > 0 ? fmt::format(", {} GiB of memory", fixed(machine.memory_GiB, 1)) : "",
                         machine.system.empty() ? "" : ", ", machine.system)),
        fact("Arithmetic", "32-bit floating point around a 64-bit origin"),
        fact("Reference system", scene.crs.label()),
        fact("Terrain",
             fmt::format("{} × {} cells of {} m, {} % without data, elevations in {}", grid.columns, grid.rows,
                         plain(scene.terrain.cell()), fixed(100 * scene.nodata_share, 1), scene.vertical_unit)),
    };
    double total = 0;
    for (const double s : result.stage_times.seconds) total += s;
    std::string stages;
    for (std::size_t k = 0; total > 0 && k < sim::stage_count; ++k) {
        stages += fmt::format("{}{}\u00a0{}\u00a0%", k == 0 ? "" : ", ", sim::step_stages[k].name,
                              fixed(100 * result.stage_times.seconds[k] / total, 0));
    }
    if (!stages.empty()) rows.push_back(fact("Time per stage", stages));
    return rows;
}

}  // namespace talus::report
