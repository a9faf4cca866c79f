// Discharge through cross-sections over time.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"

namespace talus::report {
namespace {

constexpr std::size_t max_sections_drawn = 12;  // a row of plots each

Json section_rows(const std::vector<NamedRun>& runs) {
    std::vector<Column> columns = {{"section", "Cross-section", ""}};
    if (runs.size() > 1) columns.push_back({"model", "Model", ""});
    columns.insert(columns.end(), {{"peak_discharge_m3ps", "Peak discharge", "m³/s", "f2"},
                                   {"peak_time_s", "at", "s", "f1", "", "nothing passed"},
                                   {"passed_m3", "Passed", "m³", "f1"}});
    Json rows = table(columns);
    for (std::size_t k = 0; k < runs.front().result->observation.cross_sections.size(); ++k) {
        for (const NamedRun& run : runs) {
            const observe::DischargeRecord& record = run.result->observation.cross_sections.at(k);
            Json row = {{"section", record.section.name}};
            if (runs.size() > 1) row["model"] = run.name;
            row["peak_discharge_m3ps"] = record.peak_discharge;
            row["peak_time_s"] = number_or_null<Json>(record.peak_time);
            row["passed_m3"] = record.passed;
            rows["rows"].push_back(std::move(row));
        }
    }
    return rows;
}

/// A row of two plots per cross-section: discharge and the volume that has passed, a curve per run.
Json section_chart(const std::vector<NamedRun>& runs, const std::vector<std::size_t>& drawn) {
    constexpr double step = 190, height = 120, width = 410;
    const std::size_t count = std::min(max_sections_drawn, drawn.size());
    ValueRange time{0, 0};
    for (const NamedRun& run : runs) time.include(run.result->simulated_time);
    Chart chart{"Discharge through cross-sections", 1000, step * static_cast<double>(count) + 50, {}};
    for (std::size_t place = 0; place < count; ++place) {
        const std::size_t k = drawn[place];
        ValueRange discharges{0, 1e-3}, volumes{0, 1e-3};
        for (const NamedRun& run : runs) {
            for (const observe::DischargeSample& s : run.result->observation.cross_sections[k].rows) {
                discharges.include(1.1 * s.discharge);
                volumes.include(1.1 * s.passed);
            }
        }
        const double top = 34 + step * static_cast<double>(place);
        Plot discharge(66, top, width, height, time, discharges);
        Plot passed(66 + width + 90, top, width, height, time, volumes);
        discharge.axes("time, s", "discharge, m³/s");
        passed.axes("time, s", "passed, m³");
        discharge.key = passed.key = Plot::Key::none;
        for (std::size_t i = 0; i < runs.size(); ++i) {
            std::vector<double> t{0}, q{0}, v{0};
            for (const observe::DischargeSample& s : runs[i].result->observation.cross_sections[k].rows) {
                t.push_back(s.time);
                q.push_back(s.discharge);
                v.push_back(s.passed);
            }
            const std::string style = fmt::format("series v{}", i);
            discharge.line(t, q, style, place == 0 && runs.size() > 1 ? runs[i].name : "");
            passed.line(t, v, style);
        }
        const observe::DischargeRecord& record = runs.front().result->observation.cross_sections[k];
        discharge.label(time.low, discharges.high, 0, -8, "start", "note-strong", shortened(record.section.name, 40));
        chart.plots.push_back(std::move(discharge));
        chart.plots.push_back(std::move(passed));
    }
    return chart_json(chart);
}

}  // namespace

Json cross_sections(const std::vector<NamedRun>& runs) {
    const auto& records = runs.front().result->observation.cross_sections;
    if (records.empty()) return {};
    std::vector<std::size_t> drawn;
    for (std::size_t k = 0; k < records.size(); ++k) {
        const auto passed = [&](const NamedRun& run) {
            return run.result->observation.cross_sections[k].peak_discharge != 0;
        };
        if (std::any_of(runs.begin(), runs.end(), passed)) drawn.push_back(k);
    }
    return {{"table", section_rows(runs)},
            {"chart", drawn.empty() ? Json() : section_chart(runs, drawn)},
            {"not_drawn", drawn.size() > max_sections_drawn ? Json(drawn.size() - max_sections_drawn) : Json()}};
}

}  // namespace talus::report
