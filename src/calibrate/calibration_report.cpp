#include <cmath>
#include <string>

#include <fmt/format.h>

#include "calibrate/calibration_figures.hpp"
#include "calibrate/calibration_products.hpp"
#include "calibration_report_files.hpp"
#include "core/number_or_null.hpp"
#include "params/fields.hpp"
#include "report/number_text.hpp"
#include "report/page.hpp"
#include "report/results.hpp"
#include "report/table.hpp"

namespace talus::calibrate {

using namespace report;

namespace {

Json key_figures_of(const Calibration& c, const CalibrationSummary& s) {
    const SearchRun& best = c.result.runs[*c.result.best];
    Json all = Json::array();
    all.push_back(key_figure(
        "least_misfit", "Least misfit", best.misfit, "s3", "",
        fmt::format("{} observation{}; run {}", c.observed.size(), c.observed.size() == 1 ? "" : "s", *c.result.best)));
    for (std::size_t k = 0; k < std::min<std::size_t>(2, s.factors.size()); ++k) {
        const FactorResult& f = s.factors[k];
        all.push_back(key_figure(c.factors[k].key, shortened(c.factors[k].key, 34), number_or_null<Json>(f.median),
                                 "s3", "",
                                 fmt::format("95 %: {} to {}; best fit {}", significant(f.low, 3),
                                             significant(f.high, 3), significant(f.best, 3))));
    }
    const std::string ending = s.failed > 0       ? fmt::format("{} failed", s.failed)
                               : c.result.settled ? "ended: no further gain expected"
                                                  : "stopped at the maximum number";
    all.push_back(s.fast.made == 0
                      ? key_figure("runs", "Runs", s.complete, "", "", ending)
                      : key_figure("runs", "Runs of particles", s.complete, "", "",
                                   fmt::format("beside {} of the depth-averaged model; {}", s.fast.made, ending)));
    return all;
}

std::string unit_of(const std::string& key) {
    const std::size_t dot = key.find('.');
    const params::Section* section = params::find_section(key.substr(0, std::min(dot, key.find('['))));
    const params::Parameter* parameter = section != nullptr ? section->find(key.substr(dot + 1)) : nullptr;
    if (parameter == nullptr) return "";
    return parameter->unit == "m3" ? "m³" : parameter->unit;
}

Json factors_of(const Calibration& c, const CalibrationSummary& s) {
    Json rows = table({{"key", "Factor", "", "", "code"},
                       {"before", "Before", ""},
                       {"best", "Best fit", "", "s4"},
                       {"median", "Median", "", "s3"},
                       {"low", "95 % from", "", "s3"},
                       {"high", "to", "", "s3"},
                       {"kept_percent", "Width left", "%", "f0"},
                       {"unit", "Unit", "", "", "", ""}});
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        const FactorResult& f = s.factors[k];
        rows["rows"].push_back({{"key", c.factors[k].key},
                                {"before", c.factors[k].distribution.text()},
                                {"best", number_or_null<Json>(f.best)},
                                {"median", number_or_null<Json>(f.median)},
                                {"low", number_or_null<Json>(f.low)},
                                {"high", number_or_null<Json>(f.high)},
                                {"kept_percent", number_or_null<Json>(100 * f.kept)},
                                {"unit", unit_of(c.factors[k].key)}});
    }
    return rows;
}

Json correlations_of(const Calibration& c) {
    std::vector<Column> columns = {{"factor", "", "", "", "code"}};
    for (const ensemble::Factor& f : c.factors) columns.push_back({f.key, f.key, "", "f2"});
    Json rows = table(columns);
    for (std::size_t k = 0; k < c.factors.size(); ++k) {
        Json row = {{"factor", c.factors[k].key}};
        for (std::size_t other = 0; other < c.factors.size(); ++other) {
            row[c.factors[other].key] = number_or_null<Json>(other == k ? 1 : c.result.posterior.correlation(k, other));
        }
        rows["rows"].push_back(std::move(row));
    }
    return rows;
}

Json observations_of(const Calibration& c, const CalibrationSummary& s) {
    Json rows = table({{"name", "Observation", ""},
                       {"observed", "Observed", "", "", "n"},
                       {"best", "Best fit", "", "s3"},
                       {"deviation", "Off by", "", "f1"},
                       {"low", "Expected, 95 % from", "", "s3"},
                       {"high", "to", "", "s3"},
                       {"emulator_error", "Emulator error", "", "s2"},
                       {"noise", "Noise of runs", "", "s2"},
                       {"unit", "Unit", "", "", "", ""}});
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        const ensemble::ObservedValue& observed = c.observed[j];
        const char* side = observed.kind == ensemble::ObservedValue::Kind::at_least ? "≥ "
                           : observed.kind == ensemble::ObservedValue::Kind::below  ? "< "
                                                                                    : "";
        rows["rows"].push_back(
            {{"name", observed.name},
             {"observed",
              fmt::format("{}{} ± {}", side, significant(observed.value, 3), significant(observed.uncertainty, 2))},
             {"best", number_or_null<Json>(o.best)},
             {"deviation",
              {{"value", number_or_null<Json>(o.deviation)}, {"tone", std::abs(o.deviation) > 2 ? "bad" : "good"}}},
             {"low", number_or_null<Json>(o.low)},
             {"high", number_or_null<Json>(o.high)},
             {"emulator_error", number_or_null<Json>(o.left_out)},
             {"noise", number_or_null<Json>(o.noise)},
             {"unit", observed.unit}});
    }
    return rows;
}

