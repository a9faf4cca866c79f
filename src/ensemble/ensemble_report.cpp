#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/try.hpp"
#include "ensemble/ensemble_figures.hpp"
#include "ensemble/ensemble_products.hpp"
#include "ensemble/predict.hpp"
#include "ensemble_report_files.hpp"
#include "params/fields.hpp"
#include "products/report_map.hpp"
#include "products/report_text.hpp"

namespace talus {

using namespace report;

namespace {

constexpr std::size_t most_buildings = 60;  // rows of the table

std::string percent(double share) {
    return std::isfinite(share) ? fixed(100 * share, share > 0 && share < 0.01 ? 1 : 0) + " %" : "–";
}

std::string card(const std::string& name, const std::string& value, const std::string& unit, const std::string& below) {
    return fmt::format(
        "<div class=\"card\"><dt>{}</dt><dd><strong>{}</strong> <span class=\"unit\">{}</span>"
        "<div class=\"below\">{}</div></dd></div>\n",
        name, value, unit, below);
}

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

std::string key_results(const EnsembleResult& result) {
    const Reduction& r = result.reduction;
    std::vector<double> run_out = result.values_of(0);
    const double median = percentile(run_out, 50);
    std::string below = r.failed > 0 ? fmt::format("{} failed, see below", r.failed) : "none failed";
    if (!r.missing.empty()) below += fmt::format("; {} of the plan not run", r.missing.size());
    std::string html =
        card("Complete runs", fmt::format("{}", r.complete), fmt::format("of {}", result.runs->count()), below);
    html += card("Run-out, median", fixed(median, 0), "m",
                 std::isnan(median) ? "no run reached the flow path"
                                    : fmt::format("5 to 95 %: {} to {} m", fixed(percentile(run_out, 5), 0),
                                                  fixed(percentile(run_out, 95), 0)));
    const double depth = result.runs->plan().thresholds.depth.front();
    if (const EnsembleMap* map = find_map(result, EnsembleMap::Kind::probability, 0, depth)) {
        html += card("Likely covered", fixed(area_above(map->grid, 0.5), 0), "m²",
                     fmt::format("deeper than {} m in more than half of the runs; {} m² in any", plain(depth),
                                 fixed(area_above(map->grid, 0), 0)));
    }
    const auto hit = std::count_if(r.buildings.begin(), r.buildings.end(), [](const auto& b) { return b.hit > 0; });
    const auto likely =
        std::count_if(r.buildings.begin(), r.buildings.end(), [](const auto& b) { return b.hit > 0.5; });
    html += card("Buildings hit", fmt::format("{}", likely),
                 r.buildings.empty() ? "" : fmt::format("of {}", r.buildings.size()),
                 r.buildings.empty() ? "the scene has none"
                                     : fmt::format("in more than half of the runs; {} in at least one", hit));
    return html;
}

/// The scene's own value of a factor's key, and its unit.
std::pair<std::string, std::string> as_given(const Scene& scene, const std::string& key) {
    std::pair<std::string, std::string> found;
    const bool has_index = key.find('[') != std::string::npos;
    for_each_value(scene.spec, [&](const Section& section, std::size_t index, const Parameter& parameter,
                                   const ParameterValue& value) {
        const bool plain_name = !has_index && index == 0 && key == section.name + "." + parameter.key;
        if (plain_name || key == key_path(section, index, parameter)) {
            const std::string text = plain_text(value);
            found = {text.empty() ? "not given" : text, parameter.unit};
        }
    });
    return found;
}

std::string factor_table(const EnsembleResult& result) {
    std::string html;
    for (const Factor& f : result.runs->plan().factors) {
        const auto [value, unit] = as_given(*result.scene, f.key);
        html += fmt::format("<tr><td><code>{}</code></td><td>{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n",
                            escape(f.key), escape(f.distribution.text()), escape(value),
                            unit == "m3" ? "m³" : escape(unit));
    }
    return html;
}

std::string design_text(const EnsembleResult& result) {
    const EnsemblePlan& plan = result.runs->plan();
    const std::size_t factors = plan.factors.size();
    std::string text;
    switch (plan.design) {
        case DesignKind::monte_carlo:
            text = fmt::format("{} independent draws (Monte Carlo)", result.runs->count());
            break;
        case DesignKind::latin_hypercube:
            text = fmt::format(
                "Latin hypercube of {} runs: every factor takes each of {} equal shares of its probability once",
                result.runs->count(), result.runs->count());
            break;
        case DesignKind::sobol:
            text = fmt::format("the first {} points of a shifted Sobol sequence", result.runs->count());
            break;
        case DesignKind::grid:
            text = fmt::format("a grid of {} runs, every combination of levels", result.runs->count());
            break;
        case DesignKind::saltelli:
            text = fmt::format("{} blocks of {} runs for Sobol indices (Saltelli et al. 2010)",
                               result.runs->count() / (factors + 2), factors + 2);
            break;
        case DesignKind::morris:
            text = fmt::format("{} trajectories of {} runs for elementary effects (Morris 1991)",
                               result.runs->count() / (factors + 1), factors + 1);
            break;
    }
    return fmt::format("Design: {}; seed {}. All other values are those of the scene; in every run {}.", text,
                       plan.seed, escape(fmt::format("{}", fmt::join(result.runs->fixed(), ", "))));
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
                                       : "impact pressure of the free flow",
                        over),
            0);
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
    percentile_map(2, 95, "Peak pressure of the free flow that 95 % of the runs do not exceed.", 0);
    percentile_map(3, 5, "Time by which debris has arrived in the earliest 5 % of the runs.", 1);
    percentile_map(4, 50, "Deposit depth that half of the runs do not exceed. Below 0.05 m nothing is drawn.", 2);

