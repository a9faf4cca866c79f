#include "params/fields.hpp"

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
    Declaration<ReleaseSpec> s(
        "release",
        "A body of debris that starts to move at one moment; a scene needs one, or an inflow. Exactly one of "
        "thickness_m, thickness_attribute, thickness_raster and volume_m3 says how much it is.",
        &SceneSpec::releases);
    s.text("name", &ReleaseSpec::name, "\"release N\"", "Name in reports and messages.");
    s.path("file", &ReleaseSpec::file, "", "Polygons of the release area: GeoJSON, GeoPackage, Shapefile.").required =
        true;
    s.text("layer", &ReleaseSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("thickness_m", "m", &ReleaseSpec::thickness, above_to(0, 1000), "one of the other three is given",
                   "Uniform thickness, normal to the slope.");
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
    return s.take();
}

Section declare_bed() {
    Declaration<BedSpec> s("bed",
                           "Loose material on the ground that debris picks up where it moves over it. Exactly one of "
                           "depth_m, depth_attribute and depth_raster says how much there is.",
                           &SceneSpec::beds);
    s.text("name", &BedSpec::name, "\"bed N\"", "Name in reports and messages.");
    s.path("file", &BedSpec::file, "it lies everywhere", "Polygons of the bed: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &BedSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("depth_m", "m", &BedSpec::depth, above_to(0, 100), "one of the other two is given",
                   "Uniform depth of the bed, vertical; debris picks up no more.");
    s.text("depth_attribute", &BedSpec::depth_attribute, "one of the other two is given",
           "Attribute of the polygons that holds their depth in metres.");
    s.path("depth_raster", &BedSpec::depth_raster, "one of the other two is given",
           "Raster of depth in metres, in the terrain's reference system.");
    s.choice("law", &BedSpec::law, {"growth", "shear"},
             "How debris picks it up: growth adds a share of its volume per metre that it moves (McDougall & Hungr "
             "2005); shear goes by the shear stress on the bed (Frank et al. 2015).");
    s.optional_key("growth_rate_per_m", "1/m", &BedSpec::growth_rate, above_to(0, 1),
                   "law = \"growth\" needs it, and law = \"shear\" does not have it",
                   "Share of its volume that debris picks up per metre: ln(volume after / volume before) over the "
                   "length of the bed.");
    s.key("critical_shear_stress_Pa", "Pa", &BedSpec::critical_shear_stress, at_least(0),
          "With law = \"shear\": less shear stress, rest density x gravity x depth x sine of the slope, picks up "
          "nothing.");
    s.key("erosion_rate_mps", "m/s", &BedSpec::erosion_rate, above_to(0, 10),
          "With law = \"shear\": how fast the bed is lowered.");
    s.key("erosion_depth_mpPa", "m/Pa", &BedSpec::erosion_depth_per_shear, above_to(0, 1),
          "With law = \"shear\": how deep at most, per shear stress above the critical one.");
    return s.take();
}

Section declare_inflow() {
    Declaration<InflowSpec> s("inflow",
                              "Debris that comes in while the run goes on, any number of them: across a straight line, "
                              "at right angles to it and towards its right, or all over an area, such as a slope "
                              "that rain wears down. Exactly one of line_m, file, polygon_m and polygon_file says "
                              "where.",
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
                   "Over an area: where the debris moves as it comes in, clockwise from north.");
    s.path("hydrograph", &InflowSpec::hydrograph, "",
           "CSV with the columns time_s, discharge_m3ps (bulk debris), velocity_mps and, if its density changes, "
           "density_kgpm3; linear between rows, nothing before the first and after the last. Several surges are rows "
           "without discharge between them.")
        .required = true;
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
          "Height where the attribute is absent, empty or not above zero; counted as assumed.");
    s.text("resistance_attribute", &BuildingsSpec::resistance_attribute, "every building has resistance_Pa",
           "Attribute that holds the pressure in Pa that a building stands.");
    s.optional_key("resistance_Pa", "Pa", &BuildingsSpec::resistance, above(0), "buildings stand whatever happens",
                   "Filtered pressure above which a building is destroyed: it is gone from then on.");
    return s.take();
}

Section declare_barrier() {
    Declaration<BarrierSpec> s(
        "barrier",
        "A wall, a dam or a net along a line; any number. Exactly one of line_m and file says where, "
        "exactly one of height_m and crest_elevation_m how high.",
        &SceneSpec::barriers);
    s.text("name", &BarrierSpec::name, "\"barrier N\"", "Name in reports and messages.");
    s.key("line_m", "m", &BarrierSpec::line, anything(),
          "Its line in plan, in the terrain's reference system; at least two places.");
    s.path("file", &BarrierSpec::file, "line_m is given", "Its line in a file: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &BarrierSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("height_m", "m", &BarrierSpec::height, above_to(0, 200), "crest_elevation_m is given",
                   "Height above the ground under the line: the crest follows the ground.");
    s.optional_key("crest_elevation_m", "m", &BarrierSpec::crest_elevation, anything(), "height_m is given",
                   "Elevation of a level crest.");
    s.key("thickness_m", "m", &BarrierSpec::thickness, above_to(0, 100),
          "Thickness across the line; at least half a particle spacing.");
    s.optional_key("passing_share", "", &BarrierSpec::passing_share, from_to_below(0, 1), "it is a wall",
                   "Makes it a net: the share of the debris, by volume, in grains that pass its meshes (the percentage "
                   "passing at the size of the opening, over 100). The others are held as by a wall.");
    s.optional_key("resistance_Npm", "N/m", &BarrierSpec::resistance_force, above(0), "it stands whatever happens",
                   "Filtered force per metre of the line above which it is destroyed: it is gone from then on.");
    s.optional_key("resistance_Pa", "Pa", &BarrierSpec::resistance_pressure, above(0), "it stands whatever happens",
                   "Filtered pressure above which it is destroyed.");
    return s.take();
}

Section declare_barrier_opening() {
    Declaration<BarrierOpeningSpec> s("barrier_opening",
                                      "A slot or a spillway in a barrier, as check dams have; any number.",
                                      &SceneSpec::barrier_openings);
    s.text("barrier", &BarrierOpeningSpec::barrier, "", "Name of the barrier.").required = true;
    s.key("position_m", "m", &BarrierOpeningSpec::position, at_least(0),
          "Distance of its middle along the barrier's line from its first place.")
        .required = true;
    s.key("width_m", "m", &BarrierOpeningSpec::width, above(0),
          "Width along the line; at least two particle spacings, or nothing gets through.")
        .required = true;
    s.key("sill_height_m", "m", &BarrierOpeningSpec::sill, at_least(0),
          "How much of the barrier stands there, above the ground; 0: open to the ground.");
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
             "Smoothing kernel; poly6_spiky is the published pair of density kernel and gradient kernel.");
    s.choice(
        "internal_friction", &SolverSpec::internal_friction, {"stress", "pair"},
        "How debris rubs on debris: stress keeps a shear stress per particle between steps, so that a deposit stands; "
        "pair is the published correction per pair of particles, which creeps.");
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