Json convergence_of(const Calibration& c, const CalibrationSummary& s) {
    Json rows = Json::array();
    const auto row = [&](const std::string& name, const std::string& text) { rows.push_back(fact(name, text)); };
    const SearchResult& r = c.result;
    row("Less misfit still expected", significant(r.improvement, 2));
    row("Emulators beside observations",
        fmt::format("{} standard deviations, over the posterior", fixed(r.emulator_share, 2)));
    row("Checks within their 95 %", std::isfinite(s.checks_within)
                                        ? fmt::format("{} % of {} results of runs drawn from the posterior",
                                                      fixed(100 * s.checks_within, 0), r.checks.size())
                                        : std::string("none were run"));
    row("Change by the checks", fmt::format("{} standard deviations, of any median", fixed(r.shift, 2)));
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        row("Chains of " + c.factors[k].key, fmt::format("R-hat {}, {} effective draws", fixed(s.factors[k].r_hat, 3),
                                                         fixed(s.factors[k].effective, 0)));
    }
    row("Accepted steps", fmt::format("{} %", fixed(100 * r.posterior.accepted, 0)));
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        row("Emulator of " + c.observed[j].name,
            fmt::format(
                "tells {} % of the variance of runs that it does not know, and of {} % of them whether debris comes",
                fixed(100 * s.observations[j].explained, 1), fixed(100 * s.observations[j].reach_told, 0)));
    }
    for (std::size_t j = 0; j < s.observations.size() && s.fast.made > 0; ++j) {
        const ObservationResult& o = s.observations[j];
        const std::string& unit = c.observed[j].unit;
        row("Particles less depth-averaged, " + c.observed[j].name,
            o.pairs == 0 ? std::string("no run of both has a value")
                         : fmt::format("{} ± {} {} in {} pairs of runs; the emulator takes the fast model times {}",
                                       significant(o.model_difference, 3), significant(o.model_spread, 2), unit,
                                       o.pairs, fixed(o.rho, 2)));
    }
    return rows;
}

/// null where the scene's model alone was run.
Json fast_of(const Calibration& c, const CalibrationSummary& s) {
    if (s.fast.made == 0) return {};
    return {{"model", "depth_averaged"},
            {"runs", s.fast.made},
            {"failed", s.fast.failed},
            {"wall_time_s", s.fast.wall_time},
            {"particle_runs", c.result.runs.size()}};
}

}  // namespace

Json calibration_results(const Calibration& c, const CalibrationSummary& s, const MisfitMap& map) {
    double wall = 0;
    for (const ensemble::RunRecord& record : c.records) wall += record.wall_time;
    Json all = results_head("talus calibration", *c.scene);
    const run::RunVerdict own = judge_together(c.records), fast = judge_together(c.fast_records);
    all.update({{"status",
                 {{"name", "complete"},
                  {"partial", false},
                  {"beyond_limits", report::beyond_limits(run::judge_together({own, fast}))}}},
                {"verdict", verdict_json(own)},
                {"best_verdict", verdict_json(c.records[*c.result.best].verdict)},
                {"fast_verdict", c.fast_records.empty() ? Json() : Json(verdict_json(fast))},
                {"key_figures", key_figures_of(c, s)},
                {"warnings", s.warnings},
                {"factors", factors_of(c, s)},
                {"misfit", chart_json(misfit_chart(c, map))},
                {"more_factors", c.factors.size() > 2},
                {"draws", c.result.posterior.draws.size()},
                {"factor_chart", chart_json(factor_chart(c, s))},
                {"correlations", correlations_of(c)},
                {"observation_chart", chart_json(observation_chart(c, s))},
                {"observations", observations_of(c, s)},
                {"convergence_chart", chart_json(convergence_chart(c))},
                {"convergence", convergence_of(c, s)},
                {"chains", chain_count},
                {"fast", fast_of(c, s)},
                {"wall_time_s", wall}});
    return all;
}

std::string calibration_report(const Json& results) {
    Json page = results;
    page["report_name"] = "calibration report";
    page["masthead"] = "Back-analysis of a landslide from field observations";
    const bool both = !results["fast_verdict"].is_null();
    page["verdicts"] =
        Json::array({report::named_verdict("Best fit", results["best_verdict"]),
                     report::named_verdict(both ? "All runs of particles" : "All runs", results["verdict"])});
    if (both)
        page["verdicts"].push_back(
            report::named_verdict("All runs of the depth-averaged model", results["fast_verdict"]));
    page["has_warnings"] = !results["warnings"].empty();
    page["maps"] = nullptr;
    return render(calibration_report_files::calibration_html, page);
}

}  // namespace talus::calibrate
