#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/hazard_maps.hpp"
#include "params/spec.hpp"
#include "terrain/cross_section.hpp"
#include "terrain/flow_path.hpp"
#include "terrain/gauge.hpp"
#include "terrain/terrain.hpp"

/// The measurements of a run: plain results in SI units.
namespace talus::observe {

inline constexpr double never = std::numeric_limits<double>::quiet_NaN();

/// The front at one chainage of the flow path.
struct FrontSample {
    double chainage = 0;            ///< m
    double arrival_time = 0;        ///< s, of the first debris
    double front_velocity = never;  ///< m/s, slope of chainage against arrival time over the window
    double particle_speed = never;  ///< m/s, mean speed of the debris at the front on arrival
};

/// How far debris ran: distances in plan from the crown (highest released debris) to the farthest deposit. Angles in
/// radians.
struct RunOut {
    double front_chainage = never;  ///< m, farthest chainage reached by the front
    double along_flow = never;      ///< m, by the shortest way over the ground that debris covered
    double straight = never;        ///< m, in a straight line
    bool at_least = false;          ///< debris has left the terrain: both distances end at the terrain's edge
    PlanPoint crown{never, never};  ///< highest released debris
    PlanPoint toe{never, never};    ///< farthest deposit along the flow
    double drop = never;            ///< m, from crown to toe
    double runout_angle = never;    ///< atan(drop / distance along the flow): Fahrboeschung
    double travel_angle = never;    ///< the same between the centres of mass of release and deposit
};

/// A structure at one moment.
struct StructureSample {
    double time = 0;               ///< s
    double force = 0;              ///< N, normal to the walls, filtered
    double impact_pressure = 0;    ///< Pa, filtered, of the patch where it is highest
    double depth = 0;              ///< m, of the flow in front of the wall where it is deepest
    double dynamic_pressure = 0;   ///< Pa, density * speed^2 of the flow towards the wall where it is highest
    double impulse = 0;            ///< N s, of all debris so far
    double overtopped_volume = 0;  ///< m3, this and what follows of barriers only
    double passed_volume = 0;      ///< m3, through openings and meshes
    double retained_volume = 0;    ///< m3, behind it, see retained_volume()
    double filling_height = 0;     ///< m, upstream at the face
};

/// What debris did to a structure: a building, or a barrier, which is one along a line.
struct BuildingImpact {
    std::string name;
    bool hit = false;
    double first_hit_time = never;     ///< s
    double peak_force = 0;             ///< N, normal to the walls, filtered
    double peak_impact_pressure = 0;   ///< Pa, filtered force on a patch of the wall over its area, the highest
    double peak_depth = 0;             ///< m, of the flow in front of the walls
    double peak_dynamic_pressure = 0;  ///< Pa, density * speed^2 of the flow in front of a wall towards it
    double peak_speed = 0;             ///< m/s, depth-averaged, of the flow in front of the walls
    double removed_time = never;       ///< s, when it was removed between two steps; NaN: not removed
    double impulse = 0;                ///< N s, normal to the walls, of the whole run
    double failure_time = never;       ///< s, when its resistance was exceeded and it was removed

    bool is_barrier = false;                ///< only then the following values exist; up to its failure
    double passing_share = never;           ///< of a net, through its meshes; NaN: no net
    double overtopped_volume = 0;           ///< m3, over the crest and not back
    double first_overtopping_time = never;  ///< s
    double passed_volume = 0;               ///< m3, through openings and meshes
    double retained_volume = 0;             ///< m3, behind it at the end, see retained_volume()
    double peak_retained_volume = 0;        ///< m3, of the samples
    double peak_filling_height = 0;         ///< m, mean depth along the face where it was deepest, of the samples

    std::vector<StructureSample> history{};  ///< from the first hit on, at the times of the time series

