#include "params/fields.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "params/declaration.hpp"

namespace talus {
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
    return s.take();
}

Section declare_terrain() {
    Declaration<TerrainSpec> s("terrain",
                               "The ground, as a raster of elevations in a projected metric reference system.",
                               &SceneSpec::terrain);
    s.path("file", &TerrainSpec::file, "", "Any raster that GDAL reads; its reference system is that of the whole run.")
        .required = true;
    s.key("band", "", &TerrainSpec::band, between(1, 65535), "The raster's band that holds elevations.");
    s.optional_key("extent_m", "m", &TerrainSpec::extent, anything(), "the whole raster",
                   "The part of the terrain to use, in its own coordinates.");
    s.text("obtain", &TerrainSpec::obtain, "nothing is said", "Where the file is to be had, told to whoever lacks it.");
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

Section declare_release() {
    Declaration<ReleaseSpec> s("release",
                               "A body of debris that starts to move at one moment; a scene needs one, or an inflow.",
                               &SceneSpec::releases);
    s.text("name", &ReleaseSpec::name, "\"release N\"", "Name in reports and messages.");
    s.path("file", &ReleaseSpec::file, "", "Polygons of the release area: GeoJSON, GeoPackage, Shapefile.").required =
        true;
    s.text("layer", &ReleaseSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("thickness_m", "m", &ReleaseSpec::thickness, above_to(0, 1000), "one of the other three is given",
                   "Uniform thickness, normal to the slope.")
        .live_in({.label = "Thickness", .slider_low = 0.1, .slider_high = 10, .first = 1.5});
    s.text("thickness_attribute", &ReleaseSpec::thickness_attribute, "one of the other three is given",
           "Attribute of the polygons that holds their thickness normal to the slope in metres.");
    s.path("thickness_raster", &ReleaseSpec::thickness_raster, "one of the other three is given",
           "Raster of thickness normal to the slope in metres, in the terrain's reference system.");
    s.optional_key("volume_m3", "m3", &ReleaseSpec::volume, above(0), "one of the other three is given",
                   "Volume to release, spread as a uniform thickness over the polygons.");
    s.key("start_time_s", "s", &ReleaseSpec::start_time, at_least(0),
          "When the body starts to move; until then it is held in place.");
    s.optional_key("pore_pressure_ratio", "", &ReleaseSpec::pore_pressure_ratio, between(0, 1), "that of the material",
                   "Pore-pressure ratio r_u of this body when it starts.");
    s.exactly_one_of({"thickness_m", "thickness_attribute", "thickness_raster", "volume_m3"}, "file");
    s.rule([](const ReleaseSpec& release, const SceneSpec& scene, double) -> std::optional<Violation> {
        if (release.start_time < scene.solver.end_time) return {};
        return Violation{"start_time_s", fmt::format(" = {} is refused; it must be below solver.end_time_s = {}",
                                                     release.start_time, scene.solver.end_time)};
    });
    s.rule([](const ReleaseSpec& release, const SceneSpec& scene, double) {
        return needs_stress("pore_pressure_ratio", release.pore_pressure_ratio.value_or(0) > 0, scene);
    });
    return s.take();
}

Section declare_bed() {
    Declaration<BedSpec> s("bed", "Loose material on the ground that debris picks up where it moves over it.",
                           &SceneSpec::beds);
    s.text("name", &BedSpec::name, "\"bed N\"", "Name in reports and messages.");
    s.path("file", &BedSpec::file, "it lies everywhere", "Polygons of the bed: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &BedSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("depth_m", "m", &BedSpec::depth, above_to(0, 100), "one of the other two is given",
                   "Uniform depth of the bed, vertical; debris picks up no more.")
        .live_in({.label = "Depth", .slider_low = 0.1, .slider_high = 5.1, .first = 1});
    s.text("depth_attribute", &BedSpec::depth_attribute, "one of the other two is given",
           "Attribute of the polygons that holds their depth in metres.");
    s.path("depth_raster", &BedSpec::depth_raster, "one of the other two is given",
           "Raster of depth in metres, in the terrain's reference system.");
    s.choice("law", &BedSpec::law, {"growth", "shear"},
             "How debris picks it up: growth adds a share of its volume per metre that it moves (McDougall & Hungr "
             "2005); shear goes by the shear stress on the bed (Frank et al. 2015).")
        .live_as();
    s.optional_key("growth_rate_per_m", "1/m", &BedSpec::growth_rate, above_to(0, 1),
                   "law = \"growth\" needs it, and law = \"shear\" does not have it",
                   "Share of its volume that debris picks up per metre: ln(volume after / volume before) over the "
                   "length of the bed.")
        .live_in({.label = "Growth rate", .slider_low = 0.0005, .slider_high = 0.0505, .first = 0.005});
    s.key("critical_shear_stress_Pa", "Pa", &BedSpec::critical_shear_stress, at_least(0),
          "With law = \"shear\": less shear stress, rest density x gravity x depth x sine of the slope, picks up "
          "nothing.")
        .live_in({.label = "Critical shear stress", .slider_low = 0, .slider_high = 5, .first = 1});
    s.key("erosion_rate_mps", "m/s", &BedSpec::erosion_rate, above_to(0, 10),
          "With law = \"shear\": how fast the bed is lowered.")
        .live_in({.label = "Erosion rate", .slider_low = 0.001, .slider_high = 0.101, .first = 0.025});
    s.key("erosion_depth_mpPa", "m/Pa", &BedSpec::erosion_depth_per_shear, above_to(0, 1),
          "With law = \"shear\": how deep at most, per shear stress above the critical one.")
        .live_in({.label = "Erosion depth", .slider_low = 0.01, .slider_high = 1.01, .first = 0.1});
    s.exactly_one_of({"depth_m", "depth_attribute", "depth_raster"});
    s.rule([](const BedSpec& bed, const SceneSpec&, double) -> std::optional<Violation> {
        if (bed.depth_attribute.empty() || !bed.file.empty()) return {};
        return Violation{"depth_attribute", ": needs the polygons that have it; give file"};
    });
    s.rule([](const BedSpec& bed, const SceneSpec&, double) -> std::optional<Violation> {
        if (bed.law != EntrainmentLaw::growth || bed.growth_rate) return {};
        return Violation{
            "growth_rate_per_m",
            ": missing; law = \"growth\" needs it: ln(volume after / volume before) over the length of the "
            "bed, above 0 to 1 (1/m)"};
    });
    return s.take();
}

Section declare_inflow() {
    Declaration<InflowSpec> s("inflow",
                              "Debris that comes in while the run goes on, any number of them: across a straight line, "
                              "at right angles to it and towards its right, or all over an area, such as a slope "
                              "that rain wears down.",
                              &SceneSpec::inflows);
    s.text("name", &InflowSpec::name, "\"inflow N\"", "Name in reports and messages.");
    s.key(
        "line_m", "m", &InflowSpec::line, anything(),
        "The two ends of the line in plan, in the terrain's reference system: first the one on the right-hand side of "
        "the debris that comes.");
    s.path("file", &InflowSpec::file, "another one is given", "The line in a file: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &InflowSpec::layer, "the only layer", "Layer of file or polygon_file.");
    s.key("polygon_m", "m", &InflowSpec::polygon, anything(),
          "The corners of the area in plan, in the terrain's reference system.");
    s.path("polygon_file", &InflowSpec::polygon_file, "another one is given",
           "The area in a file, one polygon or more: GeoJSON, GeoPackage, Shapefile.");
    s.optional_key("direction_deg", "deg", &InflowSpec::direction, from_to_below(0, 360), "down the slope",
                   "Over an area: where the debris moves as it comes in, clockwise from north.")
        .live_in({.label = "Clockwise from north",
                  .slider_low = 0,
                  .slider_high = 359,
                  .tick = "Set direction",
                  .tick_help = "Where debris moves as it comes in; unticked: downhill"});
    s.path("hydrograph", &InflowSpec::hydrograph, "",
           "CSV with the columns time_s, discharge_m3ps (bulk debris), velocity_mps and, if its density changes, "
           "density_kgpm3; linear between rows, nothing before the first and after the last. Several surges are rows "
           "without discharge between them.")
        .required = true;
    s.exactly_one_of({"line_m", "file", "polygon_m", "polygon_file"});
    s.rule([](const InflowSpec& inflow, const SceneSpec&, double) -> std::optional<Violation> {
        if (!inflow.direction || !inflow.polygon.empty() || !inflow.polygon_file.empty()) return {};
        return Violation{"direction_deg", ": is refused across a line, which has a direction of its own"};
    });
    return s.take();
}

Section declare_buildings() {
    Declaration<BuildingsSpec> s("buildings", "Solid obstacles with vertical walls and flat roofs.",
                                 &SceneSpec::buildings);
    s.path(
        "file", &BuildingsSpec::file, "no buildings",
        "Footprint polygons (GeoJSON, GeoPackage, Shapefile), or a mesh in the terrain's reference system: CityJSON "
        "(.city.json, .cityjson) and Wavefront OBJ (.obj), z upward, or glTF 2.0 (.gltf, .glb), x east, y upward, -z "
        "north; the translation of a node may bring it to its place.");
    s.text("layer", &BuildingsSpec::layer, "the only layer", "Layer of the file.");
    s.text("height_attribute", &BuildingsSpec::height_attribute, "every building has the default height",
           "Attribute that holds a building's height above the mean ground of its footprint in metres.");
    s.text("name_attribute", &BuildingsSpec::name_attribute, "\"building N\"",
           "Attribute that holds a building's name.");
    s.key("default_height_m", "m", &BuildingsSpec::default_height, above_to(0, 1000),
          "Height above the ground where the attribute is absent, empty or not above zero; counted as assumed.")
        .live_in({.label = "Height", .slider_low = 0.5, .slider_high = 40, .first = 6}, "height_m");
    s.text("resistance_attribute", &BuildingsSpec::resistance_attribute, "every building has resistance_Pa",
           "Attribute that holds the pressure in Pa that a building stands.");
    s.optional_key("resistance_Pa", "Pa", &BuildingsSpec::resistance, above(0), "buildings stand whatever happens",
                   "Filtered pressure above which a building is destroyed: it is gone from then on.");
    return s.take();
}

Section declare_barrier() {
    Declaration<BarrierSpec> s("barrier", "A wall, a dam or a net along a line; any number.", &SceneSpec::barriers);
    s.text("name", &BarrierSpec::name, "\"barrier N\"", "Name in reports and messages.");
    s.key("line_m", "m", &BarrierSpec::line, anything(),
          "Its line in plan, in the terrain's reference system; at least two places.");
    s.path("file", &BarrierSpec::file, "line_m is given", "Its line in a file: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &BarrierSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("height_m", "m", &BarrierSpec::height, above_to(0, 200), "crest_elevation_m is given",
                   "Height above the ground under the line: the crest follows the ground.")
        .live_in({.label = "Height", .slider_low = 0.5, .slider_high = 15, .first = 3});
    s.optional_key("crest_elevation_m", "m", &BarrierSpec::crest_elevation, anything(), "height_m is given",
                   "Elevation of a level crest.")
        .live_as();
    s.key("thickness_m", "m", &BarrierSpec::thickness, above_to(0, 100),
          "Thickness across the line; at least half a particle spacing.")
        .live_in({.label = "Thickness", .slider_low = 0.1, .slider_high = 5, .first = 1});
    s.optional_key("passing_share", "", &BarrierSpec::passing_share, from_to_below(0, 1), "it is a wall",
                   "Makes it a net: the share of the debris, by volume, in grains that pass its meshes (the percentage "
                   "passing at the size of the opening, over 100). The others are held as by a wall.")
        .live_in({.label = "Passes the meshes",
                  .slider_low = 0,
                  .slider_high = 95,
                  .first = 50,
                  .tick = "Net",
                  .tick_help = "Lets the finer share of the debris through its meshes and holds the rest",
                  .unit = "%",
                  .factor = 100});
    s.optional_key("clearance_m", "m", &BarrierSpec::clearance, above_to(0, 100), "it reaches the ground",
                   "Height above the ground of the gap below it, as nets hang across a torrent: debris passes freely "
                   "there; at least one particle spacing, or nothing gets through.")
        .live_in({.label = "Clearance",
                  .slider_low = 0.1,
                  .slider_high = 3,
                  .first = 0.5,
                  .tick = "Gap below",
                  .tick_help = "It hangs above the ground: debris passes below it"});
    s.optional_key("resistance_Npm", "N/m", &BarrierSpec::resistance_force, above(0), "it stands whatever happens",
                   "Filtered force per metre of the line above which it is destroyed: it is gone from then on.")
        .live_in({.label = "Resistance",
                  .slider_low = 10,
                  .slider_high = 1000,
                  .first = 200,
                  .tick = "Fails under load",
                  .tick_help = "Beyond this mean force on its line it is gone"});
    s.optional_key("resistance_Pa", "Pa", &BarrierSpec::resistance_pressure, above(0), "it stands whatever happens",
                   "Filtered pressure above which it is destroyed.")
        .live_as();
    s.exactly_one_of({"line_m", "file"});
    s.exactly_one_of({"height_m", "crest_elevation_m"});
    s.rule([](const BarrierSpec& barrier, const SceneSpec&, double spacing) -> std::optional<Violation> {
        if (!barrier.clearance) return {};
        const double gap = *barrier.clearance;
        if (gap < spacing) {
            return Violation{"clearance_m",
                             fmt::format(" = {:.6g} is refused; with particles of {:.3g} m it must be at least that: "
                                         "nothing would get through a lower gap; smaller particles allow less",
                                         gap, spacing)};
        }
        if (gap < barrier.height.value_or(gap + 1)) return {};
        return Violation{"clearance_m",
                         fmt::format(" = {:.6g} is refused; it must be below height_m = {:.6g}", gap, *barrier.height)};
    });
    s.rule([](const BarrierSpec& barrier, const SceneSpec&, double spacing) -> std::optional<Violation> {
        if (barrier.thickness >= spacing / 2) return {};
        return Violation{"thickness_m",
                         fmt::format(" = {:.6g} is refused; with particles of {:.3g} m it must be at least {:.4g} m: "
                                     "debris on both sides would feel each other through it",
                                     barrier.thickness, spacing, std::ceil(500 * spacing) / 1000)};
    });
    return s.take();
}

Section declare_barrier_opening() {
    Declaration<BarrierOpeningSpec> s("barrier_opening",
                                      "A slot or a spillway in a barrier, as check dams have; any number.",
                                      &SceneSpec::barrier_openings);
    s.text("barrier", &BarrierOpeningSpec::barrier, "", "Name of the barrier.").required = true;
    s.key("position_m", "m", &BarrierOpeningSpec::position, at_least(0),
          "Distance of its middle along the barrier's line from its first place.")
        .live_as()
        .required = true;
    s.key("width_m", "m", &BarrierOpeningSpec::width, above(0),
          "Width along the line; at least two particle spacings, or nothing gets through.")
        .live_as()
        .required = true;
    s.key("sill_height_m", "m", &BarrierOpeningSpec::sill, at_least(0),
          "How much of the barrier stands there, above the ground; 0: open to the ground.")
        .live_as();
    s.rule([](const BarrierOpeningSpec& opening, const SceneSpec&, double spacing) -> std::optional<Violation> {
        if (opening.width >= 2 * spacing) return {};
        return Violation{"width_m",
                         fmt::format(" = {:.6g} is refused; with particles of {:.3g} m it must be at least {:.4g} m: "
                                     "nothing would get through a narrower one; smaller particles allow less",
                                     opening.width, spacing, std::ceil(2000 * spacing) / 1000)};
    });
    return s.take();
}

Section declare_flow_path() {
    Declaration<FlowPathSpec> s("flow_path", "The line along which chainage is measured.", &SceneSpec::flow_path);
    s.path("file", &FlowPathSpec::file, "traced downhill from the release",
           "A line from the crown downstream: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &FlowPathSpec::layer, "the only layer", "Layer of the file.");
    s.key("corridor_width_m", "m", &FlowPathSpec::corridor_width, above(0),
          "Debris farther than half of this from the line does not count as front.");
    return s.take();
}

Section declare_solver() {
    Declaration<SolverSpec> s("solver", "How it is computed.", &SceneSpec::solver);
    s.optional_key("particle_spacing_m", "m", &SolverSpec::particle_spacing, above(0),
                   "from target_particle_count and the released volume",
                   "Edge of the cube of debris that a particle stands for.");
    s.key("target_particle_count", "", &SolverSpec::target_particle_count, between(1, 1e9),
          "Particles to aim for where particle_spacing_m is not given.");
    s.key("particle_limit", "", &SolverSpec::particle_limit, between(1, 1e9),
          "More particles than this are refused before the run.");
    s.optional_key("time_step_s", "s", &SolverSpec::time_step, above_to(0, 1),
                   "adaptive: a particle moves at most displacement_limit of a spacing per step", "Fixed time step.");
    s.key("displacement_limit", "", &SolverSpec::displacement_limit, above_to(0, 1),
          "Share of a spacing that a particle moves at most in an adaptive time step.");
    s.key("largest_time_step_s", "s", &SolverSpec::largest_time_step, above_to(0, 1),
          "Upper bound of the adaptive time step.");
    s.key("smallest_time_step_s", "s", &SolverSpec::smallest_time_step, above_to(0, 1),
          "An adaptive time step below this stops the run as a fault.");
    s.key("iteration_count", "", &SolverSpec::iteration_count, between(1, 1000), "Solver iterations per time step.");
    s.choice("kernel", &SolverSpec::kernel, {"wendland_c2", "cubic_spline", "spiky", "poly6_spiky"},
             "Smoothing kernel; poly6_spiky is the pair of Macklin & Mueller (2013): Poly6 for the density, Spiky for "
             "its gradient.");
    s.choice(
        "internal_friction", &SolverSpec::internal_friction, {"stress", "pair"},
        "How debris rubs on debris: stress keeps a shear stress per particle between steps, so that a deposit stands; "
        "pair is a correction per pair of particles (Macklin et al. 2014), which creeps.");
    s.key("support_ratio", "", &SolverSpec::support_ratio, between(1.5, 4),
          "Support radius of the kernel over the particle spacing.");
    s.key(
        "under_relaxation", "", &SolverSpec::under_relaxation, above_to(0, 2),
        "Factor on every correction of the Jacobi iteration, relative to its largest eigenvalue: above 2 it diverges.");
    s.key("constraint_relaxation", "", &SolverSpec::constraint_relaxation, at_least(0),
          "Softens the density constraint: term in the multiplier's denominator relative to its rest value.");
    s.key("depenetration_speed_mps", "m/s", &SolverSpec::depenetration_speed, above(0),
          "With internal_friction = \"pair\": the fastest that compression at the start of a step is undone.");
    s.key("end_time_s", "s", &SolverSpec::end_time, above(0), "Simulated time at which the run ends at the latest.");
    s.key("stop_momentum_fraction", "", &SolverSpec::stop_momentum_fraction, from_to_below(0, 1),
          "Ends the run when momentum stays below this share of its peak; 0 never does.");
    s.key("stop_duration_s", "s", &SolverSpec::stop_duration, at_least(0),
          "For how long momentum must stay below that share.");
    s.key(
        "rest_duration_s", "s", &SolverSpec::rest_duration, at_least(0),
        "Debris that has hardly moved (a hundredth of a particle's free-fall speed) for so long is at rest: it presses "
        "as before and costs little until something moves beside it. 0 keeps everything moving.");
    s.key("compression_limit", "", &SolverSpec::compression_limit, above(0),
          "Mean over-density (density over rest density, less 1) above which the run stops as a fault.");
    s.key("thread_count", "", &SolverSpec::thread_count, between(0, 4096),
          "Threads to compute with; 0 takes all cores. Results do not depend on it.");
    s.rule([](const SolverSpec& solver, const SceneSpec&, double) -> std::optional<Violation> {
        const double small = solver.smallest_time_step, large = solver.largest_time_step;
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
    s.optional_key("map_cell_m", "m", &OutputSpec::map_cell, above(0),
                   "a whole fraction or multiple of the terrain's cell near 2.5 particle spacings",
                   "Cell of the hazard maps.");
    s.key("sample_interval_s", "s", &OutputSpec::sample_interval, above(0),
          "Simulated time between rows of timeseries.csv.");
    s.key("chainage_interval_m", "m", &OutputSpec::chainage_interval, above(0), "Chainage between rows of front.csv.");
    s.key("front_velocity_window_m", "m", &OutputSpec::front_velocity_window, above(0),
          "Chainage over which front velocity is fitted to the arrival times.");
    s.key("arrival_depth_m", "m", &OutputSpec::arrival_depth, at_least(0),
          "Debris has arrived in a map cell once it is deeper than this.");
    s.key("impact_filter_window_s", "s", &OutputSpec::impact_filter_window, above(0),
          "Averaging window of force and pressure on buildings.");
    s.key("deposited_speed_mps", "m/s", &OutputSpec::deposited_speed, above(0), "Slower debris counts as deposited.");
    s.key("particle_series_interval_s", "s", &OutputSpec::particle_series_interval, at_least(0),
          "Simulated time between particle frames for ParaView; 0 writes none.");
    return s.take();
}

}  // namespace

const std::vector<Section>& scene_sections() {
    static const std::vector<Section> sections = [] {
        std::vector<Section> all = {
            declare_scene(),     declare_terrain(), declare_release(),         declare_inflow(),    declare_bed(),
            declare_buildings(), declare_barrier(), declare_barrier_opening(), declare_flow_path(), declare_material(),
            declare_zone(),      declare_solver(),  declare_outputs()};
        for (Section& section : declare_observations()) all.push_back(std::move(section));
        return all;
    }();
    return sections;
}

const Section* find_section(std::string_view name) {
    for (const Section& section : scene_sections()) {
        if (section.name == name) return &section;
    }
    return nullptr;
}

const Parameter* Section::find(std::string_view key) const {
    for (const Parameter& parameter : parameters) {
        if (parameter.key == key) return &parameter;
    }
    return nullptr;
}

ParameterValue default_value(const Section& section, const Parameter& parameter) {
    if (parameter.required) return {};
    SceneSpec spec;
    if (section.repeats) section.append(spec);
    return parameter.get(spec, 0);
}

bool is_given(const ParameterValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return !text->empty();
    if (const auto* points = std::get_if<std::vector<PlanPoint>>(&value)) return !points->empty();
    return !std::holds_alternative<std::monostate>(value);
}

std::optional<Violation> wrong_choice(const Section& section, const SceneSpec& spec, std::size_t index,
                                      bool live_only) {
    for (const Alternatives& choice : section.alternatives) {
        std::vector<std::string> given;
        bool all_live = true;
        for (const std::string& key : choice.keys) {
            const Parameter& parameter = *section.find(key);
            all_live = all_live && !parameter.live.empty();
            if (is_given(parameter.get(spec, index))) given.push_back(key);
        }
        if (given.size() == 1 || (live_only && !all_live)) continue;
        return Violation{
            given.empty() ? choice.blamed : given.back(),
            fmt::format(": exactly one of {} must be given; {}", fmt::join(choice.keys, ", "),
                        given.empty() ? "there is none" : fmt::format("given are {}", fmt::join(given, ", ")))};
    }
    return {};
}

std::optional<Violation> broken_rule(const Section& section, const SceneSpec& spec, std::size_t index,
                                     double particle_spacing) {
    for (const Rule& rule : section.rules) {
        if (std::optional<Violation> broken = rule(spec, index, particle_spacing)) return broken;
    }
    return {};
}

std::string key_path(const Section& section, std::size_t index, const Parameter& parameter) {
    return section.name + (section.repeats ? "[" + std::to_string(index) + "]" : "") + "." + parameter.key;
}

void for_each_value(
    const SceneSpec& spec,
    const std::function<void(const Section&, std::size_t, const Parameter&, const ParameterValue&)>& visit) {
    for (const Section& section : scene_sections()) {
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            for (const Parameter& parameter : section.parameters) {
                visit(section, index, parameter, parameter.get(spec, index));
            }
        }
    }
}

}  // namespace talus
