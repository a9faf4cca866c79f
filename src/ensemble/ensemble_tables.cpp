#include "ensemble/ensemble_tables.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "products/csv.hpp"
#include "products/text_file.hpp"

namespace talus::ensemble {
namespace {

std::string run_csv(const EnsembleResult& result) {
    std::string header = "run,status";
    for (const Factor& f : result.runs->plan().factors) header += "," + f.key;
    for (const Measure& m : result.measures) header += "," + m.key;
    products::Csv csv(header + ",simulated_time_s,wall_time_s,particles,beyond_limits,hash,fault");
    for (const RunRecord& run : result.reduction.runs) {
        csv.number(static_cast<double>(run.run)).word(run.complete() ? "complete" : "failed");
        for (const std::string& value : run.values) csv.word(value);
        for (std::size_t m = 0; m < result.measures.size(); ++m)
            csv.number(m < run.results.size() ? run.results[m] : observe::never);
        csv.number(run.simulated_time).number(run.wall_time).number(run.particles > 0 ? run.particles : observe::never);
        csv.word(run.verdict.keys()).word(run.hash).word(run.fault);
        csv.end_row();
    }
    return csv.text();
}

std::string building_csv(const EnsembleResult& result) {
    products::Csv csv(fmt::format("name,{}", fmt::join(building_columns(result), ",")));
    for (const BuildingOdds& b : result.reduction.buildings) {
        csv.word(b.name);
        for (const double number : building_numbers(b)) csv.number(number);
        csv.end_row();
    }
    return csv.text();
}

std::string distribution_csv(const EnsembleResult& result) {
    std::string header = "result,runs,mean,standard_deviation,least,greatest";
    for (const double p : table_percentiles) header += fmt::format(",p{:02.0f}", p);
    products::Csv csv(header);
    for (std::size_t m = 0; m < result.measures.size(); ++m) {
        std::vector<double> values = result.values_of(m);
        double mean = 0, square = 0;
        const auto n = static_cast<double>(values.size());
        for (const double v : values) mean += v / n;
        for (const double v : values) square += (v - mean) * (v - mean);
        csv.word(result.measures[m].key).number(n).number(values.empty() ? observe::never : mean);
        csv.number(values.size() > 1 ? std::sqrt(square / (n - 1)) : observe::never);
        csv.number(percentile(values, 0)).number(percentile(values, 100));
        for (const double p : table_percentiles) csv.number(percentile(values, p));
        csv.end_row();
    }
    return csv.text();
}

std::string two_models_csv(const TwoModels& both) {
    products::Csv csv("result,name,particles,particles_error,both,both_error,depth_averaged,factor");
    for (const std::vector<TwoModelMean>* part : {&both.results, &both.buildings}) {
        for (const TwoModelMean& m : *part) {
            csv.word(m.key).word(m.name);
            csv.row({m.mean.plain, m.mean.plain_error, m.mean.mean, m.mean.error, m.fast_mean, m.mean.factor});
        }
    }
    return csv.text();
}

std::string sensitivity_csv(const EnsembleResult& result) {
    const stats::SensitivityKind kind = result.sensitivity.front().kind;
    products::Csv csv(kind == stats::SensitivityKind::variance
                          ? "result,factor,first_order,first_order_low,first_order_high,total,total_low,total_high"
                      : kind == stats::SensitivityKind::screening
                          ? "result,factor,mean_absolute_effect,mean_effect,standard_deviation"
                          : "result,factor,rank_correlation");
    for (std::size_t m = 0; m < result.measures.size(); ++m) {
        const stats::Sensitivity& s = result.sensitivity[m];
        for (std::size_t k = 0; k < s.effects.size(); ++k) {
            const stats::FactorEffect& e = s.effects[k];
            csv.word(result.measures[m].key).word(result.runs->plan().factors[k].key);
            if (kind == stats::SensitivityKind::variance) {
                csv.row({e.first.value, e.first.low, e.first.high, e.total.value, e.total.low, e.total.high});
            } else if (kind == stats::SensitivityKind::screening) {
                csv.row({e.mean_size, e.mean, e.deviation});
            } else {
                csv.row({e.correlation});
            }
        }
    }
    return csv.text();
}

}  // namespace

std::vector<std::string> building_columns(const EnsembleResult& result) {
    std::vector<std::string> names = {"probability_hit"};
    for (const double p : result.runs->plan().thresholds.pressure) {
        names.push_back(fmt::format("probability_above_{}kPa", p));
    }
    names.insert(names.end(), {"peak_impact_pressure_p50_kPa", "peak_impact_pressure_p95_kPa", "peak_depth_p50_m",
                               "peak_depth_p95_m", "first_hit_p05_s", "first_hit_p50_s"});
    return names;
}

std::vector<double> building_numbers(const BuildingOdds& b) {
    std::vector<double> numbers = {b.hit};
    numbers.insert(numbers.end(), b.over_pressure.begin(), b.over_pressure.end());
    numbers.insert(numbers.end(), {b.median_pressure / 1e3, b.high_pressure / 1e3, b.median_depth, b.high_depth,
                                   b.early_hit, b.median_hit});
    return numbers;
}

Status write_ensemble_tables(const EnsembleResult& result, const std::filesystem::path& folder) {
    TALUS_TRY(products::write_text_file(folder / "runs.csv", run_csv(result)));
    TALUS_TRY(products::write_text_file(folder / "buildings.csv", building_csv(result)));
    TALUS_TRY(products::write_text_file(folder / "distributions.csv", distribution_csv(result)));
    TALUS_TRY(products::write_text_file(folder / "sensitivity.csv", sensitivity_csv(result)));
    if (!result.two_models) return {};
    return products::write_text_file(folder / "two_models.csv", two_models_csv(*result.two_models));
}

}  // namespace talus::ensemble
