#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"
#include "run/words.hpp"

namespace talus::report {
namespace {

constexpr const char* base_style = "series base";
constexpr const char* base_name = "as given";

/// Colours repeat after eight variants, dashed.
std::string variant_style(std::size_t i) {
    constexpr std::size_t colours = 8;
    return fmt::format("series v{}{}", i % colours, i >= colours ? " dashed" : "");
}

/// "Run-out" is not broken at its hyphen.
std::string heading(const run::Quantity& quantity) {
    std::string name = run::capitalised(quantity.name);
    if (const std::size_t hyphen = name.find('-'); hyphen != std::string::npos) name.replace(hyphen, 1, "\u2011");
    return name;
}

Json change_cell(const run::Quantity& quantity, const run::Change& change, bool judged) {
    if (change.verdict == run::Verdict::not_measured) return "not measured";
    Json cell = {{"value", std::isfinite(change.value) ? Json(change.value) : Json("not reached")},
                 {"change_percent", number_or_null<Json>(change.percent)}};
    cell["note"] = std::isfinite(change.percent)  ? formatted(change.percent, "d1") + " %"
                   : std::isfinite(quantity.base) ? "base reached it"
                                                  : "base did not";
    if (judged) cell["note_tone"] = change.verdict == run::Verdict::pass ? "good" : "bad";
    return cell;
}

Json wall_time(const run::RunResult& result) {
    return {{"value", result.wall_time}, {"format", result.wall_time < 10 ? "f1" : "f0"}};
}

Json cost_of(const run::RunResult& result) {
    if (result.depth_averaged())
        return {{"compression", nullptr}, {"particles", nullptr}, {"wall_time_s", wall_time(result)}};
    const observe::Compression& c = result.observation.compression;
    return {{"compression",
             fmt::format("{} / {}", fixed(100 * c.worst_mean, 2), fixed(100 * c.worst_overcompressed_share, 1))},
            {"particles", result.particles},
            {"wall_time_s", wall_time(result)}};
}

Json missing_row(const std::vector<Column>& columns, Json row, const run::VariantRun& run) {
    row["fills"] = columns[1].key;
    row[columns[1].key] = "missing: " + run.missing;
    return row;
}

/// A row per run with its changes.
Json rows_of_runs(const run::Comparison& comparison, const run::RunResult& base) {
    std::vector<Column> columns = {{"run", "Run", ""}};
    for (const run::Quantity& q : comparison.quantities)
        columns.push_back({q.key, heading(q), q.unit, "s3", "", "not measured"});
    columns.push_back({"compression", "Compression", "mean / overcompressed, %", "", "n"});
    columns.push_back({"particles", "Particles", "", "f0"});
    columns.push_back({"wall_time_s", "Wall time", "s", "f0"});
    Json all = table(columns, "comparison");
    Json first = {{"row_style", "base"}, {"run", {{"value", base_name}, {"sample", base_style}}}};
    for (const run::Quantity& q : comparison.quantities) first[q.key] = number_or_null<Json>(q.base);
    first.update(cost_of(base));
    all["rows"].push_back(std::move(first));
    for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
        const run::Comparison::Row& given = comparison.rows[i];
        Json row = {{"run", {{"value", given.run.variant.name}, {"sample", variant_style(i)}}}};
        if (!given.run.result) {
            all["rows"].push_back(missing_row(columns, std::move(row), given.run));
            continue;
        }
        for (std::size_t k = 0; k < comparison.quantities.size(); ++k) {
            row[comparison.quantities[k].key] = change_cell(comparison.quantities[k], given.changes[k], false);
        }
        row.update(cost_of(*given.run.result));
        all["rows"].push_back(std::move(row));
    }
    return all;
}

/// A row per quantity with its limit, a column per run: there are few runs and, with buildings, many quantities.
Json rows_of_quantities(const run::Comparison& comparison, const run::RunResult& base) {
    std::vector<Column> columns = {{"quantity", "Quantity", ""}, {"base", base_name, "", "s3", "", "not measured"}};
    const auto key_of = [](std::size_t i) { return fmt::format("run_{}", i); };
    for (std::size_t i = 0; i < comparison.rows.size(); ++i)
        columns.push_back({key_of(i), run::capitalised(comparison.rows[i].run.variant.name), "", "s3"});
    columns.push_back({"limit", "Limit", "%", "s3"});
    Json all = table(columns, "comparison");
    const auto add = [&](Json row, const auto& cell) {
        for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
            const run::Comparison::Row& run = comparison.rows[i];
            row[key_of(i)] = run.run.result ? cell(run) : Json("missing");
        }
        all["rows"].push_back(std::move(row));
    };
    for (std::size_t k = 0; k < comparison.quantities.size(); ++k) {
        const run::Quantity& q = comparison.quantities[k];
        Json row = {{"quantity", run::capitalised(q.name) + (q.unit.empty() ? "" : ", " + q.unit)},
                    {"base", number_or_null<Json>(q.base)}};
        row["limit"] = q.limit_percent > 0 ? Json(q.limit_percent) : Json("the same");
        add(std::move(row), [&](const run::Comparison::Row& run) { return change_cell(q, run.changes[k], true); });
    }
    const auto overcompressed = [](const run::RunResult& result) { return cost_of(result)["compression"]; };
    add({{"quantity", "Compression, mean / overcompressed, %"}, {"base", overcompressed(base)}, {"limit", ""}},
        [&](const run::Comparison::Row& run) { return overcompressed(*run.run.result); });
    add({{"quantity", "Particles"}, {"base", {{"value", base.particles}, {"format", "f0"}}}, {"limit", ""}},
        [](const run::Comparison::Row& run) {
            return Json{{"value", run.run.result->particles}, {"format", "f0"}};
        });
    add({{"quantity", "Wall time, s"}, {"base", wall_time(base)}, {"limit", ""}},
        [](const run::Comparison::Row& run) { return wall_time(*run.run.result); });
    return all;
}

