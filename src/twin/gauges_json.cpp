#include "twin/gauges_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "twin/answers.hpp"
#include "twin/live_run.hpp"

namespace talus::twin {
namespace {

using observe::GaugeRecord;
using observe::GaugeSample;

/// As of a time, from the rows until then; its peaks are exact once they have been reached.
GaugeRecord record_until(const GaugeRecord& whole, double time) {
    GaugeRecord then{.gauge = whole.gauge};
    if (whole.arrival_time <= time) then.arrival_time = whole.arrival_time;
    for (const GaugeSample& row : whole.rows) {
        if (row.time > time) break;
        then.peak_depth = std::max(then.peak_depth, row.depth);
        then.peak_speed = std::max(then.peak_speed, row.speed);
    }
    if (whole.peak_depth_time <= time) then.peak_depth = whole.peak_depth;
    if (whole.peak_speed_time <= time) then.peak_speed = whole.peak_speed;
    return then;
}

/// The row at or before a time.
observe::FlowAt flow_at(const GaugeRecord& record, double time) {
    const auto after = std::upper_bound(record.rows.begin(), record.rows.end(), time,
                                        [](double t, const GaugeSample& row) { return t < row.time; });
    if (after == record.rows.begin()) return {};
    return {(after - 1)->depth, (after - 1)->speed};
}

messages::GaugeReading reading_of(const GaugeRecord& record, const observe::FlowAt& now) {
    return {.name = record.gauge.name,
            .arrival_s = record.arrival_time,
            .depth_m = now.depth,
            .speed_mps = now.speed,
            .peak_depth_m = record.peak_depth,
            .peak_speed_mps = record.peak_speed};
}

/// As of a time, from the rows until then. A short rest of an interval says nothing about the discharge.
messages::SectionReading reading_of(const observe::DischargeRecord& record, double until) {
    double discharge = 0, peak = 0, passed = 0, before = 0;
    for (const observe::DischargeSample& row : record.rows) {
        if (row.time > until) break;
        passed = row.passed;
        if (row.time - before >= record.section.interval / 2) {
            discharge = row.discharge;
            if (std::abs(discharge) > std::abs(peak)) peak = discharge;
        }
        before = row.time;
    }
    return {.name = record.section.name, .discharge_m3ps = discharge, .peak_discharge_m3ps = peak, .passed_m3 = passed};
}

}  // namespace

messages::GaugePlace gauge_place(const terrain::Gauge& gauge) {
    return {.name = gauge.name, .x_m = gauge.at.x, .y_m = gauge.at.y, .chainage_m = gauge.chainage};
}

std::vector<messages::GaugePlace> gauge_places(const std::vector<terrain::Gauge>& gauges) {
    std::vector<messages::GaugePlace> places;
    places.reserve(gauges.size());
    for (const terrain::Gauge& gauge : gauges) places.push_back(gauge_place(gauge));
    return places;
}

std::vector<messages::SectionPlace> section_places(const std::vector<terrain::CrossSection>& sections) {
    std::vector<messages::SectionPlace> places;
    places.reserve(sections.size());
    for (const terrain::CrossSection& section : sections) {
        places.push_back({.name = section.name, .line = {}});
        for (const PlanPoint& p : section.line) places.back().line.push_back({p.x, p.y});
    }
    return places;
}

messages::GaugeSeries gauge_curves(const std::vector<GaugeRecord>& records) {
    messages::GaugeSeries curves{.time_s = {}, .depth_m = {}};
    if (records.empty()) return curves;
    // All gauges have the same rows. As many as a chart can show, however long the run is.
    constexpr std::size_t most = 600;
    const std::size_t count = records.front().rows.size(), every = std::max<std::size_t>(1, (count + most - 1) / most);
    for (std::size_t k = 0; k < count; k += every) curves.time_s.push_back(records.front().rows[k].time);
    for (const GaugeRecord& record : records) {
        std::vector<double>& column = curves.depth_m.emplace_back();
        for (std::size_t k = 0; k < count; k += every) column.push_back(record.rows[k].depth);
    }
    return curves;
}

nlohmann::json gauges_json(const Scenario& scenario, std::optional<double> time) {
    const observe::Observer& observer = scenario.run().observer();
    messages::GaugeReadings all{.gauges = {}, .cross_sections = {}};
    // A time is told with four decimals: the row of the moment that was meant may lie just after it.
    const double now = scenario.run().summary().time, until = time.value_or(now) + 1e-4;
    for (const observe::DischargeRecord& record : observer.cross_sections(now)) {
        all.cross_sections.push_back(reading_of(record, until));
    }
    for (const GaugeRecord& record : observer.gauges()) {
        all.gauges.push_back(time ? reading_of(record_until(record, until), flow_at(record, until))
                                  : reading_of(record, observer.maps().at(record.gauge.at)));
    }
    return all;
}

}  // namespace talus::twin
