#pragma once

#include <cstddef>
#include <vector>

#include "observe/observation.hpp"

namespace talus::observe {

/// Records debris at gauges: arrival and peaks of every step, depth and speed at the rows of the time series.
class GaugeRecorder {
  public:
    GaugeRecorder() = default;
    /// `arrival_depth`, m: deeper debris has arrived.
    GaugeRecorder(const std::vector<terrain::Gauge>& gauges, double arrival_depth);

    /// `read(place)` is the FlowAt now; `row`: this moment is one of the time series.
    template <class Read>
    void after_step(double time, bool row, const Read& read) {
        for (GaugeRecord& record : records_) take(record, time, row, read(record.gauge.at));
    }
    [[nodiscard]] const std::vector<GaugeRecord>& records() const { return records_; }

    /// The records of the same gauges.
    template <class Archive>
    void keep(Archive& archive) {
        for (GaugeRecord& r : records_) {
            archive(r.arrival_time, r.peak_depth, r.peak_depth_time, r.peak_speed, r.peak_speed_time, r.rows);
        }
    }

  private:
    void take(GaugeRecord& record, double time, bool row, const FlowAt& now) const;

    std::vector<GaugeRecord> records_;
    double arrival_depth_ = 0;
};

}  // namespace talus::observe
