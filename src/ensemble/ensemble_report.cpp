#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "ensemble/ensemble_figures.hpp"
#include "ensemble/ensemble_products.hpp"
#include "ensemble/ensemble_report_tables.hpp"
#include "ensemble/predict.hpp"
#include "ensemble_report_files.hpp"
#include "params/fields.hpp"
#include "report/map.hpp"
#include "report/number_text.hpp"
#include "report/page.hpp"
#include "report/results.hpp"
#include "report/table.hpp"
#include "run/words.hpp"

namespace talus::ensemble {

using namespace report;

namespace {

/// The first map of a kind, map index and level; every result has it.
const EnsembleMap* find_map(const EnsembleResult& result, EnsembleMap::Kind kind, std::size_t map, double level) {
    for (const EnsembleMap& m : result.reduction.maps) {
        if (m.kind == kind && m.map == map && m.level == level) return &m;
    }
    return nullptr;
}

double area_above(const Grid<float>& grid, double share) {
    double cells = 0;
    for (const float v : grid.values) cells += v > share ? 1 : 0;
    return cells * grid.geometry.cell * grid.geometry.cell;
}

Json key_figures_of(const EnsembleResult& result) {
    const Reduction& r = result.reduction;
    std::vector<double> run_out = result.values_of(0);
    const double median = percentile(run_out, 50);
    std::string below = r.failed > 0 ? fmt::format("{} failed, see below", r.failed) : "none failed";
    if (!r.missing.empty()) below += fmt::format("; {} of the plan not run", r.missing.size());
    Json all = Json::array();
    all.push_back(key_figure("complete_runs", "Complete runs", r.complete, "",
                             fmt::format("of {}", result.runs->count()), below));
    all.push_back(key_figure("median_run_out_m", "Run-out along the flow, median", number_or_null<Json>(median), "f0",
                             "m",
                             std::isnan(median) ? "no debris ran out in any run"
                                                : fmt::format("5 to 95 %: {} to {} m", fixed(percentile(run_out, 5), 0),
                                                              fixed(percentile(run_out, 95), 0))));
    const double depth = result.runs->plan().thresholds.depth.front();
    if (const EnsembleMap* map = find_map(result, EnsembleMap::Kind::probability, 0, depth)) {
        all.push_back(key_figure("likely_covered_m2", "Likely covered", area_above(map->grid, 0.5), "f0", "m²",
                                 fmt::format("deeper than {} m in more than half of the runs; {} m² in any",
                                             plain(depth), fixed(area_above(map->grid, 0), 0))));
    }
    std::size_t count = 0, hit = 0, likely = 0;
    for (std::size_t i = 0; i < r.buildings.size(); ++i) {
        if (is_barrier(result, i)) continue;
        ++count;
        hit += r.buildings[i].hit > 0 ? 1 : 0;
        likely += r.buildings[i].hit > 0.5 ? 1 : 0;
    }
    all.push_back(key_figure(
        "buildings_likely_hit", "Buildings hit", likely, "", count == 0 ? "" : fmt::format("of {}", count),
        count == 0 ? "the scene has none" : fmt::format("in more than half of the runs; {} in at least one", hit)));
    return all;
}

/// The scene's own value of a factor's key, and its unit.
std::pair<std::string, std::string> as_given(const scene::Scene& scene, const std::string& key) {
    std::pair<std::string, std::string> found;
    const bool has_index = key.find('[') != std::string::npos;
    for_each_value(scene.spec, [&](const params::Section& section, std::size_t index,
                                   const params::Parameter& parameter, const params::ParameterValue& value) {
        const bool plain_name = !has_index && index == 0 && key == section.name + "." + parameter.key;
        if (plain_name || key == key_path(section, index, parameter)) {
            const std::string text = params::plain_text(value);
            found = {text.empty() ? "not given" : text, parameter.unit};
        }
    });
    return found;
}

Json factors_of(const EnsembleResult& result) {
    Json rows = table({{"key", "Factor", "", "", "code"},
                       {"distribution", "Distribution", ""},
                       {"as_given", "As given", "", "", "n"},
                       {"unit", "Unit", "", "", "", ""}});
    for (const Factor& f : result.runs->plan().factors) {
        const auto [value, unit] = as_given(*result.scene, f.key);
        rows["rows"].push_back({{"key", f.key},
                                {"distribution", f.distribution.text()},
                                {"as_given", value},
                                {"unit", unit == "m3" ? "m³" : unit}});
    }
    return rows;
}

std::string design_text(const EnsembleResult& result) {
    const EnsemblePlan& plan = result.runs->plan();
    const std::size_t factors = plan.factors.size();
    std::string text;
    switch (plan.design) {
        case stats::DesignKind::monte_carlo:
            text = fmt::format("{} independent draws (Monte Carlo)", result.runs->count());
            break;
        case stats::DesignKind::latin_hypercube:
            text = fmt::format(
                "Latin hypercube of {} runs: every factor takes each of {} equal shares of its probability once",
                result.runs->count(), result.runs->count());
            break;
        case stats::DesignKind::sobol:
            text = fmt::format("the first {} points of a shifted Sobol sequence", result.runs->count());
            break;
        case stats::DesignKind::grid:
            text = fmt::format("a grid of {} runs, every combination of levels", result.runs->count());
            break;
        case stats::DesignKind::saltelli:
            text = fmt::format("{} blocks of {} runs for Sobol indices (Saltelli et al. 2010)",
                               result.runs->count() / (factors + 2), factors + 2);
            break;
        case stats::DesignKind::morris:
            text = fmt::format("{} trajectories of {} runs for elementary effects (Morris 1991)",
                               result.runs->count() / (factors + 1), factors + 1);
            break;
    }
    return fmt::format("Design: {}; seed {}. All other values are those of the scene; in every run {}.", text,
                       plan.seed, fmt::join(result.runs->fixed(), ", "));
}

/// Classes of intensity, and the area where each is likely or possible.
Json intensity_of(const EnsembleResult& result) {
    const IntensityGuideline& guideline = *result.guideline;
    Json rows = table({{"name", "Intensity", ""},
                       {"criterion", "Its lowest class: peak depth h, peak speed v", ""},
                       {"in_half_m2", "In over half of the runs", "m²", "f0"},
                       {"in_any_m2", "In any run", "m²", "f0"}});
    for (std::size_t k = guideline.classes.size(); k-- > 0 && !result.reduction.intensity.empty();) {
        const Grid<float>& share = result.reduction.intensity[k];
        const bool top = k + 1 == guideline.classes.size();
        rows["rows"].push_back({{"name", guideline.classes[k].name + (top ? "" : " or higher")},
                                {"criterion", guideline.classes[k].criterion},
                                {"in_half_m2", area_above(share, 0.5)},
                                {"in_any_m2", area_above(share, 0)}});
    }
    return {{"guideline", guideline.name},
            {"citation", guideline.citation},
            {"remark", guideline.remark},
            {"table", std::move(rows)}};
}

std::string period_text(const std::vector<double>& periods, std::size_t k) {
    if (k == periods.size()) return fmt::format("over {} years", plain(periods.back()));
    return k == 0 ? fmt::format("up to {} years", plain(periods[0]))
                  : fmt::format("{} – {} years", plain(periods[k - 1]), plain(periods[k]));
}

/// The matrix of zones, and the area of each; null without a return period or a matrix.
Json zones_of(const EnsembleResult& result) {
    if (result.zones.values.empty()) return {};
    const HazardMatrix& matrix = *result.matrix;
    std::vector<Column> columns = {{"intensity", "Intensity", ""}};
    for (std::size_t p = 0; p <= matrix.periods.size(); ++p) {
        columns.push_back({fmt::format("period_{}", p), period_text(matrix.periods, p), ""});
    }
    Json fields = table(columns);
    for (std::size_t k = matrix.zone.size(); k-- > 0;) {
        Json row = {{"intensity", result.guideline->classes[k].name}};
        for (std::size_t p = 0; p <= matrix.periods.size(); ++p) {
            const int zone = matrix.zone[k][p];
            row[columns[p + 1].key] = zone > 0 ? Json(matrix.zones[static_cast<std::size_t>(zone - 1)].name) : Json();
        }
        fields["rows"].push_back(std::move(row));
    }
    Json areas = table({{"zone", "Zone", ""}, {"area_m2", "Area", "m²", "f0"}});
    for (std::size_t z = matrix.zones.size(); z-- > 0;) {
        double area = 0;
        for (const float zone : result.zones.values) {
            if (zone == static_cast<float>(z + 1)) area += result.zones.geometry.cell * result.zones.geometry.cell;
        }
        areas["rows"].push_back({{"zone", matrix.zones[z].name}, {"area_m2", area}});
    }
    return {{"return_period_years", *result.runs->plan().return_period},
            {"matrix", matrix.name},
            {"citation", matrix.citation},
            {"remark", matrix.remark},
            {"fields", std::move(fields)},
            {"areas", std::move(areas)}};
}

/// Which maps the page shows: all probabilities, and the percentiles that a planner asks for.
MapContent content_of(const EnsembleResult& result) {
    static constexpr const char* words[] = {"Depth", "Speed", "Pressure", "Arrival", "Deposit"};
    static constexpr const char* units[] = {"m", "m/s", "kPa"};
    MapContent content;
    const auto add = [&](const EnsembleMap& map, std::string tab, std::string caption, int digits) {
        content.layers.push_back({style_of(map), &map.grid, std::move(tab), std::move(caption), digits});
    };
    for (const EnsembleMap& map : result.reduction.maps) {
        if (map.kind != EnsembleMap::Kind::probability) continue;
        if (content.reached == nullptr) content.reached = &map.grid;
        const std::string over = fmt::format("{} {}", plain(map.level), units[map.map]);
        add(map, fmt::format("{} > {}", words[map.map], over),
            fmt::format("Share of the complete runs in which the {} exceeds {}. Below 1 % nothing is drawn.",
                        map.map == 0   ? "flow depth"
                        : map.map == 1 ? "depth-averaged speed"
                                       : "dynamic pressure of the free flow",
                        over),
            0);
    }
    const auto& classes = result.guideline->classes;
    for (std::size_t k = classes.size(); k-- > 0 && !result.reduction.intensity.empty();) {
        const bool top = k + 1 == classes.size();
        content.layers.push_back({intensity_odds_style(classes[k], top), &result.reduction.intensity[k],
                                  fmt::format("{} intensity{}", run::capitalised(classes[k].name), top ? "" : "+"),
                                  fmt::format("Share of the complete runs with {} intensity{}. Below 1 % nothing is "
                                              "drawn.",
                                              classes[k].name, top ? "" : " or higher"),
                                  0});
    }
    if (!result.zones.values.empty()) {
        content.layers.push_back({zone_style(*result.matrix), &result.zones, "Hazard zones",
                                  "Zones by intensity and how often it comes; see Intensity and zones below.", 0,
                                  result.matrix->name});
    }
    const auto percentile_map = [&](std::size_t map, double level, const char* caption, int digits) {
        if (const EnsembleMap* m = find_map(result, EnsembleMap::Kind::percentile, map, level)) {
            add(*m,
                level == 50 ? fmt::format("{}, median", words[map]) : fmt::format("{}, {:.0f} %", words[map], level),
                caption, digits);
        }
    };
    percentile_map(0, 50, "Peak depth that half of the runs do not exceed.", 2);
    percentile_map(0, 95, "Peak depth that 95 % of the runs do not exceed.", 2);
    percentile_map(1, 95, "Peak speed that 95 % of the runs do not exceed.", 1);
    percentile_map(2, 95, "Peak dynamic pressure of the free flow that 95 % of the runs do not exceed.", 0);
    percentile_map(3, 5, "Time by which debris has arrived in the earliest 5 % of the runs.", 1);
    percentile_map(4, 50, "Deposit depth that half of the runs do not exceed. Below 0.05 m nothing is drawn.", 2);

    content.cell = content.reached->geometry.cell;
    std::vector<double> run_out = result.values_of(0);
    content.farthest_chainage = percentile(run_out, 100);  // about, and only for the frame of the map
    content.buildings.title = "Buildings, share of runs";
    content.buildings.class_names = {"never hit", "hit in up to 10 %", "hit in 10 – 50 %", "hit in over 50 %"};
    for (const BuildingOdds& b : result.reduction.buildings) {
        content.buildings.classes.push_back(b.hit == 0 ? 0 : b.hit <= 0.1 ? 1 : b.hit <= 0.5 ? 2 : 3);
        content.buildings.titles.push_back(
            fmt::format("{}: hit in {} of the runs", b.name.empty() ? "Building" : b.name, percent(b.hit)));
    }
    return content;
}

double mean_wall_time(const EnsembleResult& result) {
    double sum = 0;
    for (const RunRecord& run : result.reduction.runs) sum += run.wall_time;
    return result.reduction.runs.empty() ? observe::never : sum / static_cast<double>(result.reduction.runs.size());
}

}  // namespace

Json ensemble_results(const EnsembleResult& result) {
    const Reduction& r = result.reduction;
    const bool partial = !r.missing.empty();
    const double complete = std::max<double>(1, static_cast<double>(r.complete));
    const run::RunVerdict verdict = judge_together(r.runs);
    Json all = results_head("talus ensemble", *result.scene);
    all.update({{"status",
                 {{"name", partial ? "runs are missing" : "complete"},
                  {"partial", partial},
                  {"beyond_limits", report::beyond_limits(verdict)}}},
                {"verdict", verdict_json(verdict)},
                {"runs", result.runs->count()},
                {"complete", r.complete},
                {"missing", r.missing.size()},
                {"failed", r.failed},
                {"key_figures", key_figures_of(result)},
                {"factors", factors_of(result)},
                {"design", design_text(result)},
                {"intensity", intensity_of(result)},
                {"zones", zones_of(result)},
                {"run_out", run_out_chart(result)},
                {"has_buildings", !r.buildings.empty()},
                {"buildings", buildings_of(result)},
                {"results", results_of(result)},
                {"scatter", scatter_chart(result)},
                {"sensitivity", sensitivity_data(result)},
                {"resampled_sets", 500},
                {"two_models", two_models_of(result)},
                {"failed_runs", failed_runs(result)},
                {"largest_standard_error_percent", 50 / std::sqrt(complete)},
                {"mean_wall_time_s", number_or_null<Json>(mean_wall_time(result))}});
    return all;
}

Result<std::string> ensemble_report(const EnsembleResult& result, const Json& results) {
    MapContent content = content_of(result);
    if (!results["status"]["beyond_limits"].is_null()) content.beyond_limits = results["status"]["beyond_limits"];
    TALUS_ASSIGN(auto maps, map_figures(*result.scene, content));
    Json page = results;
    page["report_name"] = "ensemble report";
    page["masthead"] = "Ensemble of landslide run-out simulations";
    page["maps"] = std::move(maps);
    page["verdicts"] = Json::array({report::named_verdict("", results["verdict"])});
    if (Json& sensitivity = page["sensitivity"]; !sensitivity.is_null()) {
        sensitivity["svg"] = sensitivity_svg(sensitivity);
    }
    return render(ensemble_report_files::ensemble_html, page);
}

}  // namespace talus::ensemble
