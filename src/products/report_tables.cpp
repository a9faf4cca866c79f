#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "geo/versions.hpp"
#include "params/fields.hpp"
#include "products/hardware.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"
#include "report_files.hpp"
#include "sim/stage_times.hpp"

namespace talus::report {
namespace {

std::string items(const std::vector<std::string>& texts, std::string_view none) {
    if (texts.empty()) return fmt::format("<p>{}</p>", none);
    std::string html = "<ul>";
    for (const std::string& text : texts) html += "<li>" + escape(text) + "</li>\n";
    return html + "</ul>";
}

std::string_view kernel_name(KernelChoice kernel) {
    switch (kernel) {
        case KernelChoice::wendland_c2:
            return "Wendland C2 with its own gradient";
        case KernelChoice::cubic_spline:
            return "cubic spline with its own gradient";
        case KernelChoice::spiky:
            return "spiky with its own gradient";
        case KernelChoice::poly6_spiky:
            return "published pair: Poly6 density, spiky gradient";
    }
    return "";
}

std::string bytes_text(std::uint64_t bytes) {
    if (bytes < 10'000) return fmt::format("{} B", bytes);
    return bytes < 10'000'000 ? fmt::format("{} kB", bytes / 1000) : fmt::format("{} MB", bytes / 1'000'000);
}

}  // namespace

namespace {

/// What resists beside friction and viscosity, where anything does.
std::string resistance_rows(const Scene& scene) {
    const MaterialSpec& material = scene.spec.material;
    std::string html;
    if (material.viscosity_on_ground) html += row("Viscosity on the ground", "the debris sticks to it");
    if (material.turbulent_friction) {
        const std::string at = material.turbulent_friction_thickness
                                   ? fmt::format(" where {} m thick", plain(*material.turbulent_friction_thickness))
                                   : "";
        html += row("Turbulent friction", fmt::format("ξ = {} m/s²{}", plain(*material.turbulent_friction), at));
    }
    if (material.cohesion > 0) html += row("Cohesion", fmt::format("{} Pa", plain(material.cohesion)));
    for (const ReleaseSpec& release : scene.spec.releases) {
        const double ratio = release.pore_pressure_ratio.value_or(material.pore_pressure_ratio);
        if (ratio <= 0) continue;
        const std::string decay = material.pore_pressure_decay_time
                                      ? fmt::format(", falls to 1/e in {} s", plain(*material.pore_pressure_decay_time))
                                      : ", stays";
        html += row(fmt::format("Pore pressure, {}", escape(release.name)),
                    fmt::format("r<sub>u</sub> = {}{}", plain(ratio), decay));
    }
    if (material.inertial_friction_coefficient) {
        html += row(
            "Friction inside, fast shear",
            fmt::format("f = {}, half way at I = {}, grains of {} m", plain(*material.inertial_friction_coefficient),
                        plain(material.inertial_number), plain(material.grain_diameter)));
    }
    for (const ZoneSpec& zone : scene.spec.zones) {
        std::string says;
        const auto add = [&](const std::string& text) { says += (says.empty() ? "" : ", ") + text; };
        if (zone.friction_coefficient) add(fmt::format("f = {}", plain(*zone.friction_coefficient)));
        if (zone.turbulent_friction) add(fmt::format("ξ = {} m/s²", plain(*zone.turbulent_friction)));
        if (zone.cohesion) add(fmt::format("cohesion {} Pa", plain(*zone.cohesion)));
        if (zone.raster_holds != ZoneRaster::zone_number) add("coefficients of its raster");
        if (zone.stem_density > 0) {
            add(fmt::format("{} stems of {} m per m²", plain(zone.stem_density), plain(zone.stem_diameter)));
        }
        html += row(fmt::format("Zone {}", escape(zone.name)), says);
    }
    return html;
}

bool has_pore_pressure(const SceneSpec& spec) {
    return spec.material.pore_pressure_ratio > 0 ||
           std::any_of(spec.releases.begin(), spec.releases.end(),
                       [](const ReleaseSpec& r) { return r.pore_pressure_ratio.value_or(0) > 0; });
}

/// The laws that this scene uses beside friction and viscosity, a paragraph each.
std::string resistance_laws(const Scene& scene) {
    const MaterialSpec& material = scene.spec.material;
    bool turbulent = material.turbulent_friction.has_value(), stems = false;
    for (const ZoneSpec& zone : scene.spec.zones) {
        turbulent = turbulent || zone.turbulent_friction || zone.raster_holds == ZoneRaster::turbulent_friction;
        stems = stems || zone.stem_density > 0;
    }
    std::string html;
    if (turbulent) {
        html +=
            "<p><b>Turbulent friction.</b> Flow of thickness h and speed v is slowed by g v² / (ξ h) in all of its "
            "depth, beside Coulomb friction on the ground (Voellmy 1955).";
        if (material.turbulent_friction_thickness) {
            html +=
                fmt::format(" ξ grows with the cube root of h, as in Manning’s law, and is as given where h is {} m.",
                            plain(*material.turbulent_friction_thickness));
        }
        html += "</p>\n";
    }
    if (material.cohesion > 0) {
        html +=
            "<p><b>Cohesion.</b> On the ground and inside, debris resists shear by its cohesion even where nothing "
            "presses on it; what friction bears comes on top.</p>\n";
    }
    if (has_pore_pressure(scene.spec)) {
        html +=
            "<p><b>Pore pressure.</b> Water bears the share r<sub>u</sub> of the normal stress, so that friction on "
            "ground, buildings and inside is 1 - r<sub>u</sub> of that of dry debris";
        html += material.pore_pressure_decay_time
                    ? fmt::format(
                          "; it fades as exp(-t / T) from the start of a body of debris, T = {} s, the first "
                          "mode of consolidation (Hutchinson 1986).</p>\n",
                          plain(*material.pore_pressure_decay_time))
                    : "; it stays (undrained).</p>\n";
    }
    if (material.inertial_friction_coefficient) {
        html +=
            "<p><b>Inertial friction.</b> Friction inside grows with the inertial number of the shear (mu(I) law, "
            "Jop, Forterre &amp; Pouliquen 2006).</p>\n";
    }
    if (material.viscosity_on_ground) {
        html +=
            "<p><b>Viscosity on the ground.</b> The debris sticks to the ground as a viscous fluid does (Morris, Fox "
            "&amp; Zhu 1997).</p>\n";
    }
    if (stems) {
        html +=
            "<p><b>Forest.</b> Stems slow debris as cylinders across the flow, by C<sub>D</sub> n D v² / 2 for n stems "
            "of diameter D per area (Petryk &amp; Bosmajian 1975). They neither break nor hold debris back as a "
            "heap.</p>\n";
    }
    const auto& barriers = scene.spec.barriers;
    if (std::any_of(barriers.begin(), barriers.end(),
                    [](const BarrierSpec& b) { return b.passing_share.has_value(); })) {
        html +=
            "<p><b>Nets.</b> Debris of one density stands for grains of all sizes: every particle has a rank by size, "
            "drawn evenly, and a net is no obstacle to those whose rank is below the share that passes its meshes, and "
            "a wall for the others. What is held fills the net from behind and closes it to fine grains. Ropes and "
            "rings do not stretch or sag, and fine grains lose nothing to them.</p>\n";
    }
    if (!scene.spec.zones.empty()) {
        html +=
            "<p><b>Zones.</b> The ground resists in its own way in the zones listed with the parameters; a cell of "
            "the terrain belongs to a zone when its centre does.</p>\n";
    }
    return html;
}

}  // namespace

std::string chosen_values(const Scene& scene, const RunResult& result) {
    const SolverSpec& solver = scene.spec.solver;
    const MaterialSpec& material = scene.spec.material;
    std::string html = row("Particle spacing", fmt::format("{} m", plain(result.particle_spacing)));
    html += row("Support radius", fmt::format("{} m", plain(result.support_radius)));
    html += row("Kernel", std::string(kernel_name(solver.kernel)));
    html += row("Time step",
                fmt::format("{} to {} ms, {}", fixed(1e3 * result.smallest_time_step, 3),
                            fixed(1e3 * result.largest_time_step, 3),
                            solver.time_step ? "fixed"
                                             : fmt::format("adaptive: a particle moves at most {} of a spacing",
                                                           plain(solver.displacement_limit))));
    html += row("Iterations per step", fmt::format("{}", solver.iteration_count));
    html += row("Rest density", fmt::format("{} kg/m³", fixed(material.rest_density, 0)));
    html += row("Friction on the ground", fmt::format("f = {}", plain(material.friction_coefficient)));
    html += row(
        "Friction on buildings",
        fmt::format("f = {}", plain(material.building_friction_coefficient.value_or(material.friction_coefficient))));
    html += row(
        "Friction inside",
        fmt::format("f = {}", plain(material.internal_friction_coefficient.value_or(material.friction_coefficient))));
    const std::string smoothing =
        material.kinematic_viscosity ? significant(result.viscosity, 3) : plain(material.viscosity);
    html += row("Viscosity, as smoothing", fmt::format("μ = {} per 1/60 s", smoothing));
    html += row("Viscosity, kinematic",
                fmt::format("{} m²/s at this support radius", significant(result.kinematic_viscosity, 3)));
    html += resistance_rows(scene);
    html += row("Cell of the maps", fmt::format("{} m", plain(result.map_cell)));
    return html;
}

std::string parameter_table(const Scene& scene) {
    std::string html;
    std::string open;
    for_each_value(scene.spec, [&](const Section& section, std::size_t index, const Parameter& parameter,
                                   const ParameterValue& value) {
        // Printed in full elsewhere: at the top, under Assumptions, beside the computed front velocities.
        if (section.name == "scene" || section.name == "observation") return;
        const std::string heading = section.repeats ? fmt::format("{} {}", section.name, index + 1) : section.name;
        if (heading != open) {
            html += fmt::format(
                "<tr class=\"section\"><th colspan=\"4\" scope=\"colgroup\">[{}] <small>{}</small></th></tr>\n",
                escape(heading), index == 0 ? escape(section.help) : "");
            open = heading;
        }
        const std::string text = plain_text(value);
        const bool set = !text.empty();
        const bool differs = set && text != plain_text(default_value(section, parameter));
        html += fmt::format(
            "<tr><td><code>{}</code></td><td class=\"value{}\">{}</td><td>{}</td><td class=\"help\">{}</td></tr>\n",
            escape(parameter.key), differs ? " differs" : "",
            set ? escape(text)
                : "<span class=\"absent\">" + escape(parameter.absent.empty() ? "not given" : parameter.absent) +
                      "</span>",
            escape(parameter.unit), escape(parameter.help));
    });
    return html;
}

std::string method(const Scene& scene) {
    const bool pairwise = scene.spec.solver.internal_friction == InternalFriction::pair;
    const bool wet = has_pore_pressure(scene.spec);
    return fill(
        report_files::method_html,
        {{"internal_friction",
          pairwise
              ? "Between particles the same law acts pair by pair, limited by the normal correction of the pair."
              : "Inside the debris every particle carries a shear stress from step to step, limited by the internal "
                "friction coefficient times the pressure (Drucker &amp; Prager 1952, without cohesion)."},
         {"deposits",
          pairwise
              ? "<b>Deposits creep.</b> Friction between pairs of particles is built anew in every step and acts like "
                "a "
                "high viscosity at rest: a heap that should stand spreads on, ever more slowly, rather than stopping. "
                "The "
                "run-out of the slow tail is overestimated and the deposit too thin; the fast front is hardly affected."
              : "<b>Deposits stand.</b> The stress that persists holds a heap below its friction angle without creep; "
                "the front of a deposit cannot be thinner than one particle and ends some particle spacings short."},
         {"water", wet ? "Pore pressure is a number that the scene states, not computed" : "The material is dry"},
         {"resistance_laws", resistance_laws(scene)}});
}

std::string assumptions(const Scene& scene) {
    std::string html = "<h3 id=\"assumptions\">Assumptions of this scene</h3>" +
                       items(scene.spec.scene.assumptions, "The scene states none.");
    html += "<h3>What was done to the inputs</h3>" + items(scene.notes, "Nothing: all inputs were used as they are.");
    html += "<h3>Sources and attribution</h3>" + items(scene.spec.scene.sources, "The scene names none.");
    return html;
}

std::string input_table(const Scene& scene) {
    std::string html;
    for (const InputFile& input : scene.inputs) {
        html += fmt::format(
            "<tr><td>{}</td><td class=\"path\">{}</td><td class=\"n\">{}</td><td><code>{}</code></td></tr>\n",
            escape(input.role), escape(input.path), bytes_text(input.bytes), escape(input.hash));
    }
    return html;
}

std::string computation_table(const Scene& scene, const RunResult& result) {
    std::string html = row(
        "Result hash",
        fmt::format("<code>{:016x}</code> <small>of time, positions and velocities at the end</small>", result.hash));
    html += row("Program", fmt::format("talus {}, GDAL {}, PROJ {}, compiled with {}", TALUS_VERSION, gdal_version(),
                                       proj_version(), compiler_version()));
    const Hardware machine = this_machine();
    html +=
        row("Hardware",
            fmt::format("{}, {} of {} logical cores used{}{}{}",
                        machine.cpu.empty() ? "processor not named by the system" : escape(machine.cpu),
                        result.thread_count, machine.logical_cores,
                        machine.memory_GiB > 0 ? fmt::format(", {} GiB of memory", fixed(machine.memory_GiB, 1)) : "",
                        machine.system.empty() ? "" : ", ", escape(machine.system)));
    html += row("Arithmetic", "32-bit floating point around a 64-bit origin");
    html += row("Reference system", escape(scene.crs.label()));
    html += row("Terrain", fmt::format("{} × {} cells of {} m, {} % without data, elevations in {}",
                                       scene.terrain.elevation().geometry.columns,
                                       scene.terrain.elevation().geometry.rows, plain(scene.terrain.cell()),
                                       fixed(100 * scene.nodata_share, 1), escape(scene.vertical_unit)));
    double total = 0;
    for (const double s : result.stage_times.seconds) total += s;
    std::string stages;
    for (std::size_t k = 0; total > 0 && k < stage_count; ++k) {
        const double share = 100 * result.stage_times.seconds[k] / total;
        stages += fmt::format("<span class=\"stage\">{} <b>{} %</b></span> ", step_stages[k].name, fixed(share, 0));
    }
    if (!stages.empty()) html += row("Time per stage", stages);
    return html;
}

}  // namespace talus::report
