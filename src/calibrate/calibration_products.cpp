#include "calibrate/calibration_products.hpp"

#include <system_error>

#include <fmt/format.h>

#include "calibrate/calibration_figures.hpp"
#include "core/hash.hpp"
#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "params/paths.hpp"
#include "params/scene_text.hpp"
#include "products/csv.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"

namespace talus::calibrate {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

void add_run_rows(products::Csv& csv, const Calibration& c, const std::vector<SearchRun>& runs,
                  const std::vector<ensemble::RunRecord>& records) {
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const SearchRun& run = runs[i];
        const ensemble::RunRecord& record = records[i];
        csv.number(static_cast<double>(i))
            .word(record.model)
            .word(search_phase_name(run.phase))
            .word(record.complete() ? "complete" : "failed");
        for (const std::string& value : record.values) csv.word(value);
        for (std::size_t j = 0; j < c.observed.size(); ++j)
            csv.number(j < run.predicted.size() ? run.predicted[j] : observe::never);
        csv.number(run.misfit).number(run.improvement).number(record.wall_time);
        csv.word(record.verdict.keys()).word(record.hash).word(record.fault);
        csv.end_row();
    }
}

std::string run_csv(const Calibration& c) {
    std::string header = "run,model,phase,status";
    for (const ensemble::Factor& f : c.factors) header += "," + f.key;
    for (const ensemble::ObservedValue& o : c.observed) header += "," + o.key;
    products::Csv csv(header + ",misfit,expected_improvement,wall_time_s,beyond_limits,hash,fault");
    add_run_rows(csv, c, c.result.runs, c.records);
    add_run_rows(csv, c, c.result.fast_runs, c.fast_records);
    return csv.text();
}

/// null where the scene's model alone was run.
Json fast_runs_json(const CalibrationSummary& s) {
    if (s.fast.made == 0) return {};
    return {{"model", "depth_averaged"},
            {"runs", s.fast.made},
            {"failed", s.fast.failed},
            {"wall_time_s", s.fast.wall_time}};
}

std::string factor_csv(const Calibration& c, const CalibrationSummary& s) {
    std::string header =
        "factor,best,median,low_95,high_95,prior_low_95,prior_high_95,share_of_prior_width,r_hat,effective_draws";
    for (const ensemble::Factor& f : c.factors) header += ",correlation_with_" + f.key;
    products::Csv csv(header);
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        const FactorResult& f = s.factors[k];
        csv.word(c.factors[k].key).number(f.best).number(f.median).number(f.low).number(f.high).number(f.prior_low);
        csv.number(f.prior_high).number(f.kept).number(f.r_hat).number(f.effective);
        for (std::size_t other = 0; other < s.factors.size(); ++other) {
            csv.number(other == k ? 1 : c.result.posterior.correlation(k, other));
        }
        csv.end_row();
    }
    return csv.text();
}

std::string observation_csv(const Calibration& c, const CalibrationSummary& s) {
    products::Csv csv(
        "observation,observed,uncertainty,best_run,deviation,posterior_median,posterior_low_95,posterior_high_95,"
        "emulator_rms_error,emulator_explained,run_noise,emulator_reach_told");
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        csv.word(c.observed[j].key);
        csv.row({c.observed[j].value, c.observed[j].uncertainty, o.best, o.deviation, o.median, o.low, o.high,
                 o.left_out, o.explained, o.noise, o.reach_told});
    }
    return csv.text();
}

std::string map_csv(const Calibration& c, const MisfitMap& map) {
    const bool plane = !map.y.empty();
    products::Csv csv(plane ? fmt::format("{},{},misfit", c.factors[0].key, c.factors[1].key)
                            : fmt::format("{},misfit", c.factors[0].key));
    for (std::size_t i = 0; i < map.misfit.size(); ++i) {
        const std::size_t column = i % map.cells, row = i / map.cells;
        csv.number((map.x[column] + map.x[column + 1]) / 2);
        if (plane) csv.number((map.y[row] + map.y[row + 1]) / 2);
        csv.number(map.misfit[i]).end_row();
    }
    return csv.text();
}

std::string draw_csv(const Calibration& c) {
    std::string header;
    for (const ensemble::Factor& f : c.factors) header += (header.empty() ? "" : ",") + f.key;
    products::Csv csv(header);
    for (const auto& draw : c.result.posterior.draws) {
        for (std::size_t k = 0; k < c.factors.size(); ++k) csv.number(c.factors[k].distribution.quantile(draw[k]));
        csv.end_row();
    }
    return csv.text();
}

