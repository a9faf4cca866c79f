#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"

namespace talus::report {
namespace {

constexpr const char* base_style = "series base";
constexpr const char* base_name = "as given";

/// Colours repeat after eight variants, dashed.
std::string variant_style(std::size_t i) {
    constexpr std::size_t colours = 8;
    return fmt::format("series v{}{}", i % colours, i >= colours ? " dashed" : "");
}

std::string capitalised(std::string text) {
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

/// "Run-out" is not broken at its hyphen.
std::string heading(const Quantity& quantity) {
    std::string name = capitalised(quantity.name);
    if (const std::size_t hyphen = name.find('-'); hyphen != std::string::npos) name.replace(hyphen, 1, "\u2011");
    return name;
}

Json change_cell(const Quantity& quantity, const Change& change, bool judged) {
    if (change.verdict == Verdict::not_measured) return "not measured";
    Json cell = {{"value", std::isfinite(change.value) ? Json(change.value) : Json("not reached")},
                 {"change_percent", number_or_null<Json>(change.percent)}};
    cell["note"] = std::isfinite(change.percent)  ? formatted(change.percent, "d1") + " %"
                   : std::isfinite(quantity.base) ? "base reached it"
                                                  : "base did not";
    if (judged) cell["note_tone"] = change.verdict == Verdict::pass ? "good" : "bad";
    return cell;
}

void add_cost(Json& row, const RunResult& result) {
    const Observation& o = result.observation;
    row["compression"] =
        fmt::format("{} / {}", fixed(100 * o.worst_mean_compression, 2), fixed(100 * o.worst_max_compression, 1));
    row["particles"] = result.particles;
    row["wall_time_s"] = {{"value", result.wall_time}, {"format", result.wall_time < 10 ? "f1" : "f0"}};
}

Json result_cell(Verdict verdict) {
    if (verdict == Verdict::pass) return {{"value", "pass"}, {"tone", "good"}};
    if (verdict == Verdict::fail) return {{"value", "fail"}, {"tone", "bad"}};
    return {};
}

Json rows_of(const Comparison& comparison, const RunResult& base) {
    const bool judged = comparison.kind == ComparisonKind::convergence;
    std::vector<Column> columns = {{"run", "Run", ""}};
    for (const Quantity& q : comparison.quantities)
        columns.push_back({q.key, heading(q), q.unit, "s3", "", "not measured"});
    columns.push_back({"compression", "Compression", "mean / max, %", "", "n"});
    columns.push_back({"particles", "Particles", "", "f0"});
    columns.push_back({"wall_time_s", "Wall time", "s", "f0"});
    if (judged) columns.push_back({"result", "Result", "", "", "result", "–", true});
    Json all = table(columns, "comparison");
    Json first = {{"row_style", "base"}, {"run", {{"value", base_name}, {"sample", base_style}}}, {"result", ""}};
    for (const Quantity& q : comparison.quantities) first[q.key] = number_or_null<Json>(q.base);
    add_cost(first, base);
    all["rows"].push_back(std::move(first));
    for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
        const Comparison::Row& given = comparison.rows[i];
        Json row = {{"run", {{"value", given.run.variant.name}, {"sample", variant_style(i)}}}};
        if (given.run.result) {
            for (std::size_t k = 0; k < comparison.quantities.size(); ++k) {
                row[comparison.quantities[k].key] = change_cell(comparison.quantities[k], given.changes[k], judged);
            }
            add_cost(row, *given.run.result);
            if (judged) row["result"] = result_cell(given.verdict());
        } else {
            row["fills"] = columns[1].key;
            row[columns[1].key] = "missing: " + given.run.missing;
        }
        all["rows"].push_back(std::move(row));
    }
    return all;
}

struct Front {
    std::string style, name;
    std::vector<double> chainage, velocity, arrival;
};

Front front_of(std::string style, std::string name, const Observation& observation) {
    Front front{std::move(style), std::move(name), {}, {}, {}};
    for (const FrontSample& s : observation.front) {
        front.chainage.push_back(s.chainage);
        front.velocity.push_back(s.front_velocity);
        front.arrival.push_back(s.arrival_time);
    }
    return front;
}

/// Front velocity and arrival time against chainage, the runs over each other: the base first, which is drawn broad.
Json chart(const Comparison& comparison, const Scene& scene, const RunResult& base) {
    std::vector<Front> fronts{front_of(base_style, base_name, base.observation)};
    for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
        const VariantRun& run = comparison.rows[i].run;
        if (run.result) fronts.push_back(front_of(variant_style(i), run.variant.name, run.result->observation));
    }
    ValueRange x{0, 0}, speeds{0, 1}, times{0, 1};
    for (const Front& front : fronts) {
        for (const double c : front.chainage) x.include(c);
        for (const double v : front.velocity) speeds.include(v);
        for (const double t : front.arrival) times.include(t);
    }
    if (!(x.high > 0)) return {};
    include_observations(scene, x, speeds);
    x.high *= 1.03;
    speeds.high *= 1.08;
    times.high *= 1.08;
    Plot velocity(66, 14, 916, 250, x, speeds), arrival(66, 292, 916, 190, x, times);
    velocity.axes("", "front velocity, m/s");
    arrival.axes("chainage along the flow path, m", "arrival, s");
    velocity.key = arrival.key = Plot::Key::none;  // named above the figure
    for (const ObservationSpec& o : scene.spec.observations) {
        velocity.vertical(o.chainage, "observation-line");
        arrival.vertical(o.chainage, "observation-line");
    }
    for (const Front& front : fronts) {
        velocity.line(front.chainage, front.velocity, front.style, front.name);
        arrival.line(front.chainage, front.arrival, front.style);
    }
    mark_observations(scene, velocity);
    return chart_json({"Front velocity and arrival time against chainage, all runs",
                       1000,
                       527,
                       {std::move(velocity), std::move(arrival)}});
}

}  // namespace

Json comparison(const Comparison& comparison, const Scene& scene, const RunResult& base) {
    const bool judged = comparison.kind == ComparisonKind::convergence;
    const bool converged = judged && comparison.converged() == Answer::yes;
    Json not_measured = Json::array();
    for (const Quantity& q : comparison.quantities) {
        if (!q.not_measured.empty()) not_measured.push_back({{"name", q.name}, {"why", q.not_measured}});
    }
    Json named = Json::array();
    for (const Comparison::Row& row : comparison.rows) {
        const Variant& variant = row.run.variant;
        if (variant.about.empty()) continue;
        named.push_back({{"name", variant.name}, {"sets", variant.overrides}, {"about", variant.about}});
    }
    const bool velocities = std::any_of(comparison.quantities.begin(), comparison.quantities.end(),
                                        [](const Quantity& q) { return q.unit == "m/s"; });
    return {{"kind_of_comparison", judged ? "convergence" : "sensitivity"},
            {"convergence", judged},
            {"converged", converged},
            {"unconverged", judged && !converged},
            {"verdict", capitalised(comparison.verdict_text())},
            {"limit_percent", refinement_limit_percent},
            {"table", rows_of(comparison, base)},
            {"not_measured", std::move(not_measured)},
            {"has_named", !named.empty()},
            {"named", std::move(named)},
            {"without_velocities", !velocities},
            {"with_observations", !scene.spec.observations.empty()},
            {"chart", chart(comparison, scene, base)}};
}

}  // namespace talus::report