    template <class Archive>
    void keep(Archive& archive) {
        archive(name, hit, first_hit_time, peak_force, peak_impact_pressure, peak_depth, peak_dynamic_pressure,
                peak_speed, removed_time, impulse, failure_time, is_barrier, passing_share, overtopped_volume,
                first_overtopping_time, passed_volume, retained_volume, peak_retained_volume, peak_filling_height,
                history);
    }
};

/// "building", "barrier" or "net".
[[nodiscard]] inline const char* kind_of(const BuildingImpact& impact) {
    return !impact.is_barrier ? "building" : std::isnan(impact.passing_share) ? "barrier" : "net";
}

/// How many structures debris hit, of how many: the buildings, or the barriers.
struct Hits {
    std::size_t hit = 0, all = 0;
};
[[nodiscard]] inline Hits hits_among(const std::vector<BuildingImpact>& impacts, bool barriers) {
    Hits hits;
    for (const BuildingImpact& impact : impacts) {
        if (impact.is_barrier != barriers) continue;
        ++hits.all;
        hits.hit += impact.hit ? 1 : 0;
    }
    return hits;
}

/// A row of the time series. Volumes add up exactly: released + entrained = held + moving + deposited + left.
struct TimeSample {
    double time = 0;
    double volume_released = 0;     ///< m3, until then, less the removed volume
    double volume_entrained = 0;    ///< m3, from the bed
    double front_chainage = never;  ///< m, of the moving front now; NaN: none on the path
    double volume_held = 0;         ///< m3, in releases that have not started; all of them before the first step
    double volume_moving = 0;
    double volume_deposited = 0;
    double volume_left = 0;
    double kinetic_energy = 0;    ///< J
    double potential_energy = 0;  ///< J, above the lowest terrain
    double momentum = 0;          ///< N s, mass times speed of all debris
    double largest_speed = 0;     ///< m/s
    double mean_compression = 0, max_compression = 0, overcompressed_share = 0;
    double time_step = 0;         ///< s
    double steps_per_second = 0;  ///< of wall time
};

/// The flow at a place.
struct FlowAt {
    double depth = 0;  ///< m, vertical
    double speed = 0;  ///< m/s, depth-averaged; 0 where debris is too thin
};

struct GaugeSample {
    double time = 0;   ///< s
    double depth = 0;  ///< m, as in FlowAt
    double speed = 0;  ///< m/s
};

/// What passed a gauge: the flow in the cell of the maps that it lies in.
struct GaugeRecord {
    terrain::Gauge gauge;
    double arrival_time = never;                     ///< s, first time deeper than the arrival depth
    double peak_depth = 0, peak_depth_time = never;  ///< m, s, of all steps
    double peak_speed = 0, peak_speed_time = never;  ///< m/s, s
    std::vector<GaugeSample> rows{};                 ///< at the times of the time series
};

struct DischargeSample {
    double time = 0;       ///< s, end of an interval
    double discharge = 0;  ///< m3/s, mean over it
    double passed = 0;     ///< m3, until then
};

/// What passed a cross-section, from its left to its right less what came back.
struct DischargeRecord {
    terrain::CrossSection section;
    double passed = 0;                             ///< m3
    double peak_discharge = 0, peak_time = never;  ///< m3/s, of the row with the greatest, in either direction; s
    std::vector<DischargeSample> rows{};
};

/// Erosion of the bed by debris.
struct Erosion {
    Grid<float> depth;  ///< m, vertical, on the terrain's cells around what was eroded; NaN: none. Empty: no bed
    double volume = 0;  ///< m3
    /// Along the flow path; empty where there is none, or no bed.
    std::vector<double> chainage;  ///< m
    std::vector<double> upstream;  ///< m3, eroded upstream of that chainage
};

/// Compression of the debris at the last iteration of every step (sim/compression.hpp).
struct Compression {
    double worst_mean = 0, worst_max = 0,
           worst_overcompressed_share = 0;  ///< of all steps: mean and largest over the debris
    double worst_mean_time = never, worst_max_time = never, worst_overcompressed_time = never;  ///< s, when that was
    double time_share_above = 0;  ///< of the simulated time, with the mean or the overcompressed share above its limit
    double mean_iterations = 0;   ///< per step
    double time_share_iterated = 0;  ///< of the simulated time, in which steps took extra iterations

