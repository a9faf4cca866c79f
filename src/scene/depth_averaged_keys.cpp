#include "scene/depth_averaged_keys.hpp"

#include <algorithm>
#include <array>

namespace talus::scene {
namespace {

using enum KeyUse;

/// A key that is new in the schema needs an entry; a test says so.
constexpr std::array keys = {
    DepthAveragedKey{"scene.*", used, ""},
    DepthAveragedKey{"report.*", used, ""},
    DepthAveragedKey{"terrain.*", used, ""},
    DepthAveragedKey{"release.name", used, ""},
    DepthAveragedKey{"release.file", used, ""},
    DepthAveragedKey{"release.layer", used, ""},
    DepthAveragedKey{"release.thickness_m", used, ""},
    DepthAveragedKey{"release.thickness_attribute", used, ""},
    DepthAveragedKey{"release.thickness_raster", used, ""},
    DepthAveragedKey{"release.thickness_direction", used, ""},
    DepthAveragedKey{"release.volume_m3", used, ""},
    DepthAveragedKey{"release.start_time_s", used, ""},
    DepthAveragedKey{"release.shift_along_m", used, ""},
    DepthAveragedKey{"release.shift_across_m", used, ""},
    DepthAveragedKey{"release.pore_pressure_ratio", used, ""},
    DepthAveragedKey{"inflow.name", used, ""},
    DepthAveragedKey{"inflow.line_m", used, ""},
    DepthAveragedKey{"inflow.file", used, ""},
    DepthAveragedKey{"inflow.layer", used, ""},
    DepthAveragedKey{"inflow.polygon_m", used, ""},
    DepthAveragedKey{"inflow.polygon_file", used, ""},
    DepthAveragedKey{"inflow.direction_deg", used, ""},
    DepthAveragedKey{"inflow.hydrograph", used, ""},
    DepthAveragedKey{"bed.name", used, ""},
    DepthAveragedKey{"bed.file", used, ""},
    DepthAveragedKey{"bed.layer", used, ""},
    DepthAveragedKey{"bed.depth_m", used, ""},
    DepthAveragedKey{"bed.depth_attribute", used, ""},
    DepthAveragedKey{"bed.depth_raster", used, ""},
    DepthAveragedKey{"bed.law", used, ""},
    DepthAveragedKey{"bed.growth_rate_per_m", used, ""},
    DepthAveragedKey{"bed.critical_shear_stress_Pa", used, ""},
    DepthAveragedKey{"bed.erosion_rate_mps", used, ""},
    DepthAveragedKey{"bed.erosion_depth_mpPa", used, ""},
    DepthAveragedKey{"buildings.file", used, ""},
    DepthAveragedKey{"buildings.layer", used, ""},
    DepthAveragedKey{"buildings.height_attribute", used, ""},
    DepthAveragedKey{"buildings.name_attribute", used, ""},
    DepthAveragedKey{"buildings.default_height_m", used, ""},
    DepthAveragedKey{"buildings.resistance_attribute", refused, "has no structures that fail"},
    DepthAveragedKey{"buildings.resistance_Pa", refused, "has no structures that fail"},
    DepthAveragedKey{"barrier.name", used, ""},
    DepthAveragedKey{"barrier.line_m", used, ""},
    DepthAveragedKey{"barrier.file", used, ""},
    DepthAveragedKey{"barrier.layer", used, ""},
    DepthAveragedKey{"barrier.height_m", used, ""},
    DepthAveragedKey{"barrier.crest_elevation_m", used, ""},
    DepthAveragedKey{"barrier.thickness_m", used, ""},
    DepthAveragedKey{"barrier.passing_share", refused, "has no nets"},
    DepthAveragedKey{"barrier.clearance_m", refused, "has nothing below a structure"},
    DepthAveragedKey{"barrier.resistance_Npm", refused, "has no structures that fail"},
    DepthAveragedKey{"barrier.resistance_Pa", refused, "has no structures that fail"},
    DepthAveragedKey{"barrier_opening.barrier", used, ""},
    DepthAveragedKey{"barrier_opening.position_m", used, ""},
    DepthAveragedKey{"barrier_opening.width_m", used, ""},
    DepthAveragedKey{"barrier_opening.sill_height_m", used, ""},
    DepthAveragedKey{"material.friction_coefficient", used, ""},
    DepthAveragedKey{"material.building_friction_coefficient", noted, ""},
    DepthAveragedKey{"material.internal_friction_coefficient", noted, ""},
    DepthAveragedKey{"material.viscosity", noted, ""},
    DepthAveragedKey{"material.kinematic_viscosity_m2ps", used, ""},
    DepthAveragedKey{"material.viscosity_on_ground", used, ""},
    DepthAveragedKey{"material.turbulent_friction_mps2", used, ""},
    DepthAveragedKey{"material.turbulent_friction_thickness_m", used, ""},
    DepthAveragedKey{"material.laminar_viscosity_m2ps", used, ""},
    DepthAveragedKey{"material.laminar_viscosity_Pas", used, ""},
    DepthAveragedKey{"material.cohesion_Pa", used, ""},
    DepthAveragedKey{"material.pore_pressure_ratio", used, ""},
    DepthAveragedKey{"material.pore_pressure_decay_time_s", used, ""},
    DepthAveragedKey{"material.rest_density_kgpm3", used, ""},
    DepthAveragedKey{"material.inertial_friction_coefficient", noted, ""},
    DepthAveragedKey{"material.inertial_number", noted, ""},
    DepthAveragedKey{"material.grain_diameter_m", noted, ""},
    DepthAveragedKey{"material.grain_density_kgpm3", noted, ""},
    DepthAveragedKey{"material.samosat", used, ""},
    DepthAveragedKey{"material.samosat_fluidization", used, ""},
    DepthAveragedKey{"material.samosat_karman", used, ""},
    DepthAveragedKey{"material.samosat_roughness_m", used, ""},
    DepthAveragedKey{"material.samosat_offset", used, ""},
    DepthAveragedKey{"zone.name", used, ""},
    DepthAveragedKey{"zone.file", used, ""},
    DepthAveragedKey{"zone.layer", used, ""},
    DepthAveragedKey{"zone.polygon", used, ""},
    DepthAveragedKey{"zone.raster", used, ""},
    DepthAveragedKey{"zone.raster_holds", used, ""},
    DepthAveragedKey{"zone.raster_value", used, ""},
    DepthAveragedKey{"zone.friction_coefficient", used, ""},
    DepthAveragedKey{"zone.turbulent_friction_mps2", used, ""},
    DepthAveragedKey{"zone.laminar_viscosity_m2ps", used, ""},
    DepthAveragedKey{"zone.cohesion_Pa", used, ""},
    DepthAveragedKey{"zone.stem_density_pm2", used, ""},
    DepthAveragedKey{"zone.stem_diameter_m", used, ""},
    DepthAveragedKey{"zone.stem_drag_coefficient", used, ""},
    DepthAveragedKey{"solver.particle_spacing_m", noted, ""},
    DepthAveragedKey{"solver.target_layers", noted, ""},
    DepthAveragedKey{"solver.target_particle_count", noted, ""},
    DepthAveragedKey{"solver.particle_limit", noted, ""},
    DepthAveragedKey{"solver.time_step_s", noted, ""},
    DepthAveragedKey{"solver.displacement_limit", noted, ""},
    DepthAveragedKey{"solver.largest_time_step_s", noted, ""},
    DepthAveragedKey{"solver.smallest_time_step_s", noted, ""},
    DepthAveragedKey{"solver.iteration_count", noted, ""},
    DepthAveragedKey{"solver.extra_iteration_count", noted, ""},
    DepthAveragedKey{"solver.kernel", noted, ""},
    DepthAveragedKey{"solver.internal_friction", noted, ""},
    DepthAveragedKey{"solver.support_ratio", noted, ""},
    DepthAveragedKey{"solver.under_relaxation", noted, ""},
    DepthAveragedKey{"solver.constraint_relaxation", noted, ""},
    DepthAveragedKey{"solver.depenetration_speed_mps", noted, ""},
    DepthAveragedKey{"solver.end_time_s", used, ""},
    DepthAveragedKey{"solver.stop_moving_share", used, ""},
    DepthAveragedKey{"solver.stop_energy_share", used, ""},
    DepthAveragedKey{"solver.stop_momentum_share", used, ""},
    DepthAveragedKey{"solver.stop_duration_s", used, ""},
    DepthAveragedKey{"solver.rest_duration_s", noted, ""},
    DepthAveragedKey{"solver.compression_limit", noted, ""},
    DepthAveragedKey{"solver.thread_count", used, ""},
    DepthAveragedKey{"solver.backend", noted, ""},
    DepthAveragedKey{"solver.model", used, ""},
    DepthAveragedKey{"solver.grid_cell_m", own, ""},
    DepthAveragedKey{"solver.flight", own, ""},
    DepthAveragedKey{"outputs.map_cell_m", noted, ""},
    DepthAveragedKey{"outputs.sample_interval_s", used, ""},
    DepthAveragedKey{"outputs.chainage_interval_m", used, ""},
    DepthAveragedKey{"outputs.front_velocity_window_m", used, ""},
    DepthAveragedKey{"outputs.arrival_depth_m", used, ""},
    DepthAveragedKey{"outputs.impact_filter_window_s", used, ""},
    DepthAveragedKey{"outputs.impact_patch_edge_m", used, ""},
    DepthAveragedKey{"outputs.deposited_speed_mps", used, ""},
    DepthAveragedKey{"outputs.series", used, ""},
    DepthAveragedKey{"outputs.series_interval_s", used, ""},
    DepthAveragedKey{"outputs.geoid_height_m", used, ""},
    DepthAveragedKey{"outputs.intensity_guideline", used, ""},
    DepthAveragedKey{"outputs.peak_thickness", used, ""},
    DepthAveragedKey{"outputs.contours", used, ""},
    DepthAveragedKey{"outputs.tracks", noted, ""},
    DepthAveragedKey{"zoom.structure", noted, ""},
    DepthAveragedKey{"zoom.margin_m", noted, ""},
    DepthAveragedKey{"zoom.polygon_m", noted, ""},
    DepthAveragedKey{"zoom.polygon_file", noted, ""},
    DepthAveragedKey{"zoom.layer", noted, ""},
    DepthAveragedKey{"zoom.particle_spacing_m", noted, ""},
    DepthAveragedKey{"zoom.target_layers", noted, ""},
    DepthAveragedKey{"zoom.surroundings_m", noted, ""},
    DepthAveragedKey{"flow_path.*", used, ""},
    DepthAveragedKey{"gauge.*", used, ""},
    DepthAveragedKey{"cross_section.*", used, ""},
    DepthAveragedKey{"observation.*", used, ""},
    DepthAveragedKey{"superelevation.*", used, ""},
    DepthAveragedKey{"arrival.*", used, ""},
    DepthAveragedKey{"run_up.*", used, ""},
    DepthAveragedKey{"deposit_depth.*", used, ""},
    DepthAveragedKey{"damage.*", used, ""},
    DepthAveragedKey{"observed_run_out.*", used, ""},
    DepthAveragedKey{"deposit_outline.*", used, ""},
    DepthAveragedKey{"affected_area.*", used, ""},
    DepthAveragedKey{"elevation_change.*", used, ""},
    DepthAveragedKey{"variant.*", used, ""},
    // Of the live twin, whose runs are of particles; a run takes no notice of them, whatever its model.
    DepthAveragedKey{"trigger.*", used, ""},
    DepthAveragedKey{"alarm.*", used, ""},
    DepthAveragedKey{"option.*", used, ""},
    DepthAveragedKey{"risk.*", used, ""},
    DepthAveragedKey{"risk_scenario.*", used, ""},
    DepthAveragedKey{"exposure.*", used, ""},
};

}  // namespace

std::span<const DepthAveragedKey> depth_averaged_keys() {
    return keys;
}

const DepthAveragedKey* depth_averaged_key(std::string_view key) {
    const std::string_view section = key.substr(0, key.find('.'));
    const auto* const found = std::find_if(keys.begin(), keys.end(), [&](const DepthAveragedKey& entry) {
        return entry.key == key || (entry.key.ends_with(".*") && entry.key.substr(0, entry.key.size() - 2) == section);
    });
    return found == keys.end() ? nullptr : found;
}

bool for_particles_only(std::string_view key) {
    const DepthAveragedKey* entry = depth_averaged_key(key);
    return entry != nullptr && entry->use == noted;
}

bool for_depth_averaged_only(std::string_view key) {
    const DepthAveragedKey* entry = depth_averaged_key(key);
    return entry != nullptr && entry->use == own;
}

}  // namespace talus::scene
