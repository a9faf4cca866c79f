#include "report/place_results.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace talus::report {
namespace {

constexpr std::size_t most_drawn = 12;  // a row of plots each

ValueRange range_of(const std::vector<PlacePlots::Curves>& curves, std::vector<double> PlacePlots::Curves::*values) {
    ValueRange range{0, 1e-3};
    for (const PlacePlots::Curves& each : curves) {
        for (const double value : each.*values) range.include(1.1 * value);
    }
    return range;
}

}  // namespace

Json place_table(const std::vector<NamedRun>& runs, std::size_t places, const PlaceRows& rows) {
    std::vector<Column> columns = rows.place;
    if (runs.size() > 1) columns.push_back({"model", "Model", ""});
    columns.insert(columns.end(), rows.values.begin(), rows.values.end());
    Json all = table(columns);
    for (std::size_t k = 0; k < places; ++k) {
        for (const NamedRun& run : runs) {
            Json row = rows.place_of(run, k);
            if (runs.size() > 1) row["model"] = run.name;
            rows.add_values(row, run, k);
            all["rows"].push_back(std::move(row));
        }
    }
    return all;
}

std::pair<Json, Json> place_chart(const std::vector<NamedRun>& runs, std::size_t places, const PlacePlots& plots) {
    constexpr double step = 190, height = 120, width = 410;
    std::vector<std::size_t> drawn;
    for (std::size_t k = 0; k < places; ++k) {
        const auto shows = [&](const NamedRun& run) { return plots.shows(run, k); };
        if (std::any_of(runs.begin(), runs.end(), shows)) drawn.push_back(k);
    }
    if (drawn.empty()) return {};
    Json not_drawn;
    if (drawn.size() > most_drawn) {
        not_drawn = drawn.size() - most_drawn;
        drawn.resize(most_drawn);
    }
    ValueRange time{0, 0};
    for (const NamedRun& run : runs) time.include(run.result->simulated_time);
    Chart chart{plots.title, 1000, step * static_cast<double>(drawn.size()) + 50, {}};
    for (std::size_t place = 0; place < drawn.size(); ++place) {
        const std::size_t k = drawn[place];
        std::vector<PlacePlots::Curves> curves;
        curves.reserve(runs.size());
        for (const NamedRun& run : runs) curves.push_back(plots.curves(run, k));
        const double top = 34 + step * static_cast<double>(place);
        Plot first(66, top, width, height, time, range_of(curves, &PlacePlots::Curves::first));
        Plot second(66 + width + 90, top, width, height, time, range_of(curves, &PlacePlots::Curves::second));
        first.axes("time, s", plots.first_axis);
        second.axes("time, s", plots.second_axis);
        first.key = second.key = Plot::Key::none;
        for (std::size_t i = 0; i < runs.size(); ++i) {
            const std::string style = fmt::format("series v{}", i);
            first.line(curves[i].time, curves[i].first, style, place == 0 && runs.size() > 1 ? runs[i].name : "");
            second.line(curves[i].time, curves[i].second, style);
        }
        first.label(time.low, first.y_range.high, 0, -8, "start", "note-strong", plots.name(k));
        chart.plots.push_back(std::move(first));
        chart.plots.push_back(std::move(second));
    }
    return {chart_json(chart), std::move(not_drawn)};
}

}  // namespace talus::report
