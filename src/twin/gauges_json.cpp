#include "twin/gauges_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/number_or_null.hpp"
#include "twin/answers.hpp"
#include "twin/live_run.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;
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

json reading_json(const GaugeRecord& record, const observe::FlowAt& now) {
    return {{"name", record.gauge.name},
            {"arrival_s", number_or_null<json>(record.arrival_time)},
            {"depth_m", now.depth},
            {"speed_mps", now.speed},
            {"peak_depth_m", record.peak_depth},
            {"peak_speed_mps", record.peak_speed}};
}

/// As of a time, from the rows until then. A short rest of an interval says nothing about the discharge.
json section_json(const observe::DischargeRecord& record, double until) {
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
    return {{"name", record.section.name},
            {"discharge_m3ps", discharge},
            {"peak_discharge_m3ps", peak},
            {"passed_m3", passed}};
}

}  // namespace

json gauge_place(const terrain::Gauge& gauge) {
    return {{"name", gauge.name},
            {"x_m", gauge.at.x},
            {"y_m", gauge.at.y},
            {"chainage_m", number_or_null<json>(gauge.chainage)}};
}

json gauge_places(const std::vector<terrain::Gauge>& gauges) {
    json places = json::array();
    for (const terrain::Gauge& gauge : gauges) places.push_back(gauge_place(gauge));
    return places;
}

json section_places(const std::vector<terrain::CrossSection>& sections) {
    json places = json::array();
    for (const terrain::CrossSection& section : sections) {
        json line = json::array();
        for (const PlanPoint& p : section.line) line.push_back({p.x, p.y});
        places.push_back({{"name", section.name}, {"line", std::move(line)}});
    }
    return places;
}

json gauge_curves(const std::vector<GaugeRecord>& records) {
    json times = json::array(), depths = json::array();
    if (records.empty()) return {{"time_s", times}, {"depth_m", depths}};
    // All gauges have the same rows. As many as a chart can show, however long the run is.
    constexpr std::size_t most = 600;
    const std::size_t count = records.front().rows.size(), every = std::max<std::size_t>(1, (count + most - 1) / most);
    for (std::size_t k = 0; k < count; k += every) times.push_back(records.front().rows[k].time);
    for (const GaugeRecord& record : records) {
        json& column = depths.emplace_back(json::array());
        for (std::size_t k = 0; k < count; k += every) column.push_back(record.rows[k].depth);
    }
    return {{"time_s", times}, {"depth_m", depths}};
}

json gauges_json(const Scenario& scenario, std::optional<double> time) {
    const observe::Observer& observer = scenario.run().observer();
    json readings = json::array(), sections = json::array();
    // A time is told with four decimals: the row of the moment that was meant may lie just after it.
    const double now = scenario.run().summary().time, until = time.value_or(now) + 1e-4;
    for (const observe::DischargeRecord& record : observer.cross_sections(now)) {
        sections.push_back(section_json(record, until));
    }
    for (const GaugeRecord& record : observer.gauges()) {
        readings.push_back(time ? reading_json(record_until(record, until), flow_at(record, until))
                                : reading_json(record, observer.maps().at(record.gauge.at)));
    }
    return {{"gauges", readings}, {"cross_sections", sections}};
}

}  // namespace talus::twin
