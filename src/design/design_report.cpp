#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "design/sheet_parts.hpp"
#include "design_report_files.hpp"
#include "products/csv.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"
#include "report/number_text.hpp"
#include "report/page.hpp"
#include "report/results.hpp"

namespace talus::design {
namespace {

using report::Json;

Json spread_json(const Spread& s) {
    return {{"p50", s.median}, {"p84", s.p84}, {"p95", s.p95}, {"max", s.greatest}};
}

Json storage_json(const Storage& s) {
    return {{"volume_m3", s.volume}, {"area_m2", s.area}, {"reach_m", s.reach}, {"open_sides", s.open_sides}};
}

Json trial_json(const Trial& trial) {
    Json passing = Json::array();
    for (const auto& run : trial.runs) passing.push_back(run ? Json(run->passing()) : Json());
    return {{"height_m", trial.height},
            {"passing_share_of_runs", trial.passing_runs},
            {"passing_share_of_volume", trial.passing_volume},
            {"enough", trial.enough},
            {"passing_m3", std::move(passing)}};
}

Json methods_json(const DesignResult& result, const LineResult& line) {
    Json list = Json::array();
    const Approach approach = approach_of(result, line);
    for (const LoadMethod& method : load_methods()) {
        const Load load = load_of(method, approach);
        list.push_back({{"name", method.name},
                        {"title", method.title},
                        {"formula", method.formula()},
                        {"coefficient", method.coefficient},
                        {"pressure_kPa", number_or_null<Json>(load.pressure / 1e3)},
                        {"force_kN_per_m", number_or_null<Json>(load.force_per_metre / 1e3)},
                        {"run_up_m", number_or_null<Json>(load.height)},
                        {"boulder_force_kN", number_or_null<Json>(load.force / 1e3)},
                        {"source", method.source},
                        {"checked", method.checked ? "text" : "memory"}});
    }
    return list;
}

Json line_json(const DesignResult& result, const LineResult& line) {
    Json points = Json::array(), trials = Json::array(), confirmed = Json::array();
    for (const PlanPoint& p : line.line.points) points.push_back({p.x, p.y});
    for (const Trial& trial : line.trials) trials.push_back(trial_json(trial));
    for (std::size_t k = 0; k < line.confirmed.size(); ++k) {
        const auto& run = line.confirmed[k];
        confirmed.push_back({{"run", line.confirmed_runs[k]},
                             {"passing_m3", run ? Json(run->passing()) : Json()},
                             {"passes", run ? Json(run->passes()) : Json()}});
    }
    const Peaks peaks = peaks_of(line);
    return {{"name", line.line.name},
            {"line_m", std::move(points)},
            {"length_m", line.length},
            {"least_height_m", line.found ? Json(line.shown().height) : Json()},
            {"shown_height_m", line.shown().height},
            {"undisturbed",
             {{"velocity_mps", spread_json(line.speed)},
              {"thickness_m", spread_json(line.depth)},
              {"peak_discharge_m3ps", spread_json(line.discharge)},
              {"volume_m3", spread_json(line.volume)}}},
            {"runs_with_barrier",
             {{"force_N_per_m", spread_json(peaks.force_per_metre)},
              {"pressure_Pa", spread_json(peaks.pressure)},
              {"run_up_m", spread_json(peaks.run_up)},
              {"retained_m3", spread_json(peaks.retained)},
              {"passing_m3", spread_json(peaks.passing)}}},
            {"capacity",
             {{"level", storage_json(line.level)},
              {"at_deposition_slope", storage_json(line.sloped)},
              {"deposition_slope_deg", std::atan(line.deposition_slope) * 180 / std::numbers::pi},
              {"ground_slope_deg", std::atan(line.slope) * 180 / std::numbers::pi}}},
            {"methods", methods_json(result, line)},
            {"not_monotone", line.not_monotone},
            {"heights", std::move(trials)},
            {"confirmed_with_particles", std::move(confirmed)}};
}

std::string allowed_text(const DesignRequest& request) {
    return fmt::format("at most {:g} % of the {}", 100 * request.share, request.of_volume ? "volume" : "runs");
}

/// What the runs with particles say of the height; nothing where there are none.
std::string confirmation_text(const LineResult& line) {
    const auto passes = [](const std::optional<BarrierRun>& run) { return run && run->passes(); };
    const auto passing = std::count_if(line.confirmed.begin(), line.confirmed.end(), passes);
    if (line.confirmed.empty()) return "";
    if (passing == 0) return fmt::format(" The {} deciding runs with particles confirm it.", line.confirmed.size());
    return fmt::format(" Not confirmed: with particles {} of the {} deciding runs pass.", passing,
                       line.confirmed.size());
}

Json key_figures_of(const DesignResult& result) {
    const LineResult& line = result.lines.front();
    const Peaks peaks = peaks_of(line);
    Json figures = Json::array();
    const auto add = [&](const char* key, const char* name, const std::string& value, const char* unit,
                         const std::string& note, bool alert = false) {
        figures.push_back(report::key_figure(key, name, value, "", unit, note, alert));
    };
    add("least_height", "Least height",
        line.found ? report::plain(line.shown().height) : fmt::format("over {:g}", line.shown().height), "m",
        allowed_text(result.design->request) + (line.found ? " passes" : " pass only with more height"), !line.found);
    add("capacity", "Holds, level", report::fixed(line.level.volume, 0), "m³",
        fmt::format("{} m³ at {:.1f}°", report::fixed(line.sloped.volume, 0),
                    std::atan(line.deposition_slope) * 180 / std::numbers::pi));
    add("approach", "Undisturbed flow", fmt::format("{:.1f}", line.speed.p95), "m/s",
        fmt::format("{:.2f} m thick; 95 % of the runs", line.depth.p95));
    add("force", "Force of the runs", report::fixed(peaks.force_per_metre.p95 / 1e3, 0), "kN/m",
        fmt::format("95 %; patch {} kPa", report::fixed(peaks.pressure.p95 / 1e3, 0)));
    return figures;
}

std::string runs_csv(const DesignResult& result) {
    products::Csv csv(
        "line,height_m,model,run,released_m3,over_m3,through_m3,around_m3,crossed_m3,passes,first_overtopping_s,"
        "retained_m3,filling_m,run_up_m,force_N_per_m,pressure_Pa,velocity_mps,thickness_m,peak_discharge_m3ps");
    for (const LineResult& line : result.lines) {
        const auto row = [&](double height, const char* model, std::size_t number, const BarrierRun& r) {
            csv.word(line.line.name).number(height).word(model).number(static_cast<double>(number));
            for (const double v : {r.released, r.over, r.through, r.around, r.crossed}) csv.number(v);
            csv.word(height > 0 ? (r.passes() ? "yes" : "no") : "");
            for (const double v : {r.first_over, r.retained, r.filling, r.run_up, r.force / line.length, r.pressure,
                                   r.speed, r.depth, r.peak_discharge}) {
                csv.number(v);
            }
            csv.end_row();
        };
        const auto rows = [&](double height, const std::vector<std::optional<BarrierRun>>& runs) {
            for (std::size_t k = 0; k < runs.size(); ++k) {
                if (runs[k]) row(height, "search", k, *runs[k]);
            }
        };
        rows(0, line.undisturbed);
        for (const Trial& trial : line.trials) rows(trial.height, trial.runs);
        for (std::size_t k = 0; k < line.confirmed.size(); ++k) {
            if (line.confirmed[k]) row(line.shown().height, "particles", line.confirmed_runs[k], *line.confirmed[k]);
        }
    }
    return csv.text();
}

std::string heights_csv(const DesignResult& result) {
    products::Csv csv("line,height_m,passing_share_of_runs,passing_share_of_volume,enough,least");
    for (const LineResult& line : result.lines) {
        for (const Trial& trial : line.trials) {
            csv.word(line.line.name).number(trial.height).number(trial.passing_runs).number(trial.passing_volume);
            csv.word(trial.enough ? "yes" : "no").word(line.found && &trial == &line.shown() ? "yes" : "no");
            csv.end_row();
        }
    }
    return csv.text();
}

std::string loads_csv(const DesignResult& result) {
    products::Csv csv(
        "line,method,velocity_mps,thickness_m,pressure_Pa,force_N_per_m,run_up_m,boulder_force_N,checked,"
        "source");
    for (const LineResult& line : result.lines) {
        const Approach approach = approach_of(result, line);
        for (const LoadMethod& method : load_methods()) {
            const Load load = load_of(method, approach);
            csv.word(line.line.name).word(method.name).number(approach.speed).number(approach.depth);
            for (const double v : {load.pressure, load.force_per_metre, load.height, load.force}) csv.number(v);
            csv.word(method.checked ? "text" : "memory").word(method.source);
            csv.end_row();
        }
    }
    return csv.text();
}

}  // namespace

nlohmann::ordered_json design_results(const DesignResult& result) {
    const DesignRequest& request = result.design->request;
    std::size_t failed = 0;
    Json lines = Json::array();
    for (const LineResult& line : result.lines) {
        failed += line.failed;
        lines.push_back(line_json(result, line));
    }
    Json all = report::results_head("talus design", *result.design->scene);
    const run::RunVerdict& verdict = result.lines.front().verdict;
    all.update(
        {{"status", {{"name", "complete"}, {"partial", false}, {"beyond_limits", report::beyond_limits(verdict)}}},
         {"verdict", verdict_json(verdict)},
         {"barrier", request.barrier},
         {"allowed", {{"share", request.share}, {"of", request.of_volume ? "volume" : "runs"}}},
         {"runs", result.design->runs->count()},
         {"failed", failed},
         {"any_failed", failed > 0},
         {"key_figures", key_figures_of(result)},
         {"trials", trials_table(result.lines.front())},
         {"spreads", spreads_table(result.lines.front())},
         {"loads", loads_table(result)},
         {"alternatives", lines_table(result)},
         {"confirmed", confirmed_table(result.lines.front())},
         {"assumptions", assumptions_of(result)},
         {"limits", limits_of(result)},
         {"lines", std::move(lines)}});
    return all;
}

Result<std::string> design_sheet(const DesignResult& result, const Json& results) {
    const LineResult& line = result.lines.front();
    Json page = results;
    page["report_name"] = "design";
    page["answer"] = line.found ? fmt::format("With {:g} m, {} passes. Search from {:g} to {:g} m.",
                                              line.shown().height, allowed_text(result.design->request),
                                              result.design->heights.front(), result.design->heights.back())
                                : fmt::format("No height up to {:g} m is enough: all numbers are those of {:g} m.",
                                              result.design->heights.back(), line.shown().height);
    page["answer"] = page["answer"].get<std::string>() + confirmation_text(line);
    page["section"] = section_svg(result);
    page["capacity"] = capacity_chart(result);
    page["times"] = time_chart(result);
    page["open_sides"] = line.level.open_sides
                             ? "The ground beside the ends is lower: without side walls it holds less."
                             : "The ground beside the ends holds it.";
    page["verdicts"] = Json::array({report::named_verdict("", results["verdict"])});
    return report::render(design_report_files::design_html, page);
}

Status write_design(const DesignResult& result) {
    const std::filesystem::path& folder = result.design->request.folder;
    TALUS_TRY(products::write_text_file(folder / "runs.csv", runs_csv(result)));
    TALUS_TRY(products::write_text_file(folder / "heights.csv", heights_csv(result)));
    TALUS_TRY(products::write_text_file(folder / "loads.csv", loads_csv(result)));
    const Json results = design_results(result);
    TALUS_TRY(products::write_results(results, folder / "results.json"));
    TALUS_ASSIGN(const std::string page, design_sheet(result, results));
    return products::write_text_file(folder / "design.html", page);
}

}  // namespace talus::design
