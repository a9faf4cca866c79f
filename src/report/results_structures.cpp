// Effect of debris on barriers, and the force on structures over time.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "core/decimals.hpp"
#include "core/number_or_null.hpp"
#include "report/intensity.hpp"
#include "report/map.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"

namespace talus::report {
namespace {

constexpr std::size_t max_lines = 8;  // of the figure: the number of colours in report.css
constexpr std::size_t max_nets = 4;   // a plot each
constexpr std::size_t max_rows = 30;  // of the table of buildings

/// Structures with a history to draw, those under the greatest force first.
std::vector<const observe::BuildingImpact*> drawn(const run::RunResult& result) {
    std::vector<const observe::BuildingImpact*> all;
    for (const observe::BuildingImpact& impact : result.observation.buildings) {
        if (impact.history.size() > 1 && impact.peak_force > 0) all.push_back(&impact);
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const auto* a, const auto* b) { return a->peak_force > b->peak_force; });
    if (all.size() > max_lines) all.resize(max_lines);
    return all;
}

std::string shown_name(const observe::BuildingImpact& impact) {
    return impact.name.empty() ? "unnamed" : impact.name;
}

Json seconds(double time) {
    return number_or_null<Json>(time);
}

/// {"name": ..., "time_s": ...} of those that have such a time; starting with the second, "another".
Json events(const std::vector<observe::BuildingImpact>& impacts, double observe::BuildingImpact::*time) {
    Json list = Json::array();
    for (const observe::BuildingImpact& impact : impacts) {
        if (std::isnan(impact.*time)) continue;
        list.push_back({{"name", shown_name(impact)}, {"time_s", impact.*time}, {"another", !list.empty()}});
    }
    return list;
}

/// Buildings or barriers that were removed during the run; null if none was.
Json removed(const std::vector<observe::BuildingImpact>& impacts, bool barriers) {
    std::vector<observe::BuildingImpact> those;
    std::copy_if(impacts.begin(), impacts.end(), std::back_inserter(those),
                 [&](const auto& impact) { return impact.is_barrier == barriers; });
    const Json list = events(those, &observe::BuildingImpact::removed_time);
    return list.empty() ? Json() : Json{{"list", list}};
}

/// Balance of the debris that reached a net, for each net that was reached.
Json net_balances(const std::vector<observe::BuildingImpact>& impacts) {
    Json list = Json::array();
    for (const observe::BuildingImpact& net : impacts) {
        if (!net.hit || std::isnan(net.passing_share)) continue;
        const double all = net.retained_volume + net.passed_volume + net.overtopped_volume;
        list.push_back({{"name", shown_name(net)},
                        {"passing_percent", 100 * net.passing_share},
                        {"arrived_m3", all},
                        {"retained_m3", net.retained_volume},
                        {"retained_percent", all > 0 ? Json(100 * net.retained_volume / all) : Json()},
                        {"passed_m3", net.passed_volume},
                        {"overtopped_m3", net.overtopped_volume},
                        {"peak_force_kN", net.peak_force / 1e3}});
    }
    return list;
}

/// Volumes retained by nets, passing them and overtopping them, over time.
Json net_chart(const run::RunResult& result) {
    std::vector<const observe::BuildingImpact*> nets;
    for (const observe::BuildingImpact& impact : result.observation.buildings) {
        if (!std::isnan(impact.passing_share) && impact.history.size() > 1) nets.push_back(&impact);
    }
    std::stable_sort(nets.begin(), nets.end(),
                     [](const auto* a, const auto* b) { return a->peak_force > b->peak_force; });
    if (nets.size() > max_nets) nets.resize(max_nets);
    if (nets.empty()) return {};
    constexpr double step = 270;
    Chart chart{"What nets retained and let through", 1000, step * static_cast<double>(nets.size()) + 20, {}};
    for (const observe::BuildingImpact* net : nets) {
        ValueRange time{0, 0}, volume{0, 1e-3};
        std::vector<double> t, retained, through, over;
        for (const observe::StructureSample& s : net->history) {
            t.push_back(s.time);
            retained.push_back(s.retained_volume);
            through.push_back(s.passed_volume);
            over.push_back(s.overtopped_volume);
            time.include(s.time);
            for (const double value : {retained.back(), through.back(), over.back()}) volume.include(value);
        }
        volume.high *= 1.05;
        Plot plot(66, 34 + step * static_cast<double>(chart.plots.size()), 640, 190, time, volume);
        plot.axes("time, s", "volume, m³");
        plot.line(t, retained, "series v0", "retained");
        plot.line(t, through, "series v1", "through");
        plot.line(t, over, "series v2", "over");
        if (!std::isnan(net->failure_time)) plot.vertical(net->failure_time, "toe-line");
        plot.label(time.high, volume.high, 24, 16, "start", "key", shortened(shown_name(*net), 34));
        chart.plots.push_back(std::move(plot));
    }
    return chart_json(chart);
}

Json building_rows(const scene::Scene& scene, const run::RunResult& result, std::vector<std::size_t> hit) {
    const auto& impacts = result.observation.buildings;
    std::stable_sort(hit.begin(), hit.end(), [&](std::size_t a, std::size_t b) {
        return impacts[a].peak_impact_pressure > impacts[b].peak_impact_pressure;
    });
    const IntensityGuideline& guideline = intensity_guideline(scene.spec.outputs.intensity_guideline);
    Json rows = table({{"name", "Building", ""},
                       {"first_hit_s", "First hit", "s", "f1"},
                       {"peak_force_kN", "Peak force", "kN", "s3"},
                       {"peak_impact_pressure_kPa", "Impact pressure", "kPa, highest patch", "s3", "", "–", true},
                       {"peak_dynamic_pressure_kPa", "Dynamic pressure", "kPa, ρv² to the wall", "s3"},
                       {"peak_depth_m", "Depth at walls", "m", fmt::format("f{}", length_decimals(scene, 2))},
                       {"intensity", "Intensity", guideline.name},
                       {"height_m", "Height", "m", fmt::format("f{}", length_decimals(scene, 1))}});
    for (std::size_t k = 0; k < std::min(max_rows, hit.size()); ++k) {
        const observe::BuildingImpact& b = impacts[hit[k]];
        const IntensityClass* intensity = guideline.class_of(b);
        Json name = {{"value", shown_name(b)}, {"mark", fmt::format("hit-{}", impact_class(b))}};
        if (!std::isnan(b.removed_time)) name["note"] = fmt::format("until {} s", fixed(b.removed_time, 1));
        Json height;
        if (hit[k] < scene.buildings.size()) {
            height = {{"value", scene.buildings[hit[k]].height}};
            if (scene.buildings[hit[k]].height_assumed) height["footnote"] = "a";
        }
        rows["rows"].push_back({{"name", std::move(name)},
                                {"first_hit_s", seconds(b.first_hit_time)},
                                {"peak_force_kN", b.peak_force / 1e3},
                                {"peak_impact_pressure_kPa", b.peak_impact_pressure / 1e3},
                                {"peak_dynamic_pressure_kPa", b.peak_dynamic_pressure / 1e3},
                                {"peak_depth_m", b.peak_depth},
                                {"intensity", intensity != nullptr ? Json(intensity->name) : Json()},
                                {"height_m", std::move(height)}});
    }
    return rows;
}

}  // namespace

