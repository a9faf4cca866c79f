#include "report/second_opinion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/decimals.hpp"
#include "core/number_or_null.hpp"
#include "observe/number_names.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"
#include "report/second_opinion_parts.hpp"

namespace talus::report {
namespace {

struct Quantity {
    std::string name, unit, format;
    double particles = observe::never, depth_averaged = observe::never, observed = observe::never;
};

std::vector<Quantity> quantities(const BothModels& models, const run::SecondOpinion& opinion) {
    std::vector<Quantity> all;
    const observe::Observation &p = models.particles.observation, &d = models.depth_averaged.observation;
    const auto add = [&](const std::string& name, std::string_view unit, const std::string& format, const auto& value) {
        all.push_back({name, std::string(unit), format, value(p), value(d)});
    };
    const auto add_number = [&](std::string_view key, const std::string& format) {
        const observe::NamedNumber& number = *observe::find_number(key);
        add(number.title, observe::printed_unit(number.unit), format, number.value);
    };
    for (const params::ObservationSpec& observed : models.scene.spec.observations) {
        const std::string at = fmt::format(" at {} m", plain(observed.chainage));
        add(observed.quantity() + at, "m/s", "f1", [&](const auto& o) { return computed_for(observed, o); });
        all.back().observed = observed.value();
        add("Front arrival" + at, "s", "f1",
            [&](const auto& o) { return front_at(o, observed.chainage).arrival_time; });
    }
    const auto metres = [&](int least) { return fmt::format("f{}", length_decimals(models.scene, least)); };
    const std::string square_metres = fmt::format("f{}", decimals_for(opinion.area.both + opinion.area.only_first, 0));
    for (const char* key : {"front_chainage_m", "run_out_along_flow_m", "run_out_straight_m"})
        add_number(key, metres(0));
    add_number("runout_angle_deg", "f1");
    all.push_back({"Affected area", "m²", square_metres, opinion.area.both + opinion.area.only_first,
                   opinion.area.both + opinion.area.only_second});
    add_number("deposit_area_m2", square_metres);
    add_number("deposit_depth_m", metres(2));
    all.back().name += " that nine tenths of its area stay below";
    for (std::size_t k = 0; k < run::peak_pairs.size(); ++k) {
        const NamedMap& map = observe::peak_numbers[k].map;
        const run::MapPair& maps = opinion.*run::peak_pairs[k];
        const auto format = [&](int least) { return k == 0 ? metres(least) : k == 1 ? "f1" : "s3"; };
        all.push_back({map.title, map.unit, format(1), map.factor * maps.peak_particles.value,
                       map.factor * maps.peak_depth_averaged.value});
        all.push_back({std::string(map.title) + ", median of the ground of both", map.unit, format(2),
                       map.factor * maps.median_particles, map.factor * maps.median_depth_averaged});
    }
    add_number("volume_released_m3", fmt::format("f{}", decimals_for(p.volume_released, 1)));
    all.push_back({"Wall time", "s", "f1", models.particles.wall_time, models.depth_averaged.wall_time});
    return all;
}

Json quantity_rows(const BothModels& models, const run::SecondOpinion& opinion) {
    const bool observed = !models.scene.spec.observations.empty();
    std::vector<Column> columns = {{"quantity", "Quantity", ""},
                                   {"unit", "Unit", "", "", ""},
                                   {"particles", "Particles", "", "", "n"},
                                   {"depth_averaged", "Depth-averaged", "", "", "n"},
                                   {"difference_percent", "Difference", "%", "d0"}};
    if (observed) columns.push_back({"observed", "Observed", "", "", "n"});
    Json rows = table(columns, "comparison");
    const auto shown = [](double value, const std::string& format) {
        return std::isfinite(value) ? Json{{"value", value}, {"format", format}} : Json();
    };
    for (const Quantity& q : quantities(models, opinion)) {
        rows["rows"].push_back(
            {{"quantity", q.name},
             {"unit", q.unit},
             {"particles", shown(q.particles, q.format)},
             {"depth_averaged", shown(q.depth_averaged, q.format)},
             {"difference_percent", number_or_null<Json>(percent_more(q.particles, q.depth_averaged))}});
        if (observed) rows["rows"].back()["observed"] = shown(q.observed, q.format);
    }
    return rows;
}

Json structure_rows(const BothModels& models) {
    const auto& structures = models.particles.observation.buildings;
    const bool barriers = std::any_of(structures.begin(), structures.end(), [](const auto& b) { return b.is_barrier; });
    std::vector<Column> columns = {{"name", "Structure", ""},
                                   {"hit_by", "Hit in", ""},
                                   {"first_hit_s", "First hit", "s", "f1"},
                                   {"first_hit_depth_averaged_s", "depth-averaged", "s", "f1"},
                                   {"peak_force_kN", "Peak force", "kN", "s3"},
                                   {"peak_force_depth_averaged_kN", "depth-averaged", "kN", "s3"},
                                   {"peak_impact_pressure_kPa", "Impact pressure", "kPa", "s3"},
                                   {"peak_impact_pressure_depth_averaged_kPa", "depth-averaged", "kPa", "s3"},
                                   {"peak_depth_m", "Depth at walls", "m", "f2"},
                                   {"peak_depth_depth_averaged_m", "depth-averaged", "m", "f2"}};
    if (barriers) {
        columns.insert(columns.end(), {{"overtopped_m3", "Over the crest", "m³", "f1"},
                                       {"overtopped_depth_averaged_m3", "depth-averaged", "m³", "f1"},
                                       {"retained_m3", "Retained at the end", "m³", "f1"},
                                       {"retained_depth_averaged_m3", "depth-averaged", "m³", "f1"}});
    }
    Json rows = table(columns);
    for_each_structure(models, [&](const auto& p, const auto& d, HitBy by) {
        if (by == neither) return;
        Json row = {{"name", {{"value", name_of(p)}, {"mark", fmt::format("hit-{}", int{by})}}},
                    {"hit_by", hit_by_names.at(by)}};
        const auto add = [&](const observe::BuildingImpact& impact, const std::string& model) {
            const auto shown = [&](double value) { return impact.hit ? number_or_null<Json>(value) : Json(); };
            row["first_hit" + model + "_s"] = shown(impact.first_hit_time);
            row["peak_force" + model + "_kN"] = shown(impact.peak_force / 1e3);
            row["peak_impact_pressure" + model + "_kPa"] = shown(impact.peak_impact_pressure / 1e3);
            row["peak_depth" + model + "_m"] = shown(impact.peak_depth);
            if (!barriers) return;
            const auto of_barrier = [&](double value) { return impact.is_barrier ? shown(value) : Json(); };
            row["overtopped" + model + "_m3"] = of_barrier(impact.overtopped_volume);
            row["retained" + model + "_m3"] = of_barrier(impact.retained_volume);
        };
        add(p, "");
        add(d, "_depth_averaged");
        rows["rows"].push_back(std::move(row));
    });
    return rows["rows"].empty() ? Json() : rows;
}

Json cards(const BothModels& models, const run::SecondOpinion& opinion) {
    Json all = Json::array();
    const run::AreaAgreement& area = opinion.area;
    all.push_back(key_figure("intersection_over_union_percent", "Agreement of the affected area",
                             number_or_null<Json>(100 * area.intersection_over_union()), "f0", "%",
                             "intersection over union"));
    const auto of_particles = [&](std::string_view key, const char* name, double p, double d, const char* format,
                                  const char* unit) {
        const double percent = percent_more(p, d);
        all.push_back(key_figure(
            key, fmt::format("{}, particles", name), number_or_null<Json>(p), format, unit,
            std::isfinite(d)
                ? fmt::format("depth-averaged {}\u00a0{}{}", formatted(d, format), unit,
                              std::isfinite(percent) ? fmt::format(", {}\u00a0%", formatted(percent, "d0")) : "")
                : ""));
    };
    const observe::NamedNumber& run_out = observe::run_out_number;
    of_particles(run_out.key, run_out.title, run_out.value(models.particles.observation),
                 run_out.value(models.depth_averaged.observation), "f0", run_out.unit);
    const auto& [of_depth, of_speed, of_pressure] = observe::peak_numbers;
    of_particles(of_speed.key, of_speed.map.title, opinion.speed.peak_particles.value,
                 opinion.speed.peak_depth_averaged.value, "f1", "m/s");
    of_particles(of_pressure.key, of_pressure.map.title, opinion.pressure.peak_particles.value / 1e3,
                 opinion.pressure.peak_depth_averaged.value / 1e3, "s3", "kPa");
    of_particles(of_depth.key, of_depth.map.title, opinion.depth.peak_particles.value,
                 opinion.depth.peak_depth_averaged.value, "f1", "m");
    const auto difference = [&](const char* key, const char* name, const run::LargestDifference& largest, int digits,
                                const char* unit, const std::string& where) {
        const std::string format = fmt::format("f{}", digits);
        all.push_back(key_figure(key, name, largest.known() ? Json(std::abs(largest.size())) : Json(), format, unit,
                                 largest.known() ? fmt::format("{} {} with particles, {} {} depth-averaged, {}",
                                                               fixed(largest.particles, digits), unit,
                                                               fixed(largest.depth_averaged, digits), unit, where)
                                                 : ""));
    };
    const run::LargestDifference& depth = opinion.depth.largest;
    difference("largest_depth_difference_m", "Largest difference in peak depth", depth, 1, "m",
               depth.known() ? place(models.scene, depth.at) : "");
    difference("largest_arrival_difference_s", "Largest difference in arrival of the front", opinion.arrival, 1, "s",
               fmt::format("at chainage {} m", fixed(opinion.arrival.chainage, 0)));
    std::array<int, 4> hits{};
    for_each_structure(models, [&](const auto&, const auto&, HitBy by) { ++hits.at(by); });
    if (models.scene.buildings.empty()) return all;
    const int one = hits[particles_only] + hits[depth_averaged_only];
    all.push_back(key_figure("structures_hit_in_one_model", "Structures hit in one model only", one, "f0", "",
                             fmt::format("{} in both, {} in neither", hits[both], hits[neither]), one > 0));
    return all;
}

}  // namespace

Json second_opinion_results(const BothModels& models, const run::SecondOpinion& opinion) {
    Json all = results_head("talus comparison", models.scene);
    const run::RunVerdict particles = judge(models.particles), grid = judge(models.depth_averaged);
    const Json of_particles = status(models.particles, particles), of_grid = status(models.depth_averaged, grid);
    const bool partial = of_particles["partial"].get<bool>() || of_grid["partial"].get<bool>();
    all.update({{"status",
                 {{"name", partial ? "a run did not come to its end" : "complete"},
                  {"partial", partial},
                  {"beyond_limits", beyond_limits(run::judge_together({particles, grid}))},
                  {"particles", of_particles},
                  {"depth_averaged", of_grid}}},
                {"verdict", {{"particles", verdict_json(particles)}, {"depth_averaged", verdict_json(grid)}}},
                {"agreement",
                 {{"intersection_over_union", number_or_null<Json>(opinion.area.intersection_over_union())},
                  {"both_m2", opinion.area.both},
                  {"particles_only_m2", opinion.area.only_first},
                  {"depth_averaged_only_m2", opinion.area.only_second},
                  {"cell_m", opinion.depth.difference.geometry.cell},
                  {"arrival_depth_m", models.scene.spec.outputs.arrival_depth}}},
                {"impact_patch_edge_m", models.scene.spec.outputs.impact_patch_edge},
                {"impact_filter_window_s", models.scene.spec.outputs.impact_filter_window},
                {"differences", differences(models, opinion)},
                {"key_figures", cards(models, opinion)},
                {"quantities", quantity_rows(models, opinion)},
                {"structures", structure_rows(models)},
                {"fronts", fronts_chart(models.scene, {{"particles", &models.particles},
                                                       {"depth-averaged", &models.depth_averaged}})},
                {"gauges", gauges({{"particles", &models.particles}, {"depth-averaged", &models.depth_averaged}})},
                {"cross_sections",
                 cross_sections({{"particles", &models.particles}, {"depth-averaged", &models.depth_averaged}})},
                {"as_computed",
                 {{"particles", chosen_values(models.scene, models.particles)},
                  {"depth_averaged", chosen_values(models.grid_scene, models.depth_averaged)}}},
                {"notes", models.grid_scene.notes},
                {"hashes",
                 {{"particles", fmt::format("{:016x}", models.particles.hash)},
                  {"depth_averaged", fmt::format("{:016x}", models.depth_averaged.hash)}}}});
    return all;
}

}  // namespace talus::report