struct Front {
    std::string style, name;
    std::vector<double> chainage, velocity, arrival;
};

Front front_of(std::string style, std::string name, const observe::Observation& observation) {
    Front front{std::move(style), std::move(name), {}, {}, {}};
    for (const observe::FrontSample& s : observation.front) {
        front.chainage.push_back(s.chainage);
        front.velocity.push_back(s.front_velocity);
        front.arrival.push_back(s.arrival_time);
    }
    return front;
}

Json chart(const scene::Scene& scene, const std::vector<Front>& fronts) {
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
    for (const params::ObservationSpec& o : scene.spec.observations) {
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

Json fronts_chart(const scene::Scene& scene, const std::vector<NamedRun>& runs) {
    std::vector<Front> fronts;
    for (const NamedRun& run : runs) {
        const std::string style = fronts.empty() ? base_style : variant_style(fronts.size() - 1);
        fronts.push_back(front_of(style, run.name, run.result->observation));
    }
    return chart(scene, fronts);
}

Json comparison(const run::Comparison& comparison, const scene::Scene& scene, const run::RunResult& base) {
    const bool judged = comparison.kind == run::ComparisonKind::convergence;
    const bool converged = judged && comparison.converged() == run::Answer::yes;
    Json not_measured = Json::array();
    for (const run::Quantity& q : comparison.quantities) {
        if (!q.not_measured.empty()) not_measured.push_back({{"name", q.name}, {"why", q.not_measured}});
    }
    Json named = Json::array();
    for (const run::Comparison::Row& row : comparison.rows) {
        const run::Variant& variant = row.run.variant;
        if (variant.about.empty()) continue;
        named.push_back({{"name", variant.name}, {"sets", variant.overrides}, {"about", variant.about}});
    }
    const bool velocities = std::any_of(comparison.quantities.begin(), comparison.quantities.end(),
                                        [](const run::Quantity& q) { return q.key.starts_with("front_velocity"); });
    Json missing = Json::array(), warnings = Json::array();
    for (const run::Comparison::Row& row : comparison.rows) {
        if (!row.run.result) continue;
        for (const std::string& warning : judge(*row.run.result).warnings()) {
            warnings.push_back({{"name", row.run.variant.name}, {"warning", warning}});
        }
    }
    for (const run::Comparison::Row& row : comparison.rows) {
        if (!row.run.result) missing.push_back({{"name", row.run.variant.name}, {"why", row.run.missing}});
    }
    std::vector<Front> fronts{front_of(base_style, base_name, base.observation)};
    for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
        const run::VariantRun& run = comparison.rows[i].run;
        if (run.result) fronts.push_back(front_of(variant_style(i), run.variant.name, run.result->observation));
    }
    return {{"kind_of_comparison", judged ? "convergence" : "sensitivity"},
            {"convergence", judged},
            {"converged", converged},
            {"not_known", judged && comparison.converged() == run::Answer::unknown},
            {"verdict", run::capitalised(comparison.verdict_text())},
            {"counting_force_percent", 100 * run::counting_force_share},
            {"table", judged ? rows_of_quantities(comparison, base) : rows_of_runs(comparison, base)},
            {"not_measured", std::move(not_measured)},
            {"missing", judged ? std::move(missing) : Json::array()},
            {"warnings", std::move(warnings)},
            {"has_named", !named.empty()},
            {"named", std::move(named)},
            {"without_velocities", !velocities},
            {"with_observations", !scene.spec.observations.empty()},
            {"chart", chart(scene, fronts)}};
}

}  // namespace talus::report