    content.cell = content.reached->geometry.cell;
    std::vector<double> run_out = result.values_of(0);
    content.farthest_chainage = percentile(run_out, 100);
    content.buildings.title = "Buildings, share of runs";
    content.buildings.class_names = {"never hit", "hit in up to 10 %", "hit in 10 – 50 %", "hit in over 50 %"};
    for (const BuildingOdds& b : result.reduction.buildings) {
        content.buildings.classes.push_back(b.hit == 0 ? 0 : b.hit <= 0.1 ? 1 : b.hit <= 0.5 ? 2 : 3);
        content.buildings.titles.push_back(
            fmt::format("{}: hit in {} of the runs", escape(b.name.empty() ? "Building" : b.name), percent(b.hit)));
    }
    return content;
}

std::string building_table(const EnsembleResult& result) {
    const auto& buildings = result.reduction.buildings;
    std::vector<const BuildingOdds*> hit;
    for (const BuildingOdds& b : buildings) {
        if (b.hit > 0) hit.push_back(&b);
    }
    if (hit.empty())
        return buildings.empty() ? "<p>The scene has no buildings.</p>" : "<p>No run reached a building.</p>";
    std::stable_sort(hit.begin(), hit.end(), [](const auto* a, const auto* b) { return a->hit > b->hit; });
    std::string html = "<div class=\"scroll\"><table class=\"data odds\"><thead><tr><th>Building</th><th>Hit</th>";
    for (const double p : result.runs->plan().thresholds.pressure) {
        html += fmt::format("<th>Over {} kPa</th>", plain(p));
    }
    html +=
        "<th class=\"n\">Pressure, median<br><small>kPa</small></th><th class=\"n\">Pressure, 95 "
        "%<br><small>kPa</small></th>"
        "<th class=\"n\">Depth at walls, 95 %<br><small>m</small></th><th class=\"n\">First hit, "
        "median<br><small>s</small></th></tr></thead><tbody>\n";
    const auto odds = [](double share) {
        return fmt::format("<td>{}<span class=\"share\"><i style=\"width:{}%\"></i></span></td>", percent(share),
                           coordinate(100 * share));
    };
    for (std::size_t i = 0; i < std::min(hit.size(), most_buildings); ++i) {
        const BuildingOdds& b = *hit[i];
        html += fmt::format("<tr><td><span class=\"dot hit-{}\"></span>{}</td>{}",
                            b.hit <= 0.1   ? 1
                            : b.hit <= 0.5 ? 2
                                           : 3,
                            b.name.empty() ? "unnamed" : escape(b.name), odds(b.hit));
        for (const double share : b.over_pressure) html += odds(share);
        html += fmt::format(
            "<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            significant(b.median_pressure / 1e3, 3), significant(b.high_pressure / 1e3, 3), fixed(b.high_depth, 2),
            fixed(b.median_hit, 1));
    }
    html += "</tbody></table></div>\n";
    html += fmt::format(
        "<p class=\"note\">{} of {} buildings were never hit{}. Pressure is the filtered force on the walls over the "
        "area in "
        "contact; a run that misses the building counts as 0 in percentiles of pressure and depth. The first hit has a "
        "median where half of the runs hit.</p>",
        buildings.size() - hit.size(), buildings.size(),
        hit.size() > most_buildings
            ? fmt::format("; {} more that were are in buildings.csv", hit.size() - most_buildings)
            : "");
    return html;
}

