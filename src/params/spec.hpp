#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "params/alert_spec.hpp"
#include "params/material_spec.hpp"
#include "params/observation_spec.hpp"
#include "params/risk_spec.hpp"

/// The content of a scene file, in SI units and radians. Plain data: the field table (fields.hpp) declares key, unit,
/// default, range and help of every member once, and parser, --help, documentation and manifest are made from it.
namespace talus::params {

/// `[scene]`: what the run is about.
struct SceneInfo {
    std::string title;
    std::string description;
    bool reconstruction = false;           ///< the inputs are reconstructed, not surveyed: stated on every product
    std::vector<std::string> assumptions;  ///< one sentence each, printed in the report
    std::vector<std::string> sources;      ///< sources of facts and data, printed in the report
    std::string option;                    ///< whose measures are in force; empty: those of no option
};

/// `[report]`: what a report says of itself to be signed. Empty: not said.
struct ReportSpec {
    std::string client, author, checker, revision, reference;
    std::string date;  ///< "2026-11-23"
    std::string limits_of_use;
};

/// `[terrain]`
/// Where the terrain's coordinate reference system comes from: its file, or it has metres of its own.
enum class CrsChoice { file, local };

struct TerrainSpec {
    std::string file;
    CrsChoice crs = CrsChoice::file;
    int band = 1;
    std::optional<Extent> extent;  ///< the part to use, in the terrain's CRS; absent: all of it
    std::string obtain;            ///< where to obtain the file, stated when it is missing
    std::string deposit;           ///< raster of depths that lie on the terrain, m: an earlier surge's
    std::string erosion;           ///< raster of depths that the terrain has lost, m
    std::string orthophoto;        ///< a picture of the ground from above, for display only; empty: none
};

/// Law of erosion by debris. Both laws work per cell of the terrain.
enum class EntrainmentLaw {
    growth,  ///< growth by `growth_rate` of its volume per metre of travel (McDougall & Hungr 2005)
    shear,   ///< at `erosion_rate`, down to a depth proportional to the shear stress above a critical one (Frank et al.
             ///< 2015)
};

/// How the thickness of a release is measured.
enum class ThicknessDirection { normal, vertical };

/// A row of the pore pressure that rising water gives a release; linear between rows.
struct PressureSample {
    double time = 0;   ///< s
    double ratio = 0;  ///< r_u
    bool operator==(const PressureSample&) const = default;
};

/// `[[release]]`: exactly one of thickness, thickness_attribute, thickness_raster, volume.
struct ReleaseSpec {
    std::string name;
    std::string file;  ///< polygons; may be empty where thickness_raster is given
    std::string layer;
    std::optional<double> thickness;  ///< normal to the slope, m
    std::string thickness_attribute;
    std::string thickness_raster;
    ThicknessDirection thickness_direction = ThicknessDirection::normal;
    std::optional<double> volume;               ///< m3, spread as a uniform thickness
    double start_time = 0;                      ///< s
    double shift_along = 0, shift_across = 0;   ///< m in plan, downslope, and to the left of that direction
    std::optional<double> pore_pressure_ratio;  ///< r_u; absent: that of the material
    std::string pore_pressure_hydrograph;       ///< CSV of r_u over time, until it fails; empty: no water rises
    std::optional<double> solid_fraction;       ///< with evolving pore pressure; absent: that of the material
    bool operator==(const ReleaseSpec&) const = default;
};

/// `[[bed]]`: loose material that debris can entrain; exactly one of depth, depth_attribute, depth_raster.
struct BedSpec {
    std::string name;
    std::string file, layer;      ///< polygons; no file: everywhere
    std::optional<double> depth;  ///< m, vertical
    std::string depth_attribute, depth_raster;
    EntrainmentLaw law = EntrainmentLaw::growth;
    std::optional<double> growth_rate;      ///< 1/m; needed by the law of growth
    double critical_shear_stress = 1000;    ///< Pa
    double erosion_rate = 0.013;            ///< m/s
    double erosion_depth_per_shear = 5e-5;  ///< m/Pa
};

/// `[[inflow]]`: exactly one of line, file, polygon, polygon_file.
struct InflowSpec {
    std::string name;
    std::vector<PlanPoint> line;  ///< two places, in the terrain's reference system
    std::string file, layer;
    std::vector<PlanPoint> polygon;  ///< three places or more
    std::string polygon_file;
    std::optional<double> direction;       ///< degrees clockwise from north, of inflow over an area; absent: downhill
    std::string hydrograph;                ///< CSV
    std::optional<double> solid_fraction;  ///< with evolving pore pressure; absent: that of the material
    [[nodiscard]] bool over_area() const { return !polygon.empty() || !polygon_file.empty(); }
    bool operator==(const InflowSpec&) const = default;
};

/// A row of a hydrograph; between rows all change linearly.
struct InflowSample {
    double time = 0;                  ///< s
    double discharge = 0;             ///< m3/s of bulk debris at its own density
    double velocity = 0;              ///< m/s, along the ground
    double density = 0;               ///< kg/m3; 0 in every row: that of the material
    double pore_pressure_ratio = -1;  ///< r_u, of a zoom; negative in every row: that of the material
    bool operator==(const InflowSample&) const = default;
};

/// Properties of a single building; [buildings] sets them where the data do not.
struct BuildingSpec {
    double height = 6;  ///< m above the mean ground of the footprint
    bool operator==(const BuildingSpec&) const = default;
};

/// `[buildings]`: no file means no buildings.
struct BuildingsSpec : BuildingSpec {
    std::string file;
    std::string layer;
    std::string height_attribute;
    std::string name_attribute;
    std::string resistance_attribute;
    std::optional<double> resistance;  ///< Pa; absent: they never fail
};

/// `[[barrier_opening]]`: a slot or a spillway.
struct BarrierOpeningSpec {
    double position = 0;    ///< m along the barrier's line, of the middle
    double width = 0;       ///< m along the line
    double sill = 0;        ///< m, height of the barrier there, above the ground under the line
    std::string barrier{};  ///< its name
    bool operator==(const BarrierOpeningSpec&) const = default;
};

/// `[[barrier]]`: its line is given either here or in a file, its crest as a height or an elevation. The solver, the
/// live twin and its journals use this form, too.
struct BarrierSpec {
    std::vector<PlanPoint> line{};                ///< in the terrain's reference system
    std::optional<double> height{};               ///< m above the ground under the line
    std::optional<double> crest_elevation{};      ///< m, a level crest
    double thickness = 1;                         ///< m across the line
    std::vector<BarrierOpeningSpec> openings{};   ///< their own section in a scene file
    std::optional<double> passing_share{};        ///< of a net; absent: it has no meshes
    std::optional<double> clearance{};            ///< m, of the gap below it; absent: it stands on the ground
    std::optional<double> resistance_force{};     ///< N/m; absent: it never fails
    std::optional<double> resistance_pressure{};  ///< Pa; the same
    std::string name{};
    std::string file{}, layer{};
    bool operator==(const BarrierSpec&) const = default;
};

/// `[flow_path]`: no file means traced by steepest descent from the release.
struct FlowPathSpec {
    std::string file;
    std::string layer;
    double corridor_width = 60;  ///< m, debris farther than half of it from the line does not count as front
};

enum class KernelChoice {
    wendland_c2,  ///< a single kernel for density and gradient
    cubic_spline,
    spiky,
    poly6_spiky,  ///< Poly6 density, Spiky gradient (Macklin & Mueller 2013)
};

enum class InternalFriction {
    stress,  ///< a deviatoric stress per particle that persists between steps, limited by Drucker & Prager
    pair,    ///< a correction per pair of particles (Macklin et al. 2014)
};

enum class ModelChoice {
    particles,       ///< in three dimensions
    depth_averaged,  ///< depth and velocity per cell of a grid (src/depth)
};

/// What computes the steps of particles.
enum class BackendChoice {
    cpu,        ///< vector registers on all cores
    automatic,  ///< the graphics card where there is one and there are enough particles, else the processor
    cuda,       ///< the graphics card
    host,       ///< the card's code as plain loops on the processor: slow, for tests
};

/// `[solver]`: an absent optional is chosen by the program and reported.
struct SolverSpec {
    // At most one of the three; none: usual_particle_count.
    std::optional<double> particle_spacing;    ///< m
    std::optional<double> target_layers;       ///< of particles over the thickness of the thinnest release
    std::optional<int> target_particle_count;  ///< of the volume of releases and inflows
    static constexpr int usual_particle_count = 10000;
    int particle_limit = 2000000;
    std::optional<double> time_step;  ///< s, fixed; absent: adaptive, see displacement_limit
    double displacement_limit = 0.5;  ///< maximum displacement of a particle in an adaptive step, in spacings
    std::optional<double> largest_time_step = {};  ///< s, upper bound of the adaptive step; see largest_time_step()
    double smallest_time_step = 1.0 / 3840;        ///< s, an adaptive step below it stops the run as a fault
    int iteration_count = 4;
    int extra_iteration_count = 12;  ///< maximum extra iterations of a step while debris is overcompressed
    KernelChoice kernel = KernelChoice::wendland_c2;
    InternalFriction internal_friction = InternalFriction::stress;
    double support_ratio = 2.2;          ///< support radius / particle spacing
    double under_relaxation = 1.25;      ///< of the Jacobi iteration, relative to its largest eigenvalue
    double constraint_relaxation = 0.1;  ///< XPBD-like term in the denominator of lambda, relative to its rest value
    double depenetration_speed = 0.5;    ///< m/s, maximum speed at which pair friction removes compression
    double end_time = 120;               ///< s
    double stop_moving_share = 0.001;    ///< the run ends when a smaller share of the debris is moving; 0: never
    double stop_energy_share = 0;        ///< or its kinetic energy is below this share of its peak; 0: never
    double stop_momentum_share = 0;      ///< or its momentum; 0: never
    double stop_duration = 3;            ///< s, for this duration
    double rest_duration = 0.5;          ///< s, debris that has hardly moved for this long falls asleep; 0: never
    double compression_limit = 0.5;      ///< mean of max(0, density/rest density - 1) above which the run is a fault
    int thread_count = 0;                ///< 0: all cores
    BackendChoice backend = BackendChoice::cpu;
    ModelChoice model = ModelChoice::particles;
    std::optional<double> grid_cell = {};  ///< m, of the depth-averaged model
    bool flight = false;                   ///< depth-averaged debris leaves the ground, flies and lands
};

/// Whose intensity classes are mapped; the tables are in report/intensity.cpp.
enum class GuidelineChoice { swiss_debris_flow, swiss_flood, garcia_2003 };

/// Formats of the run over time.
inline constexpr std::array series_formats = {"netcdf", "geotiff", "paraview", "gltf", "3dtiles", "usd"};

/// `[outputs]`
struct OutputSpec {
    std::optional<double> map_cell;      ///< m; absent: a whole fraction of the terrain's cell, near 2.5 spacings
    double sample_interval = 0.1;        ///< s, rows of timeseries.csv
    double chainage_interval = 1;        ///< m, rows of front.csv
    double front_velocity_window = 10;   ///< m of chainage over which d(chainage)/dt is fitted
    double arrival_depth = 0.1;          ///< m, debris has arrived in a map cell above this depth
    double impact_filter_window = 0.2;   ///< s, averaging window of force and pressure on buildings
    double impact_patch_edge = 1;        ///< m, of the squares of a wall over which impact pressure is averaged
    double deposited_speed = 0.1;        ///< m/s, slower debris counts as deposited
    std::vector<std::string> series;     ///< formats in which the run over time is written, of series_formats
    double series_interval = 1;          ///< s between its frames
    std::optional<double> geoid_height;  ///< m, of the zero of the terrain's heights above the ellipsoid of WGS 84
    GuidelineChoice intensity_guideline = GuidelineChoice::swiss_debris_flow;
    std::vector<std::string> contours;  ///< "map=value,value": of these maps as lines, see contours_of()
    int tracks = 0;                     ///< particles whose ways are written
    bool peak_thickness = false;        ///< also a map of the peak thickness normal to the slope
};

/// `[[gauge]]`: a place where depth and speed are recorded over time; at a place, or at a chainage.
struct GaugeSpec {
    std::string name;
    std::optional<double> x = {}, y = {};  ///< m, in the terrain's reference system
    std::optional<double> chainage = {};   ///< m along the flow path
};

/// `[[cross_section]]`: a line across which discharge is recorded over time; its places, or a file.
struct CrossSectionSpec {
    std::string name;
    std::vector<PlanPoint> line;  ///< two places or more, in the terrain's reference system
    std::string file, layer;
    double interval = 1;  ///< s, over which discharge is averaged
};

/// `[zoom]`: the depth-averaged model runs the event, particles what crosses the boundary of an area. No area: no zoom.
struct ZoomSpec {
    std::string structure;           ///< name of a building or barrier
    double margin = 15;              ///< m, from it to the boundary
    std::vector<PlanPoint> polygon;  ///< three places or more
    std::string polygon_file, layer;
    // At most one of the two; none: as in `[solver]`.
    std::optional<double> particle_spacing = {};  ///< m
    std::optional<double> target_layers = {};     ///< over the thickness of what crosses the boundary
    double surroundings = 5;                      ///< m beyond the boundary, after which particles are removed
    [[nodiscard]] bool wanted() const { return !structure.empty() || !polygon.empty() || !polygon_file.empty(); }
};

/// `[[variant]]`: values that the scene may be run with in place of its own.
struct VariantSpec {
    std::string name;
    std::vector<std::string> set;  ///< "section.key=value"
    std::string notes;
    std::string source;
};

struct SceneSpec {
    SceneInfo scene;
    ReportSpec report;
    TerrainSpec terrain;
    std::vector<ReleaseSpec> releases;
    std::vector<BedSpec> beds;
    std::vector<InflowSpec> inflows;
    std::vector<InflowSample>
        hydrograph;  ///< of one inflow while it is read; a file of its own, no section of the scene's
    BuildingsSpec buildings;
    std::vector<BarrierSpec> barriers;
    std::vector<BarrierOpeningSpec> barrier_openings;
    FlowPathSpec flow_path;
    MaterialSpec material;
    std::vector<ZoneSpec> zones;
    SolverSpec solver;
    OutputSpec outputs;
    std::vector<GaugeSpec> gauges;
    std::vector<CrossSectionSpec> cross_sections;
    ZoomSpec zoom;
    std::vector<ObservationSpec> observations;
    std::vector<SuperelevationSpec> superelevations;
    std::vector<ArrivalSpec> arrivals;
    std::vector<RunUpSpec> run_ups;
    std::vector<DepositDepthSpec> deposit_depths;
    std::vector<DamageSpec> damages;
    std::vector<ObservedRunOutSpec> observed_run_outs;
    std::vector<OutlineSpec> deposit_outlines, affected_areas;
    std::vector<ElevationChangeSpec> elevation_changes;
    std::vector<VariantSpec> variants;
    std::vector<TriggerSpec> triggers;
    std::vector<AlarmSpec> alarms;
    std::vector<OptionSpec> options;
    RiskSpec risk;
    std::vector<RiskScenarioSpec> risk_scenarios;
    std::vector<ExposureSpec> exposures;
};

}  // namespace talus::params
