#include "observe/gauges.hpp"

#include <cmath>

namespace talus::observe {

GaugeRecorder::GaugeRecorder(const std::vector<terrain::Gauge>& gauges, double arrival_depth)
    : arrival_depth_(arrival_depth) {
    for (const terrain::Gauge& gauge : gauges) records_.push_back({.gauge = gauge});
}

void GaugeRecorder::take(GaugeRecord& record, double time, bool row, const FlowAt& now) const {
    if (now.depth > arrival_depth_ && std::isnan(record.arrival_time)) record.arrival_time = time;
    if (now.depth > record.peak_depth) {
        record.peak_depth = now.depth;
        record.peak_depth_time = time;
    }
    if (now.speed > record.peak_speed) {
        record.peak_speed = now.speed;
        record.peak_speed_time = time;
    }
    const bool again = !record.rows.empty() && record.rows.back().time == time;
    if (row && !again) record.rows.push_back({time, now.depth, now.speed});
}

}  // namespace talus::observe