/// A scene file of the run of least misfit. Paths within its folder are relative.
Status write_best_scene(const Calibration& c, const run::SceneSource& source, bool own_files, const fs::path& folder) {
    const fs::path to = (fs::absolute(folder) / "best_fit").lexically_normal();
    std::error_code error;
    fs::create_directories(to, error);
    if (error) return Error{fmt::format("{}: cannot be made: {}", to.string(), error.message())};
    fs::path file = source.file;
    if (own_files) {
        fs::copy(source.file.parent_path(), to, fs::copy_options::recursive | fs::copy_options::overwrite_existing,
                 error);
        if (error) return Error{fmt::format("{}: the scene cannot be copied: {}", to.string(), error.message())};
        file = to / source.file.filename();
    }
    std::vector<std::string> overrides = source.overrides;
    const std::vector<std::string>& best = c.best_overrides;
    overrides.insert(overrides.end(), best.begin(), best.end());
    TALUS_ASSIGN(params::SceneSpec spec, scene::parse_scene(file, overrides));
    params::replace_paths(spec, [&](const std::string& path) {
        const std::string place = fs::absolute(path).lexically_normal().string(), here = to.string() + "/";
        return place.starts_with(here) ? place.substr(here.size()) : place;
    });
    const ensemble::RunRecord& record = c.records[*c.result.best];
    const std::string header =
        fmt::format("The best fit of talus calibrate: run {} of {}, misfit {:.4g}. Running this gives hash {}.",
                    record.run, c.records.size(), c.result.runs[record.run].misfit, record.hash);
    return products::write_text_file(to / "scene.toml", write_scene(spec, header));
}

}  // namespace

Json calibration_json(const Calibration& c) {
    const CalibrationSummary s = summarise(c);
    const SearchResult& r = c.result;
    Json factors = Json::array(), observations = Json::array(), correlations = Json::array();
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        const FactorResult& f = s.factors[k];
        factors.push_back({{"key", c.factors[k].key},
                           {"prior", c.factors[k].distribution.text()},
                           {"best", f.best},
                           {"median", f.median},
                           {"interval_95", {f.low, f.high}},
                           {"prior_interval_95", {f.prior_low, f.prior_high}},
                           {"share_of_prior_width", f.kept},
                           {"r_hat", number_or_null<Json>(f.r_hat)},
                           {"effective_draws", f.effective}});
        Json row = Json::array();
        for (std::size_t other = 0; other < s.factors.size(); ++other) {
            row.push_back(other == k ? 1.0 : r.posterior.correlation(k, other));
        }
        correlations.push_back(row);
    }
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        observations.push_back({{"key", c.observed[j].key},
                                {"name", c.observed[j].name},
                                {"unit", c.observed[j].unit},
                                {"observed", c.observed[j].value},
                                {"uncertainty", c.observed[j].uncertainty},
                                {"best_run", number_or_null<Json>(o.best)},
                                {"deviation", number_or_null<Json>(o.deviation)},
                                {"posterior_median", o.median},
                                {"posterior_95", {o.low, o.high}},
                                {"emulator_rms_error", number_or_null<Json>(o.left_out)},
                                {"emulator_explained", number_or_null<Json>(o.explained)},
                                {"run_noise", number_or_null<Json>(o.noise)},
                                {"emulator_reach_told", o.reach_told}});
        if (s.fast.made == 0) continue;
        observations.back()["models"] = {{"pairs", o.pairs},
                                         {"difference", number_or_null<Json>(o.model_difference)},
                                         {"deviation", number_or_null<Json>(o.model_spread)},
                                         {"rho", o.rho}};
    }
    return {{"runs", r.runs.size()},
            {"complete", s.complete},
            {"failed", s.failed},
            {"verdict", verdict_json(ensemble::judge_together(c.records))},
            {"fast_runs", fast_runs_json(s)},
            {"best_run", *r.best},
            {"best_misfit", r.runs[*r.best].misfit},
            {"best_hash", c.records[*r.best].hash},
            {"factors", factors},
            {"correlations", correlations},
            {"observations", observations},
            {"convergence",
             {{"settled", r.settled},
              {"improvement_still_expected", r.improvement},
              {"emulator_share", r.emulator_share},
              {"accepted_steps", r.posterior.accepted},
              {"checks_within_95", number_or_null<Json>(s.checks_within)},
              {"shift_by_checks", r.shift}}},
            {"warnings", s.warnings}};
}

Status write_calibration(const Calibration& c, const run::SceneSource& source, bool own_files, const fs::path& folder) {
    const CalibrationSummary s = summarise(c);
    const MisfitMap map = misfit_map(c);
    TALUS_TRY(products::write_text_file(folder / "runs.csv", run_csv(c)));
    TALUS_TRY(products::write_text_file(folder / "factors.csv", factor_csv(c, s)));
    TALUS_TRY(products::write_text_file(folder / "observations.csv", observation_csv(c, s)));
    TALUS_TRY(products::write_text_file(folder / "misfit_map.csv", map_csv(c, map)));
    TALUS_TRY(products::write_text_file(folder / "posterior.csv", draw_csv(c)));
    TALUS_TRY(
        products::write_text_file(folder / "misfit_map.svg", report::chart_file(calibrate::misfit_chart(c, map))));
    TALUS_TRY(write_best_scene(c, source, own_files, folder));
    const Json results = calibration_results(c, s, map);
    TALUS_TRY(products::write_results(results, folder / "results.json"));
    TALUS_TRY(products::write_text_file(folder / "report.html", calibration_report(results)));
    return products::write_text_file(folder / "calibration.json", calibration_json(c).dump(2) + "\n");
}

}  // namespace talus::calibrate
