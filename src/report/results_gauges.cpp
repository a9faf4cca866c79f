// Depth and speed at gauges over time.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"

namespace talus::report {
namespace {

constexpr std::size_t max_drawn = 12;  // a row of plots each

/// Gauges at which any of the runs had debris.
std::vector<std::size_t> wet_gauges(const std::vector<NamedRun>& runs) {
    std::vector<std::size_t> wet;
    for (std::size_t k = 0; k < runs.front().result->observation.gauges.size(); ++k) {
        const auto had_debris = [&](const NamedRun& run) { return run.result->observation.gauges[k].peak_depth > 0; };
        if (std::any_of(runs.begin(), runs.end(), had_debris)) wet.push_back(k);
    }
    return wet;
}

std::string place_of(const terrain::Gauge& gauge) {
    return std::isfinite(gauge.chainage) ? fmt::format("chainage {} m", plain(gauge.chainage))
                                         : fmt::format("{} E {} N", fixed(gauge.at.x, 1), fixed(gauge.at.y, 1));
}

Json rows_of(const std::vector<NamedRun>& runs) {
    std::vector<Column> columns = {{"gauge", "Gauge", ""}, {"place", "Place", ""}};
    if (runs.size() > 1) columns.push_back({"model", "Model", ""});
    columns.insert(columns.end(), {{"arrival_s", "Arrival", "s", "f1", "", "not reached"},
                                   {"peak_depth_m", "Peak depth", "m", "f2"},
                                   {"peak_depth_time_s", "at", "s", "f1"},
                                   {"peak_speed_mps", "Peak speed", "m/s", "f1"},
                                   {"peak_speed_time_s", "at", "s", "f1"}});
    Json rows = table(columns);
    const std::size_t count = runs.front().result->observation.gauges.size();
    for (std::size_t k = 0; k < count; ++k) {
        for (const NamedRun& run : runs) {
            const observe::GaugeRecord& record = run.result->observation.gauges.at(k);
            Json row = {{"gauge", record.gauge.name}, {"place", place_of(record.gauge)}};
            if (runs.size() > 1) row["model"] = run.name;
            row["arrival_s"] = number_or_null<Json>(record.arrival_time);
            if (row["arrival_s"].is_null() && !run.result->covers(record.gauge.at)) {
                row["arrival_s"] = "outside the zoom";
            }
            row["peak_depth_m"] = record.peak_depth;
            row["peak_depth_time_s"] = number_or_null<Json>(record.peak_depth_time);
            row["peak_speed_mps"] = record.peak_speed;
            row["peak_speed_time_s"] = number_or_null<Json>(record.peak_speed_time);
            rows["rows"].push_back(std::move(row));
        }
    }
    return rows;
}

/// A row of two plots per gauge: depth and speed, a curve per run.
Json chart_of(const std::vector<NamedRun>& runs, const std::vector<std::size_t>& drawn) {
    constexpr double step = 190, height = 120, width = 410;
    const std::size_t count = std::min(max_drawn, drawn.size());
    ValueRange time{0, 0};
    for (const NamedRun& run : runs) time.include(run.result->simulated_time);
    Chart chart{"Depth and speed at gauges", 1000, step * static_cast<double>(count) + 50, {}};
    for (std::size_t place = 0; place < count; ++place) {
        const std::size_t k = drawn[place];
        ValueRange depths{0, 1e-3}, speeds{0, 1e-3};
        for (const NamedRun& run : runs) {
            for (const observe::GaugeSample& s : run.result->observation.gauges[k].rows) {
                depths.include(1.1 * s.depth);
                speeds.include(1.1 * s.speed);
            }
        }
        const double top = 34 + step * static_cast<double>(place);
        Plot depth(66, top, width, height, time, depths), speed(66 + width + 90, top, width, height, time, speeds);
        depth.axes("time, s", "depth, m");
        speed.axes("time, s", "speed, m/s");
        depth.key = speed.key = Plot::Key::none;
        for (std::size_t i = 0; i < runs.size(); ++i) {
            std::vector<double> t, h, v;
            for (const observe::GaugeSample& s : runs[i].result->observation.gauges[k].rows) {
                t.push_back(s.time);
                h.push_back(s.depth);
                v.push_back(s.speed);
            }
            const std::string style = fmt::format("series v{}", i);
            depth.line(t, h, style, place == 0 && runs.size() > 1 ? runs[i].name : "");
            speed.line(t, v, style);
        }
        const observe::GaugeRecord& record = runs.front().result->observation.gauges[k];
        depth.label(time.low, depths.high, 0, -8, "start", "note-strong",
                    fmt::format("{}, {}", shortened(record.gauge.name, 40), place_of(record.gauge)));
        chart.plots.push_back(std::move(depth));
        chart.plots.push_back(std::move(speed));
    }
    return chart_json(chart);
}

}  // namespace

Json gauges(const std::vector<NamedRun>& runs) {
    const std::size_t count = runs.front().result->observation.gauges.size();
    if (count == 0) return {};
    Json cells = Json::array();
    for (const NamedRun& run : runs) {
        const double cell = run.result->map_cell;
        cells.push_back({{"another", !cells.empty()}, {"model", run.name}, {"cell_m", cell}});
    }
    const std::vector<std::size_t> drawn = wet_gauges(runs);
    return {{"table", rows_of(runs)},
            {"chart", drawn.empty() ? Json() : chart_of(runs, drawn)},
            {"cells", std::move(cells)},
            {"not_drawn", drawn.size() > max_drawn ? Json(drawn.size() - max_drawn) : Json()}};
}

}  // namespace talus::report
