#pragma once

#include <cstdint>

#include "pack/codec.hpp"
#include "scene/scene.hpp"

/// The members of what a scene is made of. Names are the keys of a packed scene.
namespace talus::pack {

/// Changes with every change of these lists and of those in pack.cpp.
inline constexpr std::uint32_t version = 3;

TALUS_PACKED(Extent, x_min, y_min, x_max, y_max)
TALUS_PACKED(PlanPoint, x, y)
TALUS_PACKED(Polygon, outer, holes)
TALUS_PACKED(GridGeometry, x_min, y_min, cell, columns, rows)

TALUS_PACKED(geo::Crs, wkt, name, epsg, local)

TALUS_PACKED(params::SceneInfo, title, description, reconstruction, assumptions, sources, option)
TALUS_PACKED(params::ReportSpec, client, author, checker, revision, reference, date, limits_of_use)
TALUS_PACKED(params::TerrainSpec, file, crs, band, extent, obtain, deposit, erosion, orthophoto)
TALUS_PACKED(params::ReleaseSpec, name, file, layer, thickness, thickness_attribute, thickness_raster,
             thickness_direction, volume, start_time, shift_along, shift_across, pore_pressure_ratio,
             pore_pressure_hydrograph, solid_fraction)
TALUS_PACKED(params::PressureSample, time, ratio)
TALUS_PACKED(params::BedSpec, name, file, layer, depth, depth_attribute, depth_raster, law, growth_rate,
             critical_shear_stress, erosion_rate, erosion_depth_per_shear)
TALUS_PACKED(params::InflowSpec, name, line, file, layer, polygon, polygon_file, direction, hydrograph, solid_fraction)
TALUS_PACKED(params::InflowSample, time, discharge, velocity, density, pore_pressure_ratio)
TALUS_PACKED(params::BuildingSpec, height)
TALUS_PACKED(params::BarrierOpeningSpec, position, width, sill, barrier)
TALUS_PACKED(params::BarrierSpec, line, height, crest_elevation, thickness, openings, passing_share, clearance,
             resistance_force, resistance_pressure, name, file, layer)
TALUS_PACKED(params::FlowPathSpec, file, layer, corridor_width)
TALUS_PACKED(params::MaterialSpec, rest_density, friction_coefficient, building_friction_coefficient,
             internal_friction_coefficient, viscosity, kinematic_viscosity, viscosity_on_ground, turbulent_friction,
             turbulent_friction_thickness, laminar_viscosity, laminar_dynamic_viscosity, cohesion, pore_pressure_ratio,
             pore_pressure_decay_time, pore_pressure, permeability, solid_fraction, critical_solid_fraction,
             pore_fluid_viscosity, pore_fluid_density, compressibility, inertial_friction_coefficient, inertial_number,
             grain_diameter, grain_density, samosat, samosat_fluidization, samosat_karman, samosat_roughness,
             samosat_offset)
TALUS_PACKED(params::ZoneSpec, name, file, layer, polygon, raster, raster_holds, raster_value, friction_coefficient,
             turbulent_friction, cohesion, laminar_viscosity, stem_density, stem_diameter, stem_drag_coefficient)
TALUS_PACKED(params::SolverSpec, particle_spacing, target_layers, target_particle_count, particle_limit, time_step,
             displacement_limit, largest_time_step, smallest_time_step, iteration_count, extra_iteration_count, kernel,
             internal_friction, support_ratio, under_relaxation, constraint_relaxation, depenetration_speed, end_time,
             stop_moving_share, stop_energy_share, stop_momentum_share, stop_duration, rest_duration, compression_limit,
             thread_count, backend, model, grid_cell, flight)
TALUS_PACKED(params::OutputSpec, map_cell, sample_interval, chainage_interval, front_velocity_window, arrival_depth,
             impact_filter_window, impact_patch_edge, deposited_speed, series, series_interval, geoid_height,
             intensity_guideline, contours, tracks, peak_thickness)
TALUS_PACKED(params::GaugeSpec, name, x, y, chainage)
TALUS_PACKED(params::CrossSectionSpec, name, line, file, layer, interval)
TALUS_PACKED(params::ZoomSpec, structure, margin, polygon, polygon_file, layer, particle_spacing, target_layers,
             surroundings)
TALUS_PACKED(params::ObservationSpec, name, chainage, front_velocity, debris_speed, source, uncertainty)
TALUS_PACKED(params::SuperelevationSpec, name, chainage, bend_radius, width, level_difference, correction_factor,
             uncertainty, source)
TALUS_PACKED(params::ArrivalSpec, name, chainage, time, uncertainty, source)
TALUS_PACKED(params::RunUpSpec, name, x, y, height, uncertainty, source)
TALUS_PACKED(params::DepositDepthSpec, name, x, y, depth, uncertainty, source)
TALUS_PACKED(params::DamageSpec, building, damaged, pressure, uncertainty, source)
TALUS_PACKED(params::ObservedRunOutSpec, name, chainage, uncertainty, source)
TALUS_PACKED(params::OutlineSpec, name, file, layer, depth, uncertainty, source)
TALUS_PACKED(params::ElevationChangeSpec, name, file, detection_limit, uncertainty, source)
TALUS_PACKED(params::VariantSpec, name, set, notes, source)
TALUS_PACKED(params::TriggerSpec, name, release, inflow, volume_limit, pore_pressure_ratio_limit, discharge_limit,
             start_discharge, hold_time)
TALUS_PACKED(params::AlarmSpec, name, structure, chainage, x, y, distance, lead_time, impact_pressure, dynamic_pressure,
             depth, message)

TALUS_PACKED(params::OptionSpec, name, barriers, zones, removed_buildings, cost, life, interest_rate, upkeep, notes,
             source)
TALUS_PACKED(params::RiskSpec, currency, curves, map_death_curve, criteria)
TALUS_PACKED(params::RiskScenarioSpec, name, annual_frequency, return_period, set, source)
TALUS_PACKED(params::ExposureSpec, name, kind, death_curve, damage_curve, source, buildings, value, persons, presence,
             value_attribute, persons_attribute, presence_attribute, line, file, layer, vehicles_per_day, speed,
             persons_per_vehicle, trips_per_day)

/// With a base, so that the compiler cannot count its members: tests/pack does.
template <class Value, class Visit>
requires std::same_as<std::remove_const_t<Value>, params::BuildingsSpec>
void visit_members(Value& v, const Visit& visit) {
    visit("height, file, layer, height_attribute, name_attribute, resistance_attribute, resistance", v.height, v.file,
          v.layer, v.height_attribute, v.name_attribute, v.resistance_attribute, v.resistance);
}

TALUS_PACKED(params::SceneSpec, scene, report, terrain, releases, beds, inflows, hydrograph, buildings, barriers,
             barrier_openings, flow_path, material, zones, solver, outputs, gauges, cross_sections, zoom, observations,
             superelevations, arrivals, run_ups, deposit_depths, damages, observed_run_outs, deposit_outlines,
             affected_areas, elevation_changes, variants, triggers, alarms, options, risk, risk_scenarios, exposures)

TALUS_PACKED(terrain::ReleasePatch, polygon, thickness)
TALUS_PACKED(terrain::Release, name, patches, thickness_raster, volume, water, spec)
TALUS_PACKED(terrain::Inflow, name, from, to, hydrograph, area, spec)
TALUS_PACKED(terrain::Resistance, force_per_metre, pressure)
TALUS_PACKED(terrain::Gauge, name, at, chainage)
TALUS_PACKED(terrain::CrossSection, name, line, interval)

template <class Value, class Visit>
requires std::same_as<std::remove_const_t<Value>, terrain::Building>
void visit_members(Value& v, const Visit& visit) {
    visit("height, name, footprint, height_assumed, roof_elevation, part_roof_elevations, resistance, barrier",
          v.height, v.name, v.footprint, v.height_assumed, v.roof_elevation, v.part_roof_elevations, v.resistance,
          v.barrier);
}

TALUS_PACKED(scene::InputFile, role, path, bytes, hash)
TALUS_PACKED(scene::ThinnestSource, name, thickness)
TALUS_PACKED(scene::ZoneCells, cell, value)
TALUS_PACKED(scene::Zone, spec, outline, cells)
TALUS_PACKED(scene::BedLayer::Part, polygon, depth)
TALUS_PACKED(scene::BedLayer, spec, parts, depth_raster)

template <>
inline constexpr std::uint64_t count_of<params::CrsChoice> = 2;
template <>
inline constexpr std::uint64_t count_of<params::PorePressure> = 2;
template <>
inline constexpr std::uint64_t count_of<params::CriteriaChoice> = 2;
template <>
inline constexpr std::uint64_t count_of<params::ExposureKind> = 2;
template <>
inline constexpr std::uint64_t count_of<params::EntrainmentLaw> = 2;
template <>
inline constexpr std::uint64_t count_of<params::ThicknessDirection> = 2;
template <>
inline constexpr std::uint64_t count_of<params::ZoneRaster> = 3;
template <>
inline constexpr std::uint64_t count_of<params::KernelChoice> = 4;
template <>
inline constexpr std::uint64_t count_of<params::InternalFriction> = 2;
template <>
inline constexpr std::uint64_t count_of<params::ModelChoice> = 2;
template <>
inline constexpr std::uint64_t count_of<params::BackendChoice> = 4;
template <>
inline constexpr std::uint64_t count_of<params::GuidelineChoice> = 3;
template <>
inline constexpr std::uint64_t count_of<scene::PathOrigin> = 3;

}  // namespace talus::pack