/// What was observed in the field, for the results that have it.
std::string observed_text(const Scene& scene, const std::string& key) {
    for (const ObservedValue& o : observed_values(scene)) {
        if (o.key != key) continue;
        const char* side = o.kind == ObservedValue::Kind::at_least ? "≥ "
                           : o.kind == ObservedValue::Kind::below  ? "< "
                                                                   : "";
        return fmt::format("{}{} ± {}", side, significant(o.value, 3), significant(o.uncertainty, 2));
    }
    return "";
}

std::string result_table(const EnsembleResult& result) {
    std::string html;
    for (std::size_t m = 0; m < result.measures.size(); ++m) {
        const Measure& measure = result.measures[m];
        std::vector<double> values = result.values_of(m);
        html += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td>", escape(measure.name), values.size());
        for (const double p : {5.0, 50.0, 95.0, 0.0, 100.0}) {
            html +=
                fmt::format("<td class=\"n\">{}</td>", measure.unit.empty() ? fixed(percentile(values, p), 0)
                                                                            : significant(percentile(values, p), 3));
        }
        html += fmt::format("<td>{}</td><td class=\"n\">{}</td></tr>\n",
                            measure.unit == "m2"    ? "m²"
                            : measure.unit == "deg" ? "°"
                                                    : measure.unit,
                            observed_text(*result.scene, measure.key));
    }
    return html;
}

std::string failed_section(const EnsembleResult& result) {
    const Reduction& r = result.reduction;
    if (r.failed == 0) return "";
    std::string html =
        "<section id=\"failed\">\n<h2>Failed runs</h2>\n<div class=\"scroll\"><table class=\"data\"><thead><tr><th "
        "class=\"n\">Run</th>";
    for (const Factor& f : result.runs->plan().factors) html += fmt::format("<th class=\"n\">{}</th>", escape(f.key));
    html += "<th>Fault</th></tr></thead><tbody>\n";
    std::size_t rows = 0;
    for (const RunRecord& run : r.runs) {
        if (run.complete() || ++rows > 40) continue;
        html += fmt::format("<tr><td class=\"n\">{}</td>", run.run);
        for (const std::string& value : run.values) html += fmt::format("<td class=\"n\">{}</td>", escape(value));
        html += fmt::format("<td class=\"fault\">{}</td></tr>\n", escape(run.fault));
    }
    return html +
           "</tbody></table></div>\n<p class=\"note\">Failed runs count neither as hits nor as misses; if they are "
           "many or lie at one end of a factor, the probabilities above are not to be trusted. All are in "
           "runs.csv.</p>\n</section>\n";
}

