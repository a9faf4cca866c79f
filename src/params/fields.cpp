#include "params/fields.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "params/contours.hpp"
#include "params/declaration.hpp"
#include "params/time_step.hpp"

namespace talus::params {
namespace {

Section declare_scene() {
    Declaration<SceneInfo> s("scene", "What the run is about; all of it is printed in the report.", &SceneSpec::scene);
    s.text("title", &SceneInfo::title, "the scene file's name", "Title of the report.");
    s.text("description", &SceneInfo::description, "none", "What is simulated and why, in a few sentences.");
    s.key("reconstruction", "", &SceneInfo::reconstruction, anything(),
          "Whether the inputs are reconstructed rather than surveyed; every product then says so.");
    s.key("assumptions", "", &SceneInfo::assumptions, anything(), "What was assumed, one sentence each.");
    s.key("sources", "", &SceneInfo::sources, anything(),
          "Where facts and data come from, with the attribution their licences ask for.");
    s.text("option", &SceneInfo::option, "the ground as it is, without any option",
           "Name of the [[option]] whose measures are in force.");
    s.rule([](const SceneInfo& info, const SceneSpec& scene, double) -> std::optional<Violation> {
        std::vector<std::string> names;
        for (const OptionSpec& option : scene.options) names.push_back(option.name);
        if (info.option.empty() || std::find(names.begin(), names.end(), info.option) != names.end()) return {};
        return Violation{"option",
                         fmt::format(" = \"{}\": there is no such option; options of the scene: {}", info.option,
                                     names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")))};
    });
    return s.take();
}

/// Whether a text is a day as ISO 8601 writes it.
bool is_date(const std::string& text) {
    int year = 0;
    unsigned month = 0, day = 0;
    if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
    const auto read = [&](std::size_t from, std::size_t length, auto& number) {
        const char* end = text.data() + from + length;
        const auto [stopped, error] = std::from_chars(text.data() + from, end, number);
        return error == std::errc() && stopped == end;
    };
    if (!read(0, 4, year) || !read(5, 2, month) || !read(8, 2, day)) return false;
    return year > 0 &&
           std::chrono::year_month_day(std::chrono::year(year), std::chrono::month(month), std::chrono::day(day)).ok();
}

Section declare_report() {
    Declaration<ReportSpec> s("report", "Who answers for the report and what it may be used for; printed in its head.",
                              &SceneSpec::report);
    s.text("client", &ReportSpec::client, "not stated", "For whom the report is made.");
    s.text("author", &ReportSpec::author, "not stated", "Who made it; the printed report leaves room for a signature.");
    s.text("checker", &ReportSpec::checker, "not stated",
           "Who checked it; the printed report leaves room for a signature.");
    s.text("reference", &ReportSpec::reference, "not stated", "Reference number of the project or the report.");
    s.text("revision", &ReportSpec::revision, "not stated", "Revision of the report.");
    s.text("date", &ReportSpec::date, "not stated",
           "Day of issue as YYYY-MM-DD (ISO 8601), in quotes. The time of the run is printed next to it.");
    s.text("limits_of_use", &ReportSpec::limits_of_use, "not stated",
           "What the results may be used for and what not, in a few sentences.");
    s.rule([](const ReportSpec& report, const SceneSpec&, double) -> std::optional<Violation> {
        if (report.date.empty() || is_date(report.date)) return {};
        return Violation{"date", fmt::format(" = {} is refused; it must be a day as YYYY-MM-DD, such as \"2026-11-23\"",
                                             toml_text(ParameterValue(report.date)))};
    });
    return s.take();
}

Section declare_terrain() {
    Declaration<TerrainSpec> s(
        "terrain", "The ground, as a raster of elevations in a projected metric reference system, or in local metres.",
        &SceneSpec::terrain);
    s.path("file", &TerrainSpec::file, "", "Any raster that GDAL reads; its reference system is that of the whole run.")
        .required = true;
    s.choice("crs", &TerrainSpec::crs, {"file", "local"},
             "Coordinate reference system: that of the file, or local for metres of its own, as those of a laboratory "
             "flume, where the file states none. Layers that state none are then in the same coordinates, and outputs "
             "that need a place on the globe are left out.");
    s.key("band", "", &TerrainSpec::band, between(1, 65535), "The raster's band that holds elevations.");
    s.optional_key("extent_m", "m", &TerrainSpec::extent, anything(), "the whole raster",
                   "The part of the terrain to use, in its own coordinates.");
    s.text("obtain", &TerrainSpec::obtain, "nothing is said", "Where to obtain the file; told to whoever lacks it.");
    s.path("deposit", &TerrainSpec::deposit, "nothing lies on the ground",
           "Raster of depths in metres that raise the ground, such as deposit_depth.tif of an earlier surge.");
    s.path("erosion", &TerrainSpec::erosion, "nothing was eroded",
           "Raster of depths in metres that lower the ground, such as erosion_depth.tif of an earlier surge.");
    s.path(
        "orthophoto", &TerrainSpec::orthophoto, "none",
        "Picture of the ground from above, as GDAL reads it (GeoTIFF, or JPEG or PNG with a world file), that the live "
        "twin drapes over the terrain; without a reference system of its own it is taken to have the terrain's. "
        "Results do not depend on it.");
    return s.take();
}

Section declare_flow_path() {
    Declaration<FlowPathSpec> s("flow_path", "The line along which chainage is measured.", &SceneSpec::flow_path);
    s.path("file", &FlowPathSpec::file, "traced downhill from the release",
           "A line from the crown downstream: GeoJSON, GeoPackage, Shapefile. A traced path is a first guess: after "
           "the run, "
           "chainages are along the path that debris followed, unless observations refer to the traced one.");
    s.text("layer", &FlowPathSpec::layer, "the only layer", "Layer of the file.");
    s.key("corridor_width_m", "m", &FlowPathSpec::corridor_width, between(0.01, 1e5),
          "Debris farther than half of this from the line does not count as front.");
    return s.take();
}

Section declare_solver() {
    Declaration<SolverSpec> s("solver", "Numerical settings.", &SceneSpec::solver);
    s.optional_key("particle_spacing_m", "m", &SolverSpec::particle_spacing, between(1e-4, 100),
                   "from target_layers or target_particle_count",
                   "Edge of the cube of debris that a particle stands for.")
        .also_called({"particle_size", "particle_diameter", "resolution"})
        .for_particles_only();
    s.optional_key("target_layers", "", &SolverSpec::target_layers, between(1, 1000), "from target_particle_count",
                   "Particles over the mean thickness of the thinnest release, normal to the slope; an inflow across a "
                   "line counts with the mean thickness at which it enters.")
        .for_particles_only();
    s.optional_key("target_particle_count", "", &SolverSpec::target_particle_count, between(1, 1e8),
                   fmt::format("{}, unless one of the two keys above is given", SolverSpec::usual_particle_count),
                   "Particles of the volume of all releases and inflows.")
        .also_called({"particles", "number_of_particles", "particle_count"})
        .for_particles_only();
    s.at_most_one_of({"particle_spacing_m", "target_layers", "target_particle_count"});
    s.key("particle_limit", "", &SolverSpec::particle_limit, between(1, 1e8),
          "More particles than this are refused before the run.")
        .for_particles_only();
    s.optional_key("time_step_s", "s", &SolverSpec::time_step, between(1e-5, 1),
                   "adaptive: a particle moves at most displacement_limit of a spacing per step", "Fixed time step.")
        .also_called({"dt"})
        .for_particles_only();
    s.key("displacement_limit", "", &SolverSpec::displacement_limit, between(0.001, 1),
          "Share of a spacing that a particle moves at most in an adaptive time step.")
        .for_particles_only();
    s.optional_key("largest_time_step_s", "s", &SolverSpec::largest_time_step, between(1e-5, 1),
                   "sqrt(particle spacing / g) / 6, at least 1/60 and at most 1/30 s",
                   "Upper bound of the adaptive time step. Fast, overcompressed and very viscous debris shortens it.")
        .for_particles_only();
    s.key("smallest_time_step_s", "s", &SolverSpec::smallest_time_step, between(1e-5, 1),
          "An adaptive time step below this stops the run as a fault.")
        .for_particles_only();
    s.key("iteration_count", "", &SolverSpec::iteration_count, between(1, 1000), "Solver iterations per time step.")
        .for_particles_only();
    s.key("extra_iteration_count", "", &SolverSpec::extra_iteration_count, between(0, 1000),
          "Iterations that a step may take besides while debris is overcompressed: past half of the limits of "
          "compression.")
        .for_particles_only();
    s.choice("kernel", &SolverSpec::kernel, {"wendland_c2", "cubic_spline", "spiky", "poly6_spiky"},
             "Smoothing kernel; poly6_spiky is the pair of Macklin & Mueller (2013): Poly6 for the density, Spiky for "
             "its gradient.")
        .for_particles_only();
    s.choice(
         "internal_friction", &SolverSpec::internal_friction, {"stress", "pair"},
         "How debris rubs on debris: stress keeps a shear stress per particle between steps, so that a deposit stands; "
         "pair is a correction per pair of particles (Macklin et al. 2014), which creeps.")
        .for_particles_only();
    s.key("support_ratio", "", &SolverSpec::support_ratio, between(1.5, 4),
          "Support radius of the kernel over the particle spacing.")
        .for_particles_only();
    s.key(
         "under_relaxation", "", &SolverSpec::under_relaxation, between(0.001, 2),
         "Factor on every correction of the Jacobi iteration, relative to its largest eigenvalue: above 2 it diverges.")
        .for_particles_only();
    s.key("constraint_relaxation", "", &SolverSpec::constraint_relaxation, between(0, 1000),
          "Softens the density constraint: term in the multiplier's denominator relative to its rest value.")
        .for_particles_only();
    s.key("depenetration_speed_mps", "m/s", &SolverSpec::depenetration_speed, between(1e-6, 1000),
          "With internal_friction = \"pair\": the fastest that compression at the start of a step is undone.")
        .for_particles_only();
    s.key("end_time_s", "s", &SolverSpec::end_time, above_to(0, 1e7),
          "Simulated time at which the run ends at the latest.")
        .also_called({"t_end", "end_time", "duration", "simulation_time"});
    s.key("stop_moving_share", "", &SolverSpec::stop_moving_share, from_to_below(0, 1),
          "Ends the run when less of the debris than this (but five particles at least) is faster than "
          "outputs.deposited_speed_mps and no more than a ten-thousandth ten times as fast; 0 never does.");
    s.key("stop_energy_share", "", &SolverSpec::stop_energy_share, from_to_below(0, 1),
          "Ends the run when the kinetic energy of the debris is below this share of its peak, as AvaFrame's kinEnergy "
          "does with 0.01, and nothing is still to start or to come in; 0 never does. Debris may still run, fall and "
          "strike then.")
        .also_called({"stop_crit"});
    s.key("stop_momentum_share", "", &SolverSpec::stop_momentum_share, from_to_below(0, 1),
          "The same for the momentum, mass times speed over all debris, as RAMMS does with 0.05; 0 never does.")
        .also_called({"stop_momentum", "stop_criterion"});
    s.key("stop_duration_s", "s", &SolverSpec::stop_duration, between(0, 1e7),
          "Duration for which stop_moving_share, stop_energy_share or stop_momentum_share must hold.");
    s.key("rest_duration_s", "s", &SolverSpec::rest_duration, between(0, 1e7),
          "Debris that has hardly moved (a hundredth of a particle's free-fall speed) for so long is at rest: it "
          "presses as before and costs little until something moves next to it. 0: nothing sleeps.")
        .for_particles_only();
    s.key("compression_limit", "", &SolverSpec::compression_limit, above_to(0, 10),
          "Mean over-density (density over rest density, less 1) above which the run stops as a fault.")
        .for_particles_only();
    s.key("thread_count", "", &SolverSpec::thread_count, between(0, 512),
          "Threads to compute with; 0 takes all cores. Results do not depend on it.")
        .also_called({"threads", "nCPU", "n_cpu"});
    s.choice("backend", &SolverSpec::backend, {"cpu", "auto", "cuda", "host"},
             "What moves the particles: the processor (cpu), a graphics card of NVIDIA (cuda), or the card where there "
             "is one and the particles are many (auto). host computes what the card would on the processor, slowly, to "
             "test it. Results agree as docs/gpu.md says, not bit for bit.")
        .for_particles_only();
    s.choice(
        "model", &SolverSpec::model, {"particles", "depth_averaged"},
        "particles: in three dimensions. depth_averaged: depth and velocity per cell of a grid, in seconds, without "
        "what happens inside the flow; buildings and barriers are whole cells (docs/depth-averaged.md).");
    s.optional_key("grid_cell_m", "m", &SolverSpec::grid_cell, between(1e-3, 1000),
                   "the terrain's cell, or the largest whole fraction of it up to 2.5 m",
                   "Cell of the depth-averaged model.")
        .also_called({"mesh_cell_size", "cell_size", "grid_resolution"})
        .for_depth_averaged_only();
    s.key("flight", "", &SolverSpec::flight, anything(),
          "true: debris of the depth-averaged model leaves the ground where that would have to hold it, flies without "
          "friction, and loses the velocity normal to the ground where it lands. false: it follows the ground.")
        .for_depth_averaged_only();
    s.rule([](const SolverSpec& solver, const SceneSpec&, double spacing) -> std::optional<Violation> {
        const double small = solver.smallest_time_step, large = largest_time_step(solver, spacing);
        if (small <= large) return {};
        const bool small_given = small != SolverSpec{}.smallest_time_step;
        return Violation{
            small_given ? "smallest_time_step_s" : "largest_time_step_s",
            fmt::format(" = {} is refused; smallest_time_step_s = {} must not be above largest_time_step_s = {}",
                        small_given ? small : large, small, large)};
    });
    return s.take();
}

Section declare_outputs() {
    Declaration<OutputSpec> s("outputs", "What is written.", &SceneSpec::outputs);
    s.optional_key("map_cell_m", "m", &OutputSpec::map_cell, between(1e-4, 1000),
                   "a whole fraction or multiple of the terrain's cell near 2.5 particle spacings",
                   "Cell of the hazard maps.")
        .for_particles_only();
    s.key("sample_interval_s", "s", &OutputSpec::sample_interval, between(0.001, 1e7),
          "Simulated time between rows of timeseries.csv.");
    s.key("chainage_interval_m", "m", &OutputSpec::chainage_interval, between(0.001, 1000),
          "Chainage between rows of front.csv. On a flow path of less than 20 m, as in a laboratory, the defaults of "
          "this key, front_velocity_window_m, arrival_depth_m and impact_patch_edge_m are smaller by length over 20 m, "
          "which a note states.");
    s.key("front_velocity_window_m", "m", &OutputSpec::front_velocity_window, between(0.001, 1e5),
          "Chainage over which front velocity is fitted to the arrival times.");
    s.key("arrival_depth_m", "m", &OutputSpec::arrival_depth, between(0, 1000),
          "Debris has arrived in a map cell once it is deeper than this.")
        .also_called({"threshold_depth"});
    s.key("impact_filter_window_s", "s", &OutputSpec::impact_filter_window, above_to(0, 1000),
          "Averaging window of force and impact pressure on structures.")
        .assumes("Averaging time of force and impact pressure");
    s.key("impact_patch_edge_m", "m", &OutputSpec::impact_patch_edge, between(0.1, 100),
          "Edge of the square patches of walls and roofs, the reference area of impact pressure: a patch's filtered "
          "force over its area, independent of the particle spacing.")
        .assumes("Reference area of impact pressure, edge of the square");
    s.key("deposited_speed_mps", "m/s", &OutputSpec::deposited_speed, above_to(0, 100),
          "Slower debris counts as deposited.");
    s.key("series", "", &OutputSpec::series, anything(),
          fmt::format("Formats in which the run over time is also written: {}.", fmt::join(series_formats, ", ")));
    s.key("series_interval_s", "s", &OutputSpec::series_interval, between(0.001, 1e7),
          "Simulated time between the frames of the run over time.");
    s.optional_key(
        "geoid_height_m", "m", &OutputSpec::geoid_height, between(-200, 200),
        "by the geoid grid of EGM2008 or EGM96 that is installed with PROJ; without one 0, which a note says",
        "Height above the ellipsoid of WGS 84 of where the terrain's heights are 0: 3dtiles are placed on "
        "the globe by it.");
    s.choice("intensity_guideline", &OutputSpec::intensity_guideline,
             {"swiss_debris_flow", "swiss_flood", "garcia_2003"},
             "Whose classes of intensity are mapped from peak depth and peak speed: debris flows or floods after the "
             "Swiss recommendation (BWW, BRP & BUWAL 1997), or debris flows after García et al. (2003).");
    s.key("peak_thickness", "", &OutputSpec::peak_thickness, anything(),
          "Also writes peak_thickness.tif, the peak depth normal to the slope.");
    s.key("contours", "", &OutputSpec::contours, anything(),
          fmt::format("Contours that are also written, of each map \"map=value,value\", in the unit of its file: {}.",
                      fmt::join(contour_maps, ", ")));
    s.key("tracks", "", &OutputSpec::tracks, between(0, 1e6),
          "Particles whose ways are also written, evenly chosen, at outputs.series_interval_s; 0: none.")
        .for_particles_only();
    s.rule([](const OutputSpec& outputs, const SceneSpec&, double) -> std::optional<Violation> {
        if (const auto contours = contours_of(outputs.contours); !contours) {
            return Violation{"contours", ": " + contours.error().message};
        }
        for (const std::string& format : outputs.series) {
            if (std::find(series_formats.begin(), series_formats.end(), format) != series_formats.end()) continue;
            return Violation{"series", fmt::format(": \"{}\" is refused; each must be one of \"{}\"", format,
                                                   fmt::join(series_formats, "\", \""))};
        }
        return {};
    });
    return s.take();
}

Section declare_variant() {
    Declaration<VariantSpec> s("variant",
                               "Values that the scene may be run with in place of its own, such as those of another "
                               "author: --variant NAME takes them, talus run --variants runs all of them and compares.",
                               &SceneSpec::variants);
    s.text("name", &VariantSpec::name, "", "Name on the command line and in the report.").required = true;
    s.key("set", "", &VariantSpec::set, anything(),
          "What it sets, each as on the command line: \"section.key=value\"; \"none\" as the value removes an "
          "optional key.")
        .required = true;
    s.text("notes", &VariantSpec::notes, "none", "What it stands for, printed in the report.");
    s.text("source", &VariantSpec::source, "none", "Where its values come from, printed in the report.");
    s.rule([](const VariantSpec& variant, const SceneSpec& scene, double) -> std::optional<Violation> {
        const auto same = std::count_if(scene.variants.begin(), scene.variants.end(),
                                        [&](const VariantSpec& other) { return other.name == variant.name; });
        if (same == 1) return {};
        return Violation{"name", fmt::format(" = \"{}\" is refused; {} variants have that name", variant.name, same)};
    });
    return s.take();
}

}  // namespace

const std::vector<Section>& scene_sections() {
    static const std::vector<Section> sections = [] {
        std::vector<Section> all = {declare_scene(),         declare_report(),   declare_terrain(),
                                    declare_release(),       declare_inflow(),   declare_bed(),
                                    declare_buildings(),     declare_barrier(),  declare_barrier_opening(),
                                    declare_flow_path(),     declare_material(), declare_zone(),
                                    declare_solver(),        declare_outputs(),  declare_gauge(),
                                    declare_cross_section(), declare_zoom()};
        for (Section& section : declare_observations()) all.push_back(std::move(section));
        all.push_back(declare_variant());
        all.push_back(declare_trigger());
        all.push_back(declare_alarm());
        all.push_back(declare_option());
        all.push_back(declare_risk());
        all.push_back(declare_risk_scenario());
        all.push_back(declare_exposure());
        return all;
    }();
    return sections;
}

const std::vector<Section>& live_sections() {
    static const std::vector<Section> sections = [] {
        std::vector<Section> all = scene_sections();
        const auto inflow = std::find_if(all.begin(), all.end(), [](const Section& s) { return s.name == "inflow"; });
        all.insert(inflow + 1, declare_hydrograph());
        return all;
    }();
    return sections;
}

const Section& live_section(std::string_view name) {
    const std::vector<Section>& all = live_sections();
    return *std::find_if(all.begin(), all.end(), [&](const Section& section) { return section.name == name; });
}

const Parameter& parameter_of(std::string_view section, std::string_view key) {
    return *live_section(section).find(key);
}

}  // namespace talus::params
