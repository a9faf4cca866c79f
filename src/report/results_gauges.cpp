// Depth and speed at gauges over time.
#include <cmath>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "report/number_text.hpp"
#include "report/place_results.hpp"

namespace talus::report {
namespace {

const observe::GaugeRecord& gauge_record(const NamedRun& run, std::size_t gauge) {
    return run.result->observation.gauges.at(gauge);
}

std::string place_of(const terrain::Gauge& gauge) {
    return std::isfinite(gauge.chainage) ? fmt::format("chainage {} m", plain(gauge.chainage))
                                         : fmt::format("{} E {} N", fixed(gauge.at.x, 1), fixed(gauge.at.y, 1));
}

void add_readings(Json& row, const NamedRun& run, std::size_t k) {
    const observe::GaugeRecord& record = gauge_record(run, k);
    row["arrival_s"] = number_or_null<Json>(record.arrival_time);
    if (row["arrival_s"].is_null() && !run.result->covers(record.gauge.at)) row["arrival_s"] = "outside the zoom";
    row["peak_depth_m"] = record.peak_depth;
    row["peak_depth_time_s"] = number_or_null<Json>(record.peak_depth_time);
    row["peak_speed_mps"] = record.peak_speed;
    row["peak_speed_time_s"] = number_or_null<Json>(record.peak_speed_time);
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
    const PlaceRows rows{.place = {{"gauge", "Gauge", ""}, {"place", "Place", ""}},
                         .values = {{"arrival_s", "Arrival", "s", "f1", "", "not reached"},
                                    {"peak_depth_m", "Peak depth", "m", "f2"},
                                    {"peak_depth_time_s", "at", "s", "f1"},
                                    {"peak_speed_mps", "Peak speed", "m/s", "f1"},
                                    {"peak_speed_time_s", "at", "s", "f1"}},
                         .place_of = [](const NamedRun& run, std::size_t k) -> Json {
                             const terrain::Gauge& gauge = gauge_record(run, k).gauge;
                             return {{"gauge", gauge.name}, {"place", place_of(gauge)}};
                         },
                         .add_values = add_readings};
    const PlacePlots plots{
        .title = "Depth and speed at gauges",
        .first_axis = "depth, m",
        .second_axis = "speed, m/s",
        .shows = [](const NamedRun& run, std::size_t k) { return gauge_record(run, k).peak_depth > 0; },
        .curves =
            [](const NamedRun& run, std::size_t k) {
                PlacePlots::Curves curves;
                for (const observe::GaugeSample& s : gauge_record(run, k).rows) {
                    curves.time.push_back(s.time);
                    curves.first.push_back(s.depth);
                    curves.second.push_back(s.speed);
                }
                return curves;
            },
        .name =
            [&](std::size_t k) {
                const terrain::Gauge& gauge = gauge_record(runs.front(), k).gauge;
                return fmt::format("{}, {}", shortened(gauge.name, 40), place_of(gauge));
            }};
    auto [chart, not_drawn] = place_chart(runs, count, plots);
    return {{"table", place_table(runs, count, rows)},
            {"chart", std::move(chart)},
            {"cells", std::move(cells)},
            {"not_drawn", std::move(not_drawn)}};
}

}  // namespace talus::report
