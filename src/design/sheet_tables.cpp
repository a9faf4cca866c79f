#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/number_or_null.hpp"
#include "design/sheet_parts.hpp"
#include "report/number_text.hpp"

namespace talus::design {

using report::Json;

namespace {

Json percent(double share) {
    return report::fixed(100 * share, 1) + " %";
}

Json row_of(const char* name, const Spread& s, double factor, int digits) {
    const auto text = [&](double v) { return report::fixed(v * factor, digits); };
    return {{"name", name},
            {"median", text(s.median)},
            {"p84", text(s.p84)},
            {"p95", text(s.p95)},
            {"greatest", text(s.greatest)}};
}

std::string found_text(const LineResult& line) {
    return line.found ? report::plain(line.shown().height) : fmt::format("over {:g}", line.shown().height);
}

}  // namespace

Peaks peaks_of(const LineResult& line) {
    std::vector<double> force, pressure, run_up, retained, passing;
    for (const auto& run : line.shown().runs) {
        if (!run) continue;
        force.push_back(run->force / line.length);
        pressure.push_back(run->pressure);
        run_up.push_back(run->run_up);
        retained.push_back(run->retained);
        passing.push_back(run->passing());
    }
    return {spread_of(std::move(force)), spread_of(std::move(pressure)), spread_of(std::move(run_up)),
            spread_of(std::move(retained)), spread_of(std::move(passing))};
}

Approach approach_of(const DesignResult& result, const LineResult& line) {
    const DesignRequest& request = result.design->request;
    return {result.design->scene->spec.material.rest_density, line.speed.p95, line.depth.p95, request.boulder_diameter};
}

Json trials_table(const LineResult& line) {
    Json table = report::table({{"height", "Height", "m"},
                                {"runs", "Runs that pass", ""},
                                {"volume", "Volume that passes", ""},
                                {"enough", "Enough", ""}});
    for (const Trial& trial : line.trials) {
        Json row = {{"height", report::plain(trial.height)},
                    {"runs", percent(trial.passing_runs)},
                    {"volume", percent(trial.passing_volume)},
                    {"enough", trial.enough ? "yes" : "no"}};
        if (line.found && &trial == &line.shown()) row["row_style"] = "chosen";
        table["rows"].push_back(std::move(row));
    }
    return table;
}

Json spreads_table(const LineResult& line) {
    Json table = report::table({{"name", "Over the runs", ""},
                                {"median", "50 %", ""},
                                {"p84", "84 %", ""},
                                {"p95", "95 %", ""},
                                {"greatest", "Max", ""}});
    Json& rows = table["rows"];
    const Peaks peaks = peaks_of(line);
    Json first = row_of("Velocity, m/s", line.speed, 1, 1);
    first["heading"] = "Undisturbed flow at the line";
    first["heading_note"] = "without the barrier";
    rows.push_back(std::move(first));
    rows.push_back(row_of("Thickness, m", line.depth, 1, 2));
    rows.push_back(row_of("Peak discharge, m³/s", line.discharge, 1, 1));
    rows.push_back(row_of("Volume across, m³", line.volume, 1, 0));
    Json next = row_of("Force, kN per m", peaks.force_per_metre, 1e-3, 0);
    next["heading"] = "With the barrier";
    next["heading_note"] = fmt::format("{:g} m high", line.shown().height);
    rows.push_back(std::move(next));
    rows.push_back(row_of("Pressure of a patch, kPa", peaks.pressure, 1e-3, 0));
    rows.push_back(row_of("Run-up at the face, m", peaks.run_up, 1, 2));
    rows.push_back(row_of("Upstream of the barrier, m³", peaks.retained, 1, 0));
    rows.push_back(row_of("Passing, m³", peaks.passing, 1, 1));
    return table;
}

Json loads_table(const DesignResult& result) {
    const Approach approach = approach_of(result, result.lines.front());
    Json table = report::table({{"title", "Method", ""},
                                {"formula", "Law", ""},
                                {"pressure", "Pressure", "kPa"},
                                {"force", "Force", "kN/m"},
                                {"other", "Other", ""},
                                {"source", "Source", ""}});
    for (const LoadMethod& method : load_methods()) {
        const Load load = load_of(method, approach);
        std::string other = "–";
        if (std::isfinite(load.height)) other = report::fixed(load.height, 1) + " m";
        if (method.kind == LoadKind::boulder) {
            other = std::isfinite(load.force) ? report::fixed(load.force / 1e3, 0) + " kN" : "no --boulder-diameter";
        }
        table["rows"].push_back({{"title", method.title},
                                 {"formula", method.formula()},
                                 {"pressure", report::fixed(load.pressure / 1e3, 0)},
                                 {"force", report::fixed(load.force_per_metre / 1e3, 0)},
                                 {"other", other},
                                 {"source", method.source + (method.checked ? "" : " *")}});
    }
    return table;
}

Json lines_table(const DesignResult& result) {
    if (result.lines.size() < 2) return {};
    Json table = report::table({{"name", "Line", ""},
                                {"length", "Length", "m"},
                                {"height", "Least height", "m"},
                                {"face", "Face", "m²"},
                                {"capacity", "Holds, level", "m³"},
                                {"speed", "Velocity, 95 %", "m/s"},
                                {"depth", "Thickness, 95 %", "m"},
                                {"force", "Force, 95 %", "kN/m"}});
    for (const LineResult& line : result.lines) {
        table["rows"].push_back({{"name", line.line.name},
                                 {"length", report::fixed(line.length, 1)},
                                 {"height", found_text(line)},
                                 {"face", report::fixed(line.length * line.shown().height, 0)},
                                 {"capacity", report::fixed(line.level.volume, 0)},
                                 {"speed", report::fixed(line.speed.p95, 1)},
                                 {"depth", report::fixed(line.depth.p95, 2)},
                                 {"force", report::fixed(peaks_of(line).force_per_metre.p95 / 1e3, 0)}});
    }
    return table;
}

Json confirmed_table(const LineResult& line) {
    if (line.confirmed_runs.empty()) return {};
    Json table = report::table({{"run", "Run", ""},
                                {"search", "Passing, search", "m³"},
                                {"passing", "Passing, particles", "m³"},
                                {"run_up", "Run-up, particles", "m"},
                                {"force", "Force, particles", "kN/m"}});
    for (std::size_t k = 0; k < line.confirmed_runs.size(); ++k) {
        const auto& run = line.confirmed[k];
        const std::size_t number = line.confirmed_runs[k];
        Json row = {{"run", std::to_string(number)},
                    {"search", report::fixed(line.shown().runs[number]->passing(), 1)}};
        row["passing"] = run ? report::fixed(run->passing(), 1) : std::string("failed");
        row["run_up"] = run ? Json(report::fixed(run->run_up, 2)) : Json();
        row["force"] = run ? Json(report::fixed(run->force / line.length / 1e3, 0)) : Json();
        table["rows"].push_back(std::move(row));
    }
    return table;
}

std::vector<std::string> assumptions_of(const DesignResult& result) {
    const Design& design = *result.design;
    std::vector<std::string> factors;
    for (const ensemble::Factor& f : design.runs->plan().factors) {
        factors.push_back(f.key + " = " + f.distribution.written());
    }
    const LineResult& first = result.lines.front();
    const bool depth_averaged = design.scene->spec.solver.model == params::ModelChoice::depth_averaged;
    std::vector<std::string> made = {
        fmt::format("{} runs of every height and line with the same draws: {}.", design.runs->count(),
                    fmt::join(factors, "; ")),
        fmt::format("Model of the search: {}. {}", depth_averaged ? "depth-averaged" : "particles",
                    first.confirmed_runs.empty() ? "The height is not confirmed with particles in these runs."
                                                 : "The deciding runs were repeated with particles."),
        std::string("A run passes if more than a thousandth of its released volume gets over the crest, through ") +
            "openings, or round an end within half the line's length.",
        fmt::format(
            "Deposition slope: {:.1f}° ({}); the ground falls by {:.1f}° towards the line.",
            std::atan(first.deposition_slope) * 180 / std::numbers::pi,
            design.request.deposition_slope ? "as stated" : "half of the ground's, an assumption of this program",
            std::atan(first.slope) * 180 / std::numbers::pi),
        fmt::format(
            "Density of the debris {:g} kg/m³. The barrier has the thickness and the openings of the scene, and "
            "never fails.",
            design.scene->spec.material.rest_density)};
    return made;
}

std::vector<std::string> limits_of(const DesignResult& result) {
    std::vector<std::string> made = {
        "Velocity and thickness are peaks of the map cells along the line; they need not come together.",
        std::string("Force is that on all of the barrier over its length; it is higher where the flow comes. ") +
            "Filtered impulses of the model are no substitute for a code of practice.",
        std::string("Left out: single boulders and wood in the runs, repeated surges onto a filled barrier, scour, ") +
            "seepage, deformation, foundation, freeboard and factors of safety.",
        "The barrier is empty at every event. Capacity counts the ground between the perpendiculars at its ends.",
        "Percentiles are of the stated factors alone, by nearest rank: beyond the number of runs they say nothing."};
    for (const std::string& text : result.lines.front().not_monotone) made.push_back("Not monotone: " + text);
    made.emplace_back("Results support a design. A licensed engineer checks and signs.");
    return made;
}

}  // namespace talus::design
