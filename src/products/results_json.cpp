#include "products/results_json.hpp"

#include <cmath>

#include "core/hash.hpp"
#include "core/number_or_null.hpp"
#include "observe/number_names.hpp"
#include "products/text_file.hpp"
#include "sim/compression.hpp"

namespace talus::products {

namespace {

using Json = nlohmann::ordered_json;

Json answer_json(run::Answer answer) {
    return answer == run::Answer::unknown ? Json() : Json(answer == run::Answer::yes);
}

Json variant_json(const run::Comparison& comparison, const run::Comparison::Row& row) {
    Json variant = {{"name", row.run.variant.name}, {"overrides", row.run.variant.overrides}};
    if (!row.run.result) {
        variant["missing"] = row.run.missing;
        return variant;
    }
    const bool judged = comparison.kind == run::ComparisonKind::convergence;
    if (judged) variant["verdict"] = verdict_name(row.verdict());
    Json values = Json::object();
    for (std::size_t i = 0; i < comparison.quantities.size(); ++i) {
        const run::Quantity& quantity = comparison.quantities[i];
        const run::Change& change = row.changes[i];
        Json& value = values[quantity.key];
        value = {{"value_" + quantity.suffix, change.value}, {"change_percent", change.percent}};
        if (judged) value["verdict"] = verdict_name(change.verdict);
    }
    const run::RunResult& result = *row.run.result;
    variant["values"] = values;
    const bool flat = result.depth_averaged();
    variant["compression"] = flat ? Json() : compression_json(result.observation);
    variant["particles"] = flat ? Json() : Json(result.particles);
    variant["particle_spacing_m"] = flat ? Json() : Json(result.particle_spacing);
    variant["steps"] = result.steps;
    variant["simulated_time_s"] = result.simulated_time;
    variant["wall_time_s"] = result.wall_time;
    variant["result_hash"] = to_hex(result.hash);
    return variant;
}

Json comparison_json(const run::Comparison& comparison) {
    Json json = Json::object();
    const bool judged = comparison.kind == run::ComparisonKind::convergence;
    if (judged) json["converged"] = answer_json(comparison.converged());
    json["verdict"] = comparison.verdict_text();
    json["quantities"] = Json::array();
    for (const run::Quantity& quantity : comparison.quantities) {
        Json entry = {{"key", quantity.key}, {"name", quantity.name}, {"base_" + quantity.suffix, quantity.base}};
        if (judged) entry["limit_percent"] = quantity.limit_percent;
        if (!quantity.not_measured.empty()) entry["not_measured"] = quantity.not_measured;
        json["quantities"].push_back(entry);
    }
    json["variants"] = Json::array();
    for (const run::Comparison::Row& row : comparison.rows) json["variants"].push_back(variant_json(comparison, row));
    return json;
}

}  // namespace

Json run_out_json(const observe::Observation& observation) {
    Json all = {{observe::front_number.key, number_or_null<Json>(observe::front_number.value(observation))}};
    for (const observe::NamedNumber& number : observe::run_out_numbers) {
        all[std::string(number.key)] = number_or_null<Json>(number.value(observation));
        if (number.key == "run_out_straight_m") all["run_out_at_least"] = observation.run_out.at_least;
    }
    return all;
}

Json compression_json(const observe::Observation& observation) {
    const observe::Compression& c = observation.compression;
    return {{"within_limits", c.within_limits()},
            {"worst_mean", c.worst_mean},
            {"worst_mean_time_s", c.worst_mean_time},
            {"mean_limit", sim::mean_compression_limit},
            {"worst_overcompressed_share", c.worst_overcompressed_share},
            {"worst_overcompressed_time_s", c.worst_overcompressed_time},
            {"overcompressed_share_limit", sim::overcompressed_share_limit},
            {"overcompressed_compression", sim::overcompressed_compression},
            {"worst_max", c.worst_max},
            {"worst_max_time_s", c.worst_max_time},
            {"time_share_above_a_limit", c.time_share_above},
            {"time_share_limit", observe::Compression::time_share_limit},
            {"mean_iterations", c.mean_iterations},
            {"time_share_with_extra_iterations", c.time_share_iterated}};
}

Json comparisons_json(const std::vector<run::Comparison>& comparisons) {
    Json json = Json::object();
    for (const run::Comparison& comparison : comparisons) {
        json[comparison.kind == run::ComparisonKind::convergence ? "convergence" : "sensitivity"] =
            comparison_json(comparison);
    }
    return json;
}

Json structures_json(const observe::Observation& observation) {
    Json list = Json::array();
    for (const observe::BuildingImpact& b : observation.buildings) {
        if (!b.hit && !b.is_barrier) continue;
        Json entry = {{"name", b.name},
                      {"kind", kind_of(b)},
                      {"first_hit_s", b.first_hit_time},
                      {"peak_force_kN", b.peak_force / 1e3},
                      {"peak_impact_pressure_kPa", b.peak_impact_pressure / 1e3},
                      {"peak_dynamic_pressure_kPa", b.peak_dynamic_pressure / 1e3},
                      {"peak_depth_m", b.peak_depth},
                      {"impulse_kNs", b.impulse / 1e3},
                      {"failed_s", b.failure_time}};
        if (b.is_barrier) {
            if (!std::isnan(b.passing_share)) entry["passing_share"] = b.passing_share;
            entry["overtopped_m3"] = b.overtopped_volume;
            entry["first_overtopped_s"] = b.first_overtopping_time;
            entry["passed_m3"] = b.passed_volume;
            entry["retained_m3"] = b.retained_volume;
            entry["peak_retained_m3"] = b.peak_retained_volume;
            entry["peak_filling_height_m"] = b.peak_filling_height;
        }
        list.push_back(entry);
    }
    return list;
}

Json cross_sections_json(const observe::Observation& observation) {
    Json all = Json::array();
    for (const observe::DischargeRecord& r : observation.cross_sections) {
        all.push_back({{"name", r.section.name},
                       {"peak_discharge_m3ps", r.peak_discharge},
                       {"peak_discharge_time_s", r.peak_time},
                       {"passed_m3", r.passed}});
    }
    return all;
}

Status write_results(const Json& results, const std::filesystem::path& file) {
    // Names from attribute tables need not be valid UTF-8; the file is.
    return write_text_file(file, results.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace talus::products