    /// Whether debris was too compressed in no more than a hundredth of the simulated time.
    [[nodiscard]] bool within_limits() const { return time_share_above <= time_share_limit; }
    static constexpr double time_share_limit = 0.01;
};

/// The deposit in two numbers, of the cells in which it is thicker than the arrival depth.
struct Deposit {
    double area = 0;       ///< m2
    double depth = never;  ///< m, vertical, that nine tenths of the area stay below
};

/// Greatest thickness of the flow normal to the slope, m, over the cells that it reached with at least the arrival
/// depth. NaN: none. Divided by the particle spacing it is the largest number of particle layers in the flow.
struct FlowThickness {
    double median = never;
    double thin = never;  ///< a tenth of the cells stay below
    [[nodiscard]] bool known() const { return median > 0; }
    static constexpr double min_layers = 2;  ///< in the median: depths, speeds and forces mean little below
};

/// The energy of the debris against what gravity and inflow gave it. Friction only takes energy, so neither share can
/// be above 1 but for numerical error; with more, speeds, pressures and run-out are wrong.
struct Energy {
    double share = never;          ///< greatest v^2/2g of a cell of the maps over what the fall to it explains
    double speed = never;          ///< m/s, along the ground, in that cell
    double allowed_speed = never;  ///< m/s, the greatest that the fall explains there (energy.hpp)
    double fall = never;           ///< m, to that cell, from the highest energy line with which debris came
    PlanPoint at{never, never};
    std::size_t cells = 0, cells_above = 0;  ///< of the maps with a speed; of these, those above share_limit
    double gained = never;                   ///< greatest energy gained over what the whole fall gives; below 0: lost
    double gained_time = never;              ///< s, when that was

    [[nodiscard]] bool known() const { return share >= 0; }
    [[nodiscard]] bool within_limits() const { return !(share > share_limit) && !(gained > gained_limit); }
    static constexpr double share_limit = 1.1;  ///< a speed 5 % above free fall
    static constexpr double gained_limit = 0.05;
};

struct Observation {
    HazardMaps maps;
    Energy energy;
    FlowThickness thickness;
    Deposit deposit;
    Erosion erosion;
    std::vector<FrontSample> front;  ///< by chainage
    RunOut run_out;
    /// Where debris went, if the scene has no flow path of its own: all chainages are along it. Empty: along the
    /// scene's.
    std::optional<terrain::FlowPath> followed_path;
    std::vector<BuildingImpact> buildings;  ///< as in Ground::buildings
    std::vector<TimeSample> timeseries;
    std::vector<GaugeRecord> gauges;
    std::vector<DischargeRecord> cross_sections;
    double volume_released = 0;  ///< m3, less the removed volume
    Compression compression;
    /// Share of the volume that rounding may gain or lose: depths in single precision do, whole particles do not.
    double volume_rounding = 1e-9;

    /// The last row of the time series.
    [[nodiscard]] TimeSample at_end() const { return timeseries.empty() ? TimeSample{} : timeseries.back(); }
};

[[nodiscard]] Deposit measure_deposit(const Grid<float>& deposit_depth, double least_depth);

/// Vertical depth times the cosine of the ground's slope, on the same cells.
[[nodiscard]] Grid<float> normal_to_slope(const Grid<float>& depth, const terrain::Terrain& terrain);
[[nodiscard]] FlowThickness measure_thickness(const Grid<float>& peak_depth, const terrain::Terrain& terrain,
                                              double least_depth);

/// The front at a chainage, interpolated between samples; NaN where debris never came.
[[nodiscard]] FrontSample front_at(const Observation& observation, double chainage);
/// What a run has in place of a field observation, m/s; NaN: not reached.
[[nodiscard]] inline double computed_for(const params::ObservationSpec& observed, const Observation& run) {
    const FrontSample front = front_at(run, observed.chainage);
    return observed.debris_speed ? front.particle_speed : front.front_velocity;
}

}  // namespace talus::observe