std::string method_text(const EnsembleResult& result) {
    std::vector<double> walls;
    for (const RunRecord& run : result.reduction.runs) walls.push_back(run.wall_time);
    const double sum = std::accumulate(walls.begin(), walls.end(), 0.0);
    return fmt::format(
        "<p>Every run is a full simulation; nothing is interpolated between runs. A percentile of n runs is the "
        "smallest value that "
        "at least that share of them does not exceed. A run that never came to a place counts there as depth, speed "
        "and pressure 0, "
        "and as no arrival. With {} runs a probability p has a standard error of √(p(1 − p)/n), at most {} percentage "
        "points, for independent draws.</p>\n"
        "<p>A run took {} s of one processor's wall time on average. Each run's values, results and checksum are in "
        "runs.csv; maps are GeoTIFF "
        "beside this page. The same plan and seed give the same numbers on any number of threads, shards or ranks.</p>",
        result.reduction.complete,
        fixed(50 / std::sqrt(std::max<double>(1, static_cast<double>(result.reduction.complete))), 1),
        significant(walls.empty() ? never : sum / static_cast<double>(walls.size()), 3));
}

}  // namespace

Result<std::string> render_ensemble_report(const EnsembleResult& result) {
    const Scene& scene = *result.scene;
    const SceneInfo& info = scene.spec.scene;
    const Reduction& r = result.reduction;
    TALUS_ASSIGN(const auto maps, render_maps(scene, content_of(result)));
    const bool partial = !r.missing.empty();
    const std::string date = fmt::format("{:%d %B %Y, %H:%M} UTC", fmt::gmtime(std::time(nullptr)));
    std::string banners;
    if (info.reconstruction) {
        banners +=
            "<div class=\"banner reconstruction\"><b>Reconstruction.</b> The inputs of this scene are reconstructed, "
            "not surveyed.</div>\n";
    }
    if (partial) {
        banners += fmt::format(
            "<div class=\"banner partial\"><b>{} of {} runs are missing.</b> The numbers below are those of the runs "
            "that are there.</div>\n",
            r.missing.size(), result.runs->count());
    }
    if (r.failed > 0) {
        banners += fmt::format(
            "<div class=\"banner unconverged\"><b>{} of {} runs failed.</b> They are left out of all probabilities; "
            "see <a href=\"#failed\">Failed runs</a>.</div>\n",
            r.failed, result.runs->count());
    }
    const std::string scatter = scatter_figure(result, maps.count + 2);
    const std::string sensitivity = scatter + sensitivity_figure(result, maps.count + (scatter.empty() ? 2 : 3));
    std::string style(ensemble_report_files::report_css);
    style += ensemble_report_files::ensemble_css;
    const std::string description =
        info.description.empty() ? "" : "<p class=\"lead\">" + escape(info.description) + "</p>";
    return fill(ensemble_report_files::ensemble_html,
                {{"title", escape(info.title)},
                 {"style", style},
                 {"script", ensemble_report_files::report_js},
                 {"page_note", info.reconstruction ? "Reconstruction, not surveyed" : ""},
                 {"date", date},
                 {"status", partial ? "partial" : "complete"},
                 {"status_class", partial ? "partial" : "complete"},
                 {"version", TALUS_VERSION},
                 {"description", description},
                 {"banners", banners},
                 {"key_results", key_results(result)},
                 {"factor_table", factor_table(result)},
                 {"design_text", design_text(result)},
                 {"map_definitions", maps.definitions},
                 {"map_figures", maps.figures},
                 {"map_read_out", maps.read_out},
                 {"crs", escape(scene.crs.label())},
                 {"complete", fmt::format("{}", r.complete)},
                 {"run_out_figure", run_out_figure(result, maps.count + 1)},
                 {"building_table", building_table(result)},
                 {"result_table", result_table(result)},
                 {"sensitivity", sensitivity},
                 {"failed", failed_section(result)},
                 {"method", method_text(result)}});
}

}  // namespace talus