Json buildings(const scene::Scene& scene, const run::RunResult& result) {
    const auto& impacts = result.observation.buildings;
    const std::size_t count = hits_among(impacts, false).all;
    if (count == 0) return {};
    std::vector<std::size_t> hit;
    for (std::size_t i = 0; i < impacts.size(); ++i) {
        if (impacts[i].hit && !impacts[i].is_barrier) hit.push_back(i);
    }
    const auto assumed = static_cast<std::size_t>(std::count_if(
        scene.buildings.begin(), scene.buildings.end(), [](const terrain::Building& b) { return b.height_assumed; }));
    return {{"count", plural(count, "building")},
            {"hit", hit.size()},
            {"none_hit", hit.empty()},
            {"table", hit.empty() ? Json() : building_rows(scene, result, hit)},
            {"shown", hit.size() > max_rows ? Json(max_rows) : Json()},
            {"removed", removed(impacts, false)},
            {"assumed_heights", assumed > 0 ? Json(assumed) : Json()}};
}

Json barriers(const run::RunResult& result) {
    const auto& impacts = result.observation.buildings;
    Json rows;
    if (std::any_of(impacts.begin(), impacts.end(), [](const auto& b) { return b.is_barrier; })) {
        const std::string volume = fmt::format("f{}", decimals_for(result.observation.volume_released, 1));
        std::vector<Column> columns = {{"name", "Barrier", ""},
                                       {"first_hit_s", "First hit", "s", "f1"},
                                       {"peak_force_kN", "Peak force", "kN", "s3"},
                                       {"peak_impact_pressure_kPa", "Impact pressure", "kPa", "s3"},
                                       {"impulse_kNs", "Impulse", "kN s", "s3"}};
        columns.insert(columns.end(), {{"overtopped_m3", "Over the crest", "m³", volume, "", "–", true},
                                       {"first_overtopped_s", "First over", "s", "f1"},
                                       {"passed_m3", "Through openings and meshes", "m³", volume},
                                       {"retained_m3", "Retained at the end", "m³", volume},
                                       {"peak_retained_m3", "Retained at most", "m³", volume},
                                       {"peak_filling_height_m", "Filled at most", "m", "f2"}});
        rows = table(columns);
        for (const observe::BuildingImpact& b : impacts) {
            if (!b.is_barrier) continue;
            rows["rows"].push_back({{"name", shown_name(b)},
                                    {"first_hit_s", seconds(b.first_hit_time)},
                                    {"peak_force_kN", b.peak_force / 1e3},
                                    {"peak_impact_pressure_kPa", b.peak_impact_pressure / 1e3},
                                    {"impulse_kNs", b.impulse / 1e3}});
            Json& row = rows["rows"].back();
            row.update({{"overtopped_m3", b.overtopped_volume},
                        {"first_overtopped_s", seconds(b.first_overtopping_time)},
                        {"passed_m3", b.passed_volume},
                        {"retained_m3", b.retained_volume},
                        {"peak_retained_m3", b.peak_retained_volume},
                        {"peak_filling_height_m", b.peak_filling_height}});
        }
    }
    return {{"failures", events(impacts, &observe::BuildingImpact::failure_time)},
            {"table", std::move(rows)},
            {"removed", removed(impacts, true)},
            {"nets", net_balances(impacts)},
            {"net_volumes", net_chart(result)}};
}

Json force_chart(const run::RunResult& result) {
    const std::vector<const observe::BuildingImpact*> all = drawn(result);
    if (all.empty()) return {};
    ValueRange time{0, 0}, forces{0, 0};
    for (const observe::BuildingImpact* impact : all) {
        for (const observe::StructureSample& s : impact->history) {
            time.include(s.time);
            forces.include(s.force / 1e3);
        }
    }
    forces.high = std::max(forces.high * 1.05, 1e-3);
    Plot plot(66, 24, 640, 250, time, forces);
    plot.axes("time, s", "force, kN");
    plot.key = Plot::Key::beside;
    for (std::size_t k = 0; k < all.size(); ++k) {
        std::vector<double> t, force;
        for (const observe::StructureSample& s : all[k]->history) {
            t.push_back(s.time);
            force.push_back(s.force / 1e3);
        }
        plot.line(t, force, fmt::format("series v{}", k), shortened(shown_name(*all[k]), 30));
        if (!std::isnan(all[k]->failure_time)) plot.vertical(all[k]->failure_time, "toe-line");
    }
    return chart_json({"Force on structures over time", 1000, 320, {std::move(plot)}});
}

}  // namespace talus::report
