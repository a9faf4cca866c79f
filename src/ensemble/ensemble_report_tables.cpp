#include "ensemble/ensemble_report_tables.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "ensemble/ensemble_figures.hpp"
#include "ensemble/predict.hpp"
#include "observe/number_names.hpp"
#include "report/number_text.hpp"
#include "report/table.hpp"

namespace talus::ensemble {

using namespace report;

namespace {

constexpr std::size_t max_buildings = 60;  // rows of the table

/// Field observations of the results for which there are any.
std::string observed_text(const scene::Scene& scene, const std::string& key) {
    for (const ObservedValue& o : observed_values(scene)) {
        if (o.key != key) continue;
        const char* side = o.kind == ObservedValue::Kind::at_least ? "≥ "
                           : o.kind == ObservedValue::Kind::below  ? "< "
                                                                   : "";
        return fmt::format("{}{} ± {}", side, significant(o.value, 3), significant(o.uncertainty, 2));
    }
    return "";
}

}  // namespace

std::string percent(double share) {
    return std::isfinite(share) ? fixed(100 * share, share > 0 && share < 0.01 ? 1 : 0) + " %" : "–";
}

bool is_barrier(const EnsembleResult& result, std::size_t structure) {
    const auto& all = result.scene->buildings;
    return structure < all.size() && all[structure].barrier.has_value();
}

Json buildings_of(const EnsembleResult& result) {
    const auto& all = result.reduction.buildings;
    std::vector<const BuildingOdds*> hit;
    std::size_t count = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (is_barrier(result, i)) continue;
        ++count;
        if (all[i].hit > 0) hit.push_back(&all[i]);
    }
    if (hit.empty()) return {};
    std::stable_sort(hit.begin(), hit.end(), [](const auto* a, const auto* b) { return a->hit > b->hit; });
    const std::vector<double>& pressures = result.runs->plan().thresholds.pressure;
    std::vector<Column> columns = {{"name", "Building", ""}, {"hit", "Hit", ""}};
    for (const double p : pressures) columns.push_back({"over_" + plain(p) + "_kPa", "Over " + plain(p) + " kPa", ""});
    columns.insert(columns.end(), {{"median_pressure_kPa", "Pressure, median", "kPa", "s3"},
                                   {"high_pressure_kPa", "Pressure, 95 %", "kPa", "s3"},
                                   {"high_depth_m", "Depth at walls, 95 %", "m", "f2"},
                                   {"median_first_hit_s", "First hit, median", "s", "f1"}});
    Json rows = table(columns, "odds");
    const auto odds = [](double share) -> Json { return {{"value", percent(share)}, {"share", share}}; };
    for (std::size_t i = 0; i < std::min(hit.size(), max_buildings); ++i) {
        const BuildingOdds& b = *hit[i];
        const int mark = b.hit <= 0.1 ? 1 : b.hit <= 0.5 ? 2 : 3;
        Json row = {{"name", {{"value", b.name.empty() ? "unnamed" : b.name}, {"mark", fmt::format("hit-{}", mark)}}},
                    {"hit", odds(b.hit)},
                    {"median_pressure_kPa", number_or_null<Json>(b.median_pressure / 1e3)},
                    {"high_pressure_kPa", number_or_null<Json>(b.high_pressure / 1e3)},
                    {"high_depth_m", number_or_null<Json>(b.high_depth)},
                    {"median_first_hit_s", number_or_null<Json>(b.median_hit)}};
        for (std::size_t k = 0; k < b.over_pressure.size(); ++k) row[columns[2 + k].key] = odds(b.over_pressure[k]);
        rows["rows"].push_back(std::move(row));
    }
    return {{"table", std::move(rows)},
            {"never_hit", count - hit.size()},
            {"count", count},
            {"more", hit.size() > max_buildings ? Json(hit.size() - max_buildings) : Json()}};
}

Json results_of(const EnsembleResult& result) {
    Json rows = table({{"name", "Result", ""},
                       {"runs", "Runs", "", "f0"},
                       {"p5", "5 %", "", "s3"},
                       {"p50", "Median", "", "s3"},
                       {"p95", "95 %", "", "s3"},
                       {"least", "Least", "", "s3"},
                       {"greatest", "Greatest", "", "s3"},
                       {"unit", "Unit", "", "", "", ""},
                       {"observed", "Observed", "", "", "n", ""}});
    for (std::size_t m = 0; m < result.measures.size(); ++m) {
        const Measure& measure = result.measures[m];
        std::vector<double> values = result.values_of(m);
        const auto shown = [&](double p) -> Json {
            return {{"value", number_or_null<Json>(percentile(values, p))},
                    {"format", measure.unit.empty() ? "f0" : "s3"}};
        };
        rows["rows"].push_back({{"name", measure.name},
                                {"runs", values.size()},
                                {"p5", shown(5)},
                                {"p50", shown(50)},
                                {"p95", shown(95)},
                                {"least", shown(0)},
                                {"greatest", shown(100)},
                                {"unit", observe::printed_unit(measure.unit)},
                                {"observed", observed_text(*result.scene, measure.key)}});
    }
    return rows;
}

Json two_models_of(const EnsembleResult& result) {
    if (!result.two_models) return {};
    const TwoModels& both = *result.two_models;
    Json rows = table({{"name", "Mean of", ""},
                       {"particles", "Particles alone", "", "", "n"},
                       {"both", "With both models", "", "", "n"},
                       {"fast", "Depth-averaged alone", "", "s3"},
                       {"narrower", "Standard error saved", "%", "f0"},
                       {"unit", "Unit", "", "", "", ""}});
    const auto add = [&](const TwoModelMean& m, const std::string& name, double factor, const std::string& unit) {
        const auto with_error = [&](double mean, double error) {
            return fmt::format("{} ± {}", significant(factor * mean, 3), significant(factor * error, 2));
        };
        const double saved = m.mean.plain_error > 0 ? 100 * (1 - m.mean.error / m.mean.plain_error) : 0;
        rows["rows"].push_back({{"name", name},
                                {"particles", with_error(m.mean.plain, m.mean.plain_error)},
                                {"both", with_error(m.mean.mean, m.mean.error)},
                                {"fast", number_or_null<Json>(factor * m.fast_mean)},
                                {"narrower", saved},
                                {"unit", unit}});
    };
    for (const TwoModelMean& m : both.results) add(m, m.name, 1, m.unit);
    for (const TwoModelMean& m : both.buildings) {
        add(m, fmt::format("Hits of {}", m.name.empty() ? "an unnamed building" : m.name), 100, "%");
    }
    return {
        {"table", rows}, {"pairs", both.pairs}, {"fast_runs", both.fast_complete}, {"fast_failed", both.fast_failed}};
}

Json failed_runs(const EnsembleResult& result) {
    if (result.reduction.failed == 0) return {};
    constexpr std::size_t max_rows = 40;
    const auto& factors = result.runs->plan().factors;
    std::vector<Column> columns = {{"run", "Run", "", "f0"}};
    for (const Factor& f : factors) columns.push_back({f.key, f.key, "", "", "n"});
    columns.push_back({"fault", "Fault", "", "", "fault"});
    Json rows = table(columns);
    for (const RunRecord& run : result.reduction.runs) {
        if (run.complete() || rows["rows"].size() >= max_rows) continue;
        Json row = {{"run", run.run}, {"fault", run.fault}};
        for (std::size_t k = 0; k < factors.size(); ++k) row[factors[k].key] = run.values[k];
        rows["rows"].push_back(std::move(row));
    }
    return rows;
}

}  // namespace talus::ensemble
