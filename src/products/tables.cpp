#include <string>
#include <string_view>

#include "core/try.hpp"
#include "observe/number_names.hpp"
#include "products/csv.hpp"
#include "products/page_files.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/intensity.hpp"

namespace talus::products {

namespace {

std::string front_table(const observe::Observation& observation, std::string_view changed) {
    Csv csv("chainage_m,first_arrival_time_s,front_velocity_mps,front_particle_speed_mps", changed);
    for (const observe::FrontSample& f : observation.front) {
        csv.row({f.chainage, f.arrival_time, f.front_velocity, f.particle_speed});
    }
    return csv.text();
}

std::string run_out_table(const observe::Observation& observation, std::string_view changed) {
    const observe::RunOut& r = observation.run_out;
    constexpr std::string_view before_the_toe = "run_out_straight_m";
    std::string header;
    for (const observe::NamedNumber& number : observe::run_out_numbers) {
        header += std::string(number.key) + (number.key == before_the_toe ? ",at_least,toe_x_m,toe_y_m," : ",");
    }
    Csv csv(header + std::string(observe::front_number.key), changed);
    for (const observe::NamedNumber& number : observe::run_out_numbers) {
        csv.number(number.value(observation));
        if (number.key == before_the_toe) csv.word(r.at_least ? "yes" : "no").number(r.toe.x).number(r.toe.y);
    }
    csv.number(observe::front_number.value(observation)).end_row();
    return csv.text();
}

std::string building_table(const scene::Scene& scene, const observe::Observation& observation,
                           std::string_view changed) {
    std::string header;
    for (const auto& [name, value] : building_row(scene, {}, nullptr)) header += (header.empty() ? "" : ",") + name;
    Csv csv(header, changed);
    for (std::size_t i = 0; i < observation.buildings.size(); ++i) {
        const terrain::Building* building = i < scene.buildings.size() ? &scene.buildings[i] : nullptr;
        for (const auto& [name, value] : building_row(scene, observation.buildings[i], building)) {
            const auto* text = std::get_if<std::string>(&value);
            text != nullptr ? csv.word(*text) : csv.number(std::get<double>(value));
        }
        csv.end_row();
    }
    return csv.text();
}

/// A row per structure that was hit and row of the time series from then on.
std::string structure_table(const observe::Observation& observation, std::string_view changed) {
    Csv csv(
        "name,time_s,force_kN,impact_pressure_kPa,depth_m,dynamic_pressure_kPa,impulse_kNs,overtopped_m3,passed_m3,"
        "retained_m3,filling_height_m",
        changed);
    for (const observe::BuildingImpact& b : observation.buildings) {
        const auto of_barrier = [&](double value) { return b.is_barrier ? value : observe::never; };
        for (const observe::StructureSample& s : b.history) {
            csv.word(b.name).number(s.time).number(s.force / 1e3).number(s.impact_pressure / 1e3).number(s.depth);
            csv.number(s.dynamic_pressure / 1e3).number(s.impulse / 1e3);
            csv.number(of_barrier(s.overtopped_volume)).number(of_barrier(s.passed_volume));
            csv.number(of_barrier(s.retained_volume)).number(of_barrier(s.filling_height));
            csv.end_row();
        }
    }
    return csv.text();
}

std::string time_table(const observe::Observation& observation, std::string_view changed) {
    Csv csv(
        "time_s,front_chainage_m,volume_entrained_m3,volume_held_m3,volume_moving_m3,volume_deposited_m3,volume_left_"
        "m3,"
        "volume_balance_m3,kinetic_energy_J,potential_energy_J,momentum_Ns,largest_speed_mps,mean_compression,max_"
        "compression,"
        "overcompressed_share,"
        "time_step_s,steps_per_second",
        changed);
    for (const observe::TimeSample& s : observation.timeseries) {
        const double balance = s.volume_released + s.volume_entrained -
                               (s.volume_held + s.volume_moving + s.volume_deposited + s.volume_left);
        const auto after_a_step = [&](double value) { return s.time_step > 0 ? value : observe::never; };
        csv.row({s.time, s.front_chainage, s.volume_entrained, s.volume_held, s.volume_moving, s.volume_deposited,
                 s.volume_left, balance, s.kinetic_energy, s.potential_energy, s.momentum, s.largest_speed,
                 after_a_step(s.mean_compression), after_a_step(s.max_compression),
                 after_a_step(s.overcompressed_share), after_a_step(s.time_step), after_a_step(s.steps_per_second)});
    }
    return csv.text();
}

std::string erosion_table(const observe::Observation& observation, std::string_view changed) {
    const observe::Erosion& erosion = observation.erosion;
    Csv csv("chainage_m,volume_entrained_upstream_m3", changed);
    for (std::size_t k = 0; k < erosion.chainage.size(); ++k) csv.row({erosion.chainage[k], erosion.upstream[k]});
    return csv.text();
}

std::string gauge_table(const observe::Observation& observation, std::string_view changed) {
    Csv csv("name,time_s,depth_m,speed_mps", changed);
    for (const observe::GaugeRecord& record : observation.gauges) {
        for (const observe::GaugeSample& s : record.rows) {
            csv.word(record.gauge.name).number(s.time).number(s.depth).number(s.speed);
            csv.end_row();
        }
    }
    return csv.text();
}

std::string discharge_table(const observe::Observation& observation, std::string_view changed) {
    Csv csv("name,time_s,discharge_m3ps,passed_m3", changed);
    for (const observe::DischargeRecord& record : observation.cross_sections) {
        for (const observe::DischargeSample& s : record.rows) {
            csv.word(record.section.name).number(s.time).number(s.discharge).number(s.passed);
            csv.end_row();
        }
    }
    return csv.text();
}

}  // namespace

std::vector<std::pair<std::string, geo::Attribute>> building_row(const scene::Scene& scene,
                                                                 const observe::BuildingImpact& b,
                                                                 const terrain::Building* building) {
    const params::OutputSpec& outputs = scene.spec.outputs;
    const report::IntensityClass* intensity = report::intensity_guideline(outputs.intensity_guideline).class_of(b);
    const auto yes_or_no = [](bool value) { return std::string(value ? "yes" : "no"); };
    const auto of_barrier = [&](double value) { return b.is_barrier ? value : observe::never; };
    return {{"name", b.name},
            {"hit", yes_or_no(b.hit)},
            {"first_hit_time_s", b.first_hit_time},
            {"peak_force_kN", b.peak_force / 1e3},
            {"peak_impact_pressure_kPa", b.peak_impact_pressure / 1e3},
            {"peak_dynamic_pressure_kPa", b.peak_dynamic_pressure / 1e3},
            {"peak_depth_m", b.peak_depth},
            {"filter_window_s", outputs.impact_filter_window},
            {"patch_edge_m", outputs.impact_patch_edge},
            {"height_m", building != nullptr ? building->height : observe::never},
            {"height_assumed", yes_or_no(building != nullptr && building->height_assumed)},
            {"kind", std::string(kind_of(b))},
            {"impulse_kNs", b.impulse / 1e3},
            {"failed_s", b.failure_time},
            {"overtopped_m3", of_barrier(b.overtopped_volume)},
            {"first_overtopped_s", b.first_overtopping_time},
            {"passed_m3", of_barrier(b.passed_volume)},
            {"retained_m3", of_barrier(b.retained_volume)},
            {"peak_retained_m3", of_barrier(b.peak_retained_volume)},
            {"peak_filling_height_m", of_barrier(b.peak_filling_height)},
            {"removed_time_s", b.removed_time},
            {"peak_speed_mps", b.peak_speed},
            {"intensity", intensity != nullptr ? intensity->name : std::string()}};
}

std::vector<PageFile> tables_of(const run::RunResult& result, const std::string& changed) {
    using run::RunResult;
    using scene::Scene;
    std::vector<PageFile> tables;
    const auto add = [&](const FileName& file, auto text) {
        tables.push_back({file.name, "text/csv", file.what, [changed, text](const Scene& scene, const RunResult& run) {
                              return text(scene, run.observation, changed);
                          }});
    };
    const auto of_observation = [](auto table) {
        return [table](const Scene&, const observe::Observation& o, std::string_view also) { return table(o, also); };
    };
    const observe::Observation& observation = result.observation;
    add(front_csv, of_observation(front_table));
    add(run_out_csv, of_observation(run_out_table));
    add(buildings_csv, building_table);
    if (!observation.erosion.chainage.empty()) add(erosion_csv, of_observation(erosion_table));
    if (!observation.gauges.empty()) add(gauges_csv, of_observation(gauge_table));
    if (!observation.cross_sections.empty()) add(discharge_csv, of_observation(discharge_table));
    add(structures_csv, of_observation(structure_table));
    add(timeseries_csv, of_observation(time_table));
    return tables;
}

Status write_tables(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder,
                    std::string_view changed) {
    for (const PageFile& table : tables_of(result, std::string(changed))) {
        TALUS_TRY(write_text_file(folder / table.name, table.bytes(scene, result)));
    }
    return {};
}

}  // namespace talus::products
